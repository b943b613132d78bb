"""Main histories of any result, as a workbook takes them."""

from collections.abc import Hashable
from typing import Any

from thermobearing.border.lazy import pd
from thermobearing.cyclic.dataset import written_part
from thermobearing.cyclic.result import Result, history_columns
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.loading import AnyResult
from thermobearing.opensees.result import ServedResult
from thermobearing.quantities.register import Quantity
from thermobearing.report.content import MOST_ROWS, words
from thermobearing.report.workbook import History
from thermobearing.results.saved import SavedResult
from thermobearing.studies.result import StudyResult

AMBIENT = "Ambient [°C]"


def histories_by_run(result: AnyResult) -> dict[str, History]:
    """Return histories by the name of their run.

    `result`: as loaded, or as it was computed.
    """
    if isinstance(result, SavedResult):
        return _of_tables(result)
    if isinstance(result, StudyResult):
        return {}  # its table may have a million rows: `study table` writes it
    if isinstance(result, ServedResult):
        names = map(str, result.dataset["element"].values)
        return {n: _history({"Element": n}, result.history(k)) for k, n in enumerate(names)}
    if isinstance(result, EarthquakeResult):
        return dict(zip(result.run_names, _of_study(result), strict=True))
    if isinstance(result, Result):
        return _of_test(result)
    return {
        result.case.label(k): _history({"Part": result.case.label(k)}, result.history(k))
        for k in range(len(result.parts))
    }


def _history(keys: dict[str, Any], table: "pd.DataFrame") -> History:
    columns = [Quantity(*words(str(name))) for name in table.columns]
    return History(keys, columns, table.to_numpy(dtype=float))


def _of_study(result: EarthquakeResult) -> list[History]:
    histories = []
    data = result.dataset
    for run in range(result.runs):
        names = {"Bearing": str(data["bearing"].values[run])}
        names["Motion"] = str(data["motion"].values[run])
        keys: dict[str, Any] = {**names, AMBIENT: float(data["ambient"].values[run])}
        if any(result.modes):
            keys["Mode"] = result.modes[run]
        histories.append(_history(keys, result.history(run)))
    return histories


def _of_test(result: Result) -> dict[str, History]:
    written = written_part(result)
    histories = {}
    for run, ambient in enumerate(written.dataset["ambient"].values):
        table = pd.DataFrame(history_columns(written, run))
        histories[f"{ambient:g}"] = _history({AMBIENT: float(ambient)}, table)
    return histories


def _of_tables(saved: SavedResult) -> dict[str, History]:
    """Return long tables, such as samples of tests; columns that identify rows become keys."""
    histories = {}
    for name, table in saved.tables.items():
        if len(table) <= MOST_ROWS:
            continue
        labels = [column for column in table.columns if not _is_number(table[column])]
        groups: Any = table.groupby(labels, sort=False, dropna=False) if labels else [((), table)]
        for values, part in groups:
            keys = dict(zip(map(_head, labels), map(str, values), strict=True))
            label = " ".join([name, *keys.values()])
            histories[label] = _history(keys, part.drop(columns=labels))
    return histories


def _head(column: Hashable) -> str:
    return words(str(column))[0].capitalize()


def _is_number(values: "pd.Series[Any]") -> bool:
    return pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_bool_dtype(values)
