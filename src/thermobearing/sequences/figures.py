"""Figures of a sequence of tests."""

from matplotlib.figure import Figure

from thermobearing.results import drawing
from thermobearing.sequences.result import SequenceResult


class SequenceFigures(drawing.Figures):
    """Figures of a sequence: `result.plot.sequence()`, a matplotlib Figure."""

    names = ("sequence",)
    _result: SequenceResult

    def sequence(self) -> Figure:
        """Draw force over displacement, and temperatures in time, a column for each part."""
        result, case = self._result, self._result.case
        histories = {case.label(k): result.history(k) for k in range(len(result.parts))}
        return drawing.draw_histories(f"{case.name}: {case.bearing.name}", histories)
