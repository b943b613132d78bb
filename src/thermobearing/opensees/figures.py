"""Figures of served bearings."""

from matplotlib.figure import Figure

from thermobearing.opensees.result import ServedResult
from thermobearing.results import drawing

MOST_ELEMENTS = 6  # that are drawn


class ServedFigures(drawing.Figures):
    """Figures of served bearings: `result.plot.elements()`, a matplotlib Figure."""

    names = ("elements",)
    _result: ServedResult

    def elements(self) -> Figure:
        """Draw force over displacement, and temperatures in time, a column for each element."""
        data, attrs = self._result.dataset, self._result.dataset.attrs
        names = [f"element {name}" for name in data["element"].values[:MOST_ELEMENTS]]
        histories = {name: self._result.history(k) for k, name in enumerate(names)}
        title = f"{attrs['bearing']} in OpenSees: {drawing.degrees(attrs['ambient_degC'])}"
        return drawing.draw_histories(title, histories, "force of one bearing [kN]")
