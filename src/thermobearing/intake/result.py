"""What was found in a laboratory's files: columns, records, findings, sidecars."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.deprecated import renamed
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.treatment import Treatment
from thermobearing.tables.guess import ColumnGuess

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Intake:
    """One file, looked at.

    Attributes
    ----------
    file : that was looked at.
    sheet : of a workbook, "" for text.
    separator, decimal : of the file.
    rows, blocks : of numbers; parts that the file or its clock is cut into.
    columns : what each of them was taken for.
    record : the test, as the sidecar reads it.
    report : what a look at the test found; `report.treatment` holds rests, spikes and drift.
    folder : that the files named in `sidecar` are seen from.
    sidecar : its keys, those of a sidecar that is there already among them.
    kept : keys that came from that sidecar.
    ambient : samples of the column of ambient temperature [degC], where there is one.
    """

    file: Path
    sheet: str
    separator: str
    decimal: str
    rows: int
    blocks: int
    columns: list[ColumnGuess]
    record: TestRecord
    report: CheckReport
    sidecar: dict[str, Any]
    folder: Path
    kept: list[str] = field(default_factory=list)
    ambient: NDArray[np.float64] | None = None

    @property
    def treatment(self) -> Treatment | None:
        """Rests, spikes and drift; None where the record is no test."""
        return self.report.treatment

    def plot(self) -> "Figure":
        """The picture: histories with what was found in them, loops, temperatures."""
        from thermobearing.intake.output import intake_figure

        return intake_figure(self)

    def summary(self) -> dict[str, Any]:
        """What summary.json says of the file."""
        return {
            "file": str(self.file),
            "sheet": self.sheet,
            "separator": self.separator,
            "decimal": self.decimal,
            "rows": self.rows,
            "blocks": self.blocks,
            "ambient_degC": self.record.ambient,
            "columns": [vars(column) for column in self.columns],
            "unused_columns": list(self.record.unused),
            "findings": [vars(finding) for finding in self.report.findings],
            "treatment": self.treatment.summary() if self.treatment else None,
            "sidecar": self.sidecar,
        }


@dataclass(frozen=True)
class Intakes:
    """Several files, looked at.

    Attributes
    ----------
    files : in the order given.
    problems : of the files that are left out: why they could not be read.
    """

    files: list[Intake]
    problems: list[str] = field(default_factory=list)

    @property
    def outcome(self) -> str:
        """How it ended: "completed", or "files_left_out"."""
        return "files_left_out" if self.problems else "completed"

    def summary(self) -> dict[str, Any]:
        """The content of summary.json.

        Returns
        -------
        dict : for each file what was found in it.
        """
        return {
            "command": "intake",
            "outcome": self.outcome,
            "problems": list(self.problems),
            "files": [item.summary() for item in self.files],
        }

    @renamed(force="overwrite")
    def save(
        self,
        directory: str | Path,
        *,
        overwrite: bool = False,
        figures: bool = True,
        beside: bool = False,
    ) -> Path:
        """Write a result directory; see `save_intakes`.

        Parameters
        ----------
        directory, force, figures, beside : as in `save_intakes`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.intake.output import save_intakes

        return save_intakes(
            self, Path(directory), overwrite=overwrite, figures=figures, beside=beside
        )
