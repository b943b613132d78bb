"""Measured temperatures compared with the temperatures of the model."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.records.record import TestRecord
from thermobearing.results import drawing

LEAST_RISE = 0.5  # [K]: relative errors of less mean nothing
COLUMNS = {  # of a row, and what they are called on the screen
    "thermocouple": "thermocouple",
    "place": "place",
    "start_test_degC": "start degC",
    "highest_test_degC": "highest degC",
    "highest_model_degC": "model degC",
    "rise_test_K": "rise K",
    "rise_model_K": "model K",
    "rise_error": "error",
    "rms_difference_K": "rms K",
}


def thermocouple_rows(record: TestRecord, prediction: Prediction) -> list[dict[str, Any]]:
    """Each thermocouple of a test beside the model, in numbers.

    Parameters
    ----------
    record : a test.
    prediction : the model at its samples.

    Returns
    -------
    list of dict : by the names in `COLUMNS`; `rise_error` is that of the largest rise (Eq. 4.39
        with its sign), None where the test rises by less than half a kelvin.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 3)
    >>> record = record_from_arrays(t, t, t, 20.0)
    >>> record = replace(record, temperatures={"T3": 20.0 + 10.0 * t}, places={"T3": "rubber 1"})
    >>> (row,) = thermocouple_rows(record, Prediction(t, {"T3": 20.0 + 11.0 * t}, "completed"))
    >>> row["rise_test_K"], row["rise_model_K"], round(row["rise_error"], 3)
    (10.0, 11.0, 0.1)
    """
    rows = []
    for title, test in record.temperatures.items():
        model = prediction.temperatures[title]
        rise, modelled = float(test.max() - test[0]), float(model.max() - model[0])
        rows.append(
            {
                "thermocouple": title,
                "place": record.places[title],
                "start_test_degC": float(test[0]),
                "highest_test_degC": float(test.max()),
                "highest_model_degC": float(model.max()),
                "rise_test_K": rise,
                "rise_model_K": modelled,
                "rise_error": modelled / rise - 1.0 if rise > LEAST_RISE else None,
                "rms_difference_K": float(np.sqrt(np.mean((model - test) ** 2))),
            }
        )
    return rows


def thermocouple_cells(row: dict[str, Any]) -> list[str]:
    """A row for the screen, in the order of `COLUMNS`."""
    shown = [str(row["thermocouple"]), str(row["place"])]
    for name in list(COLUMNS)[2:]:
        value = row[name]
        if value is None:
            shown.append("-")
        else:
            shown.append(f"{value:+.0%}" if name == "rise_error" else f"{value:.1f}")
    return shown


def draw_thermocouples(ax: Axes, record: TestRecord, prediction: Prediction) -> list[Line2D]:
    """Measured (full) beside modelled (dashed) temperatures in time; the lines of a legend.

    Parameters
    ----------
    ax : to draw into.
    record : a test with thermocouples.
    prediction : the model at its samples.

    Returns
    -------
    list of Line2D
    """
    colours = drawing.ordered_colours(len(record.temperatures), "turbo")
    lines = []
    for (title, test), colour in zip(record.temperatures.items(), colours, strict=True):
        label = f"{title} ({record.places[title]})"
        lines += ax.plot(record.time, test, color=colour, linewidth=1.4, label=label)
        ax.plot(
            record.time, prediction.temperatures[title], color=colour, linewidth=1.0, linestyle="--"
        )
    drawing.name_axes(ax, "time [s]", "temperature [degC]")
    return lines
