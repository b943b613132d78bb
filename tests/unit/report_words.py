"""A document's pieces as plain data, so that two can be compared; and they keep their form."""

from typing import Any

import numpy as np

from thermobearing.quantities.tables import Table
from thermobearing.report.pieces import Pieces, Plot


def plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return repr(float(value))
    return value


def table_as_data(table: Table) -> Any:
    heads = [column.title for column in table.columns]
    return [table.caption, heads, plain(table.rows), sorted(table.marked), table.note, table.keys]


def plot_as_data(plot: Plot | None) -> Any:
    if plot is None:
        return None
    traces = {
        name: [
            (t.name, plain(t.x), plain(t.y), t.colour, t.look, plain(t.frames), plain(t.frames_x))
            for t in traces
        ]
        for name, traces in plot.choices.items()
    }
    return [plot.x_title, plot.y_title, traces, list(plot.slider), plain(plot.bands)]


def as_data(pieces: Pieces) -> dict[str, Any]:
    tables = {**pieces.inputs, **pieces.tables}
    tables |= {"energy": pieces.energy} if pieces.energy else {}
    return {
        "words": [pieces.command, pieces.title, pieces.question, *pieces.answer],
        "tables": {name: table_as_data(table) for name, table in tables.items()},
        "figures": {
            name: [figure.caption, figure.alt, plot_as_data(figure.plot)]
            for name, figure in pieces.figures.items()
        },
        "checks": [plain(list(vars(check).values())) for check in pieces.checks],
        "said": [pieces.validity, pieces.validity_unknown, pieces.assumptions, pieces.warnings],
        "identity": dict(pieces.identity),
    }


def assert_well_formed(pieces: Pieces) -> None:
    """Rows as long as heads, no text that is not a sentence, no NaN in words."""
    assert 1 <= len(pieces.answer) <= 7
    for sentence in (*pieces.answer, *pieces.validity, *pieces.assumptions, *pieces.warnings):
        assert sentence[-1] in ".!?", sentence
        assert "nan" not in sentence.split(), sentence
        assert "degC" not in sentence, sentence
    tables = [*pieces.inputs.values(), *pieces.tables.values()]
    for table in [*tables, *([pieces.energy] if pieces.energy else [])]:
        assert table.rows, table.caption
        assert not table.caption.endswith("."), table.caption
        for row in table.rows:
            assert len(row) == len(table.columns), table.caption
            for column, value in zip(table.columns, row, strict=True):
                column.text(value)
        for row_number, column_number in table.marked:
            assert row_number < len(table.rows)
            assert column_number < len(table.columns)
    for figure in pieces.figures.values():
        assert figure.draw is not None or figure.image or figure.plot
        assert figure.caption.endswith(".")
        for traces in figure.plot.choices.values() if figure.plot else ():
            for trace in traces:
                assert len(trace.x) == len(trace.y) > 0
                if trace.frames is not None:
                    assert figure.plot is not None
                    assert len(trace.frames) == len(figure.plot.slider)


def numbers_in(table: Table, head: str) -> list[Any]:
    place = [column.head for column in table.columns].index(head)
    return [row[place] for row in table.rows]
