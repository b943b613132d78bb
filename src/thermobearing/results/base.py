"""The base of all results: outcome, tables, console, notebook, directory, report.

A result is data. Figures and reports are in the modules `figures` and `report` of the package that
defines its class, which are imported when they are first used: a result imports no view.
"""

from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, short_repr
from thermobearing.border.keywords import renamed
from thermobearing.border.lazy import pd, xr
from thermobearing.quantities.tables import Table
from thermobearing.results.directory import CHECKS, FIGURES, RIG, TESTED_RANGE, write_directory
from thermobearing.results.figure_style import Wanted, figure_style
from thermobearing.results.ranges import OUTSIDE, largest_tested
from thermobearing.results.screen import LISTED, print_warnings, say, show_table, table_html
from thermobearing.results.writing import from_attribute, warnings_of, write_csv, write_summary

COMPLETED = "completed"
RANGE_TABLES = ("rig", "tested_range")  # whose rows are those of `compared`


@checked
class Result:
    """Base class of all results.

    A subclass defines `table` and `summary()`, usually `outcome`, `sentence`,
    `warnings`, `tables()`, `notes()` and `_write(folder)`, and names its class of figures in
    `_figures`, to be found in the module `figures` of its package.
    """

    title: ClassVar[str] = "Result"  # of the headline: what the result is
    _figures: ClassVar[str] = ""
    _report_of_files: ClassVar[bool] = False  # the report is built from the saved directory
    _listed: ClassVar[str] = LISTED  # where all warnings are, if the screen has some of them

    outcome: Any = COMPLETED
    sentence: Any = ""
    warnings: Any = ()
    table: Any

    @property
    def headline(self) -> str:
        """Return the type and outcome of the result in a line."""
        return f"{self.title}: {self.outcome}"

    def __repr__(self) -> str:
        return f"<{self.headline}>"

    def _repr_html_(self) -> str:
        return table_html(self.headline, self.table, self.warnings)

    @property
    def rig(self) -> "pd.DataFrame":
        """Use of each limit of the rig by each run; empty without a rig."""
        return self._rows("rig")

    @property
    def tested_range(self) -> "pd.DataFrame":
        """Use of the calibration range of its bearing by each run; empty if unknown."""
        return self._rows("tested_range")

    @property
    def bearing_checks(self) -> "pd.DataFrame":
        """Checks of the bearings in each run: of their lead, and under an axial force."""
        return self._rows("bearing_checks")

    def _rows(self, name: str) -> "pd.DataFrame":
        """Return the rows of limits of the rig, of the tested range or of checks."""
        return pd.DataFrame()

    def tables(self) -> dict[str, Table]:
        """Return the tables by name, for console and report."""
        return {}

    def notes(self) -> list[str]:
        """Return sentences printed below the tables, such as the energy balance."""
        return []

    def show(self) -> None:
        """Print title, warnings, tables and notes, as the command does."""
        say(self.headline, "bold")
        print_warnings(self.warnings, listed=self._listed)
        for table in self.tables().values():
            show_table(table)
        for note in self.notes():
            say(note)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json; see docs/files.md."""
        raise NotImplementedError

    def _limits_summary(self) -> dict[str, Any]:
        tables = {"rig": self.rig, "tested_range": self.tested_range}
        tables["bearing_checks"] = self.bearing_checks
        return {name: table.to_dict("records") for name, table in tables.items() if len(table)}

    @property
    def plot(self) -> Any:
        """Figures of the result, each a matplotlib Figure."""
        return getattr(self._view("figures"), self._figures)(self)

    @checked
    def save(
        self,
        directory: str | Path,
        *,
        overwrite: bool = False,
        figures: Wanted = True,
    ) -> Path:
        """Write a result directory; see docs/files.md.

        Parameters
        ----------
        directory : str or Path
            Made if needed, with its parents.
        overwrite : bool
            Replace an earlier result directory.
        figures : bool or mapping
            Draw the figures too, with the keywords `format`, `width` and `titles` of
            `plot.save_all` where they are given.

        Returns
        -------
        Path
            The directory.

        Raises
        ------
        OutputError
            The directory exists and `overwrite` is False, or it cannot be written; no files
            left.
        """

        def _fill(folder: Path) -> None:
            self._write(folder)
            limits = {RIG: self.rig, TESTED_RANGE: self.tested_range, CHECKS: self.bearing_checks}
            for name, table in limits.items():
                if len(table):
                    write_csv(folder / name, table)
            if figures:
                with figure_style(figures):
                    self._draw(folder)
            write_summary(folder, self.summary())

        return write_directory(Path(directory), _fill, overwrite=overwrite)

    def _write(self, folder: Path) -> None:
        """Write the files of the analysis except summary.json, limits and figures."""

    def _draw(self, folder: Path) -> None:
        if self._figures:
            self.plot.save_all(folder / FIGURES)

    def report(self, directory: str | Path, **options: Any) -> list[Path]:
        """Write report.html and report.pdf; see `thermobearing.make_report`."""
        # By its public name, which the package registers: no result imports what is above it.
        import thermobearing

        make_report: Any = thermobearing.make_report
        return list(make_report(directory if self._report_of_files else self, directory, **options))

    def _view(self, name: str) -> Any:
        """Return the module of that name in the package of the class."""
        return import_module(f"{type(self).__module__.rpartition('.')[0]}.{name}")


@checked
class DatasetResult(Result):
    """A result stored as one labelled dataset with a dimension of runs.

    Every variable has its unit. Lists of sentences, warnings, limits, exposure and states of
    rubber are attributes in JSON.
    """

    dataset: Any

    def __getitem__(self, name: str) -> "xr.DataArray":
        self._check_variable(name)
        array: xr.DataArray = self.dataset[name]
        return array

    def _check_variable(self, name: object) -> None:
        """Raise an InputError unless the dataset has a variable of that name."""
        names = [str(key) for key in self.dataset.variables]
        if not isinstance(name, str) or name not in names:
            raise InputError(f"no variable {short_repr(name)}{nearest(short_repr(name), names)}")

    def _check_run(self, run: int, dimension: str) -> None:
        """Raise an InputError unless a run has that number, which may count from the last one."""
        runs = self.dataset.sizes[dimension]
        if not -runs <= run < runs:
            raise InputError(f"run = {run}: must be an integer from 0 to {runs - 1}")

    @property
    def outcome(self) -> str:
        """The outcome of the first run that did not complete, else completed."""
        if self.dataset.attrs.get("interrupted"):
            return "interrupted"
        outcomes = [str(name) for name in self.dataset["outcome"].values]
        return next((name for name in outcomes if name != COMPLETED), COMPLETED)

    @property
    def sentence(self) -> str:
        """The meaning of the outcome, and what to try."""
        return str(from_attribute(self.dataset, "sentences").get(self.outcome, ""))

    @property
    def warnings(self) -> list[str]:
        """Warnings about the validity of the result."""
        return self.stored_warnings

    @property
    def stored_warnings(self) -> list[str]:
        """Warnings of the analysis, as the dataset has them."""
        return warnings_of(self.dataset)

    def largest_tested(self, run: str, limit: str) -> float:
        """Return the largest tested value of a quantity that a run exceeds; else infinity."""
        return largest_tested(self.tested_range.to_dict("records"), run, limit)

    def _limits_summary(self) -> dict[str, Any]:
        names = [name for name in ("exposure", "rubber_state") if name in self.dataset.attrs]
        attributes = {name: from_attribute(self.dataset, name) for name in names}
        return super()._limits_summary() | attributes

    def _rows(self, name: str) -> "pd.DataFrame":
        rows = from_attribute(self.dataset, name) if name in self.dataset.attrs else []
        if name in RANGE_TABLES and rows and OUTSIDE not in rows[0]:
            old_names = [
                f'{name}: "{key}"{text}' for key in rows[0] if (text := renamed(key, [OUTSIDE]))
            ]
            raise InputError([*old_names, "run the case of this result again"], "result")
        return pd.DataFrame(rows)
