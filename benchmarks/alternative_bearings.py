"""What alternatives to the printed LHDR specimen meet: `python -m benchmarks.alternative_bearings`.

Prints the tables of docs/alternative_bearings.md, whose figure `draw` returns: Table 3.4 of the
printed bearing and of four named alternatives, and fits of the printed model (constant strength,
confined lead) to synthetic tests of bearings whose rubber has the m_T and n_T of Table 4.2.
"""

from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import thermobearing as tb
from thermobearing.cyclic.protocol import Wave
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.run import identify_bearing
from thermobearing.results import drawing

AMBIENTS = (23.0, 0.0, -20.0)
PRINTED, HDR, RUBBER = "shen-lhdr-specimen", "shen-hdr-specimen", "shen-lhdr-table-4-2"
ALTERNATIVES = ("in-touch", "softening", "table-4-2", "combined")
FREE = ("alpha_0", "K_r", "s", "d_y", "b", "m_T", "n_T", "K_l", "K_v", "c_v")  # of Table 5.2
TRUTHS: dict[str, dict[str, Any]] = {
    "constant, confined": {},
    "constant, in touch": {"confined": False},
    "softening, confined": {"softening": 0.0069},
    "softening, in touch": {"confined": False, "softening": 0.0069},
}


@cache
def _last_cycles(name: str) -> pd.DataFrame:
    """The fifth cycle of 250 % at each ambient temperature, and the largest force."""
    wave: Wave = "triangular" if name == HDR else "sine"  # Table 3.4
    result = tb.run(name, tb.cyclic_test(wave=wave), list(AMBIENTS), keep=["rubber"])
    last = result.cycles.groupby("ambient_degC", sort=False).tail(1).set_index("ambient_degC")
    return last.assign(force_kN=np.nanmax(np.abs(result["force"].values), axis=1))


def measures(name: str) -> pd.DataFrame:
    """Return what the tests of a bearing show, a row for each ambient temperature.

    Parameters
    ----------
    name : of a bearing with lead.

    Returns
    -------
    DataFrame : rise of the lead [K], rise of the third layer [K] and that over the HDR specimen's,
        largest force [kN], h_eq of the fifth cycle.
    """
    last, reference = _last_cycles(name), _last_cycles(HDR)
    air = last.index.to_numpy()
    rise = last["rubber3_degC"] - air
    return pd.DataFrame(
        {
            "lead_K": last["lead_degC"] - air,
            "rubber_K": rise,
            "rubber_over_hdr": rise / (reference["rubber3_degC"] - air),
            "force_kN": last["force_kN"],
            "h_eq": last["h_eq"],
        }
    )


def fit_of(change: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """Return m_T and n_T with standard errors of the printed model, fitted to another bearing."""
    model = tb.load_bearing(RUBBER)
    assert model.lead is not None
    truth = model.model_copy(update={"lead": model.lead.model_copy(update=change)})
    records = [
        synthetic_record(truth, air, seed=k, noise=0.01, sampling=25.0)
        for k, air in enumerate(AMBIENTS)
    ]
    identification = identify_bearing(
        records, model, free=list(FREE), starts=1, start_from="bearing"
    )
    estimates = identification.uncertainty.estimates
    keys = {"m_T": "elastic", "n_T": "hysteretic"}
    pairs = {k: estimates[f"hysteresis.{v}_temperature_coefficient"] for k, v in keys.items()}
    return {k: (estimate.value, estimate.stderr) for k, estimate in pairs.items()}


@cache
def fitted() -> dict[str, dict[str, tuple[float, float]]]:
    """Return m_T and n_T with their standard errors for each kind of lead (minutes)."""
    return {lead: fit_of(change) for lead, change in TRUTHS.items()}


def draw() -> Figure:
    """Draw m_T and n_T of the fits with 95 % intervals, between Table 4.2 and Table 5.2."""
    fits = fitted()
    title = "the printed model fitted to tests of other lead"
    figure, axes = drawing.panels(1, 2, (8.6, 3.2), title)
    ends = {"m_T": (-0.914, -1.924), "n_T": (-2.189, -3.299)}
    for ax, (key, (rubber, printed)) in zip(axes, ends.items(), strict=True):
        values, errors = np.array([fit[key] for fit in fits.values()]).T
        rows, blue = np.arange(len(fits)), "#0072B2"
        ax.errorbar(values, rows, xerr=1.96 * errors, fmt="o", color=blue, markersize=4)
        ax.axvline(rubber, color="#009E73", label="rubber of the tests, Table 4.2")
        ax.axvline(printed, color="#D55E00", linestyle="--", label="Table 5.2")
        ax.set_yticks(rows, list(fits) if key == "m_T" else [""] * len(fits))
        ax.set_ylim(len(fits) - 0.5, -0.5)
        drawing.name_axes(ax, key, "lead of the tests" if key == "m_T" else "", "")
    drawing.legend_below(figure, axes[0].get_legend_handles_labels()[0])
    return figure


def main() -> None:
    """Print both tables as Markdown."""
    forms = {"lead_K": ".1f", "rubber_over_hdr": ".2f", "force_kN": ".0f", "h_eq": ".3f"}
    for name in (PRINTED, *(f"shen-lhdr-{alternative}" for alternative in ALTERNATIVES)):
        measured = measures(name)
        cells = [", ".join(f"{value:{form}}" for value in measured[c]) for c, form in forms.items()]
        print(f"| `{name}` | {' | '.join(cells)} |")
    for lead, fit in fitted().items():
        pairs = (f"{fit[key][0]:.2f} ± {fit[key][1]:.2f}" for key in ("m_T", "n_T"))
        print(f"| {lead} | {' | '.join(pairs)} |")


if __name__ == "__main__":
    main()
