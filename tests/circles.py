"""A contract of import-linter: no module imports itself, by way of others."""

from graphlib import CycleError, TopologicalSorter
from typing import Any

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, fields, output
from importlinter.application import contract_utils


class NoCircles(Contract):
    """No circle of imports, with those inside functions and without those for types alone.

    The contracts of layers compare packages; this one compares modules, so that a circle within a
    package is seen too.
    """

    ignore_imports = fields.SetField(subfield=fields.ImportExpressionField(), required=False)

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        """Look for one circle."""
        ignored: Any = self.ignore_imports
        contract_utils.remove_ignored_imports_and_report(
            graph=graph, ignore_imports=ignored, unmatched_alerting=contract_utils.AlertLevel.ERROR
        )
        imported = {name: graph.find_modules_directly_imported_by(name) for name in graph.modules}
        circle: list[str] = []
        try:
            TopologicalSorter(imported).prepare()
        except CycleError as error:
            circle = error.args[1]
        return ContractCheck(kept=not circle, metadata={"circle": circle})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print the circle; each module is imported by the next."""
        output.print_error("\n  is imported by ".join(check.metadata["circle"]))
