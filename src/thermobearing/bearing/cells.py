"""Heat cells of a bearing: how many each part is divided into, and how unequal those of plates are.

The thicknesses themselves are laid in core/numbers.py.
"""

from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.schema import Strict

PLATES = ("end_plate", "sealing_plate")  # parts of steel outside the rubber layers
UNEQUAL_CELLS = 100.0  # largest thickness of a cell of a plate over the smallest


class Cells(Strict):
    """Heat cells through the thickness of one part each.

    Shen (2023) uses two in a rubber layer and one in a shim, with which the middle of a layer is
    too cold (docs/theory.md). The defaults are even numbers, so that a half stack ends between two
    cells.

    `plate_grading` makes the cells of end and sealing plates thicker with their distance from the
    rubber, where heat arrives late and smoothed: each is so many times as thick as the one before,
    and a plate needs fewer of them. Without it the cells of a plate are equal.

    Raises
    ------
    InputError
        If a number is outside its range, or the outermost cell of a plate is more than 100 times as
        thick as the innermost.

    Examples
    --------
    >>> Cells(end_plate=5, sealing_plate=5, plate_grading=1.3).grading
    1.3
    >>> Cells().grading
    1.0
    """

    end_plate: Annotated[int, Field(ge=1, le=1000)] = 10
    rubber: Annotated[int, Field(ge=1, le=1000)] = 6
    shim: Annotated[int, Field(ge=1, le=1000)] = 2
    sealing_plate: Annotated[int, Field(ge=1, le=1000)] = 10
    plate_grading: Annotated[float, Field(ge=1, le=2)] | None = None

    def model_post_init(self, context: Any) -> None:
        """Compare the thicknesses of the cells of a plate."""
        for name in PLATES:
            thickest = self.grading ** (getattr(self, name) - 1)
            if thickest > UNEQUAL_CELLS:
                raise ValueError(
                    f"plate_grading = {self.grading:g} makes the outermost of {name} = "
                    f"{getattr(self, name)} cells {thickest:.3g} times as thick as the innermost: "
                    f"must be at most {UNEQUAL_CELLS:g}; use fewer cells"
                )

    @property
    def grading(self) -> float:
        """Thickness of a cell of a plate over that of the next one nearer the rubber."""
        return 1.0 if self.plate_grading is None else self.plate_grading

    def enough(self) -> "Cells":
        """Return the cells with no part coarser than the defaults; graded plates as they are."""
        least = Cells()
        names = ("rubber", "shim", *(PLATES if self.grading == 1.0 else ()))
        counts = {name: max(getattr(self, name), getattr(least, name)) for name in names}
        return self.model_copy(update=counts)
