"""One line of the table."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """What was measured, what was aimed at, and whether it was met (None: no aim)."""

    what: str
    value: float | None
    unit: str = ""
    target: str = ""
    met: bool | None = None
    note: str = ""

    @property
    def measured(self) -> str:
        """The value as people read it."""
        if self.value is None:
            return "-"
        small = self.value != 0.0 and abs(self.value) < 1e-3
        number = f"{self.value:.1e}" if small else f"{self.value:.3g}"
        if abs(self.value) >= 1000.0:
            number = f"{self.value:,.0f}"
        return f"{number} {self.unit}".strip()


def plain(what: str, value: float | None, unit: str = "", note: str = "") -> Row:
    """For the record, without a target."""
    return Row(what, value, unit, note=note)


def at_most(what: str, value: float, limit: float, unit: str = "", note: str = "") -> Row:
    """A row whose value must not exceed the limit."""
    value = float(value)
    return Row(what, value, unit, f"<= {limit:g} {unit}".strip(), value <= limit, note)


def at_least(what: str, value: float, limit: float, unit: str = "", note: str = "") -> Row:
    """A row whose value must reach the limit."""
    value = float(value)
    return Row(what, value, unit, f">= {limit:g} {unit}".strip(), value >= limit, note)


def failed(what: str, why: str, target: str = "") -> Row:
    """Something that could not be measured: not met where there is a target."""
    return Row(what, None, target=target, met=False if target else None, note=why)
