"""Effective period and damping of a bridge on its bearings, and its natural periods."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from thermobearing.border.lazy import pd
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, validated
from thermobearing.core.records import Floats
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.results.directory import MODES_FILE
from thermobearing.structure.connections.model import DeviceTable
from thermobearing.structure.matrices import find_modes, line_stiffness, total_stiffness
from thermobearing.structure.model import Structure
from thermobearing.structure.run import Prepared, prepare_structure

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

# Kinds of damping that the nominal stiffness of bearings changes; the others leave bearings out.
DAMPED_WITH_BEARINGS = ("element", "source", "source-with-bearings")


class DampingFactor(Strict):
    """Content of data/equivalent/damping.toml; `unverified`: its source was not read."""

    reference: Annotated[float, Field(gt=0, lt=1)]
    exponent: Annotated[float, Field(gt=0, lt=1)]
    largest: Annotated[float, Field(ge=1)]
    source: str
    unverified: bool

    def at(self, ratio: float) -> float:
        """Return B_L, which divides the displacement of a spectrum of 5 % damping."""
        return float(min((ratio / self.reference) ** self.exponent, self.largest))


def damping_factor() -> DampingFactor:
    """Return the rule for B_L."""
    return read_data(DampingFactor, "equivalent", "damping.toml")


def bridge_properties(result: "EarthquakeResult", lines: "pd.DataFrame") -> "pd.DataFrame":
    """Return effective period [s], damping ratio and B_L by state of the rubber and temperature.

    `lines` are those of `line_properties`. The period is that of the first mode with the effective
    stiffness of all lines, the ratio that of the bearings (`bearing_damping_ratio`) times their
    share in the strain energy of this mode,

    xi = sum n E / (2 pi sum n K_eff D^2) phi^T K_lines phi / (phi^T K phi),

    with elastic piers and foundations, whose flexibility lowers the ratio as it lengthens the
    period. The viscous damping of the structure is not in it.
    """
    prepared = _prepared_structure(result)
    structure, matrices = prepared.structure, prepared.matrices
    rows = []
    keys = ["bearing", "state", "ambient_degC"]
    for key, group in lines.groupby(keys, sort=False):
        stiffness = dict(zip(group["line"], group["K_eff_kN_mm"], strict=True))
        # Lines that do not move have no row: they keep the equivalent stiffness of their input.
        stiffnesses = [
            stiffness.get(line.name, line.equivalent_stiffness) for line in structure.bearings
        ]
        total = total_stiffness(structure, matrices, np.array(stiffnesses))
        modes = find_modes(matrices.mass, total, structure.name)
        work = group["count"] * group["K_eff_kN_mm"] * group["design_displacement_mm"] ** 2
        bearing_ratio = float((work * group["h_eff"]).sum() / work.sum())
        # Weights (p_delta) store no strain energy.
        mode = modes.shapes[:, 0]
        share = float(
            (mode @ line_stiffness(structure, matrices, np.array(stiffnesses)) @ mode)
            / (mode @ (total - matrices.geometric) @ mode)
        )
        ratio = bearing_ratio * share
        rows.append(
            dict(zip(keys, key, strict=True))
            | {
                "effective_period_s": float(2.0 * math.pi / modes.frequencies[0]),
                "bearing_damping_ratio": bearing_ratio,
                "effective_damping_ratio": ratio,
                "B_L": damping_factor().at(ratio),
            }
        )
    return pd.DataFrame(rows)


def _analysed_structure(result: "EarthquakeResult") -> tuple[Structure, dict[str, Any]]:
    """Return the structure of a result and the table `analysis` of its case."""
    case = tomllib.loads(str(result.dataset.attrs["case"]))
    return validated(Structure, case["structure"], "structure"), case["analysis"]


def nominal_stiffness(result: "EarthquakeResult") -> str:
    """Return the stiffness [kN/mm] of one bearing in the modes of a result, or its range, as text.

    It is what the structure states for its lines, whichever bearing and temperature a run has.
    """
    structure, _ = _analysed_structure(result)
    stiffnesses = [line.equivalent_stiffness for line in structure.bearings]
    texts = dict.fromkeys(f"{value:.3g}" for value in (min(stiffnesses), max(stiffnesses)))
    return f"{' to '.join(texts)} kN/mm"


def nominal_note(result: "EarthquakeResult") -> str:
    """Return with which stiffness of bearings the modes of a result are, and what it changes."""
    damped = result.dataset.attrs["damping"] in DAMPED_WITH_BEARINGS
    used = "used for these periods and for damping" if damped else "used for these modes only"
    nominal = f"its nominal bearing stiffness, {nominal_stiffness(result)}"
    return f"of the structure with {nominal}, {used}"


def _prepared_structure(result: "EarthquakeResult") -> Prepared:
    """Return the structure of a result with its matrices and modes, as it was analysed."""
    structure, analysis = _analysed_structure(result)
    return prepare_structure(structure, analysis.get("mass", "consistent"), analysis.get("damping"))


def hysteretic_ratios(
    result: "EarthquakeResult", lines: "pd.DataFrame"
) -> dict[str, NDArray[np.float64]]:
    """Return the equivalent damping ratios of the bearings in each mode, by bearing.

    xi_i = sum h_eff phi_i^T K_line phi_i / (phi_i^T K phi_i) over the lines of `line_properties` at
    the warmest temperature, in the modes with equivalent stiffness. None where the modes of a
    result are those of one direction of a structure in plan.
    """
    prepared = _prepared_structure(result)
    structure, modes = prepared.structure, prepared.modes
    equivalent = np.array([line.equivalent_stiffness for line in structure.bearings])
    ratios: dict[str, NDArray[np.float64]] = {}
    if len(modes.frequencies) != len(np.atleast_1d(result.dataset.attrs["periods_s"])):
        return ratios
    warmest = lines[lines["ambient_degC"] == lines["ambient_degC"].max()]
    for name, group in warmest.groupby("bearing", sort=False):
        ratio_by_line = dict(zip(group["line"], group["h_eff"], strict=True))
        line_ratios = np.array([ratio_by_line.get(line.name, 0.0) for line in structure.bearings])
        lossy = line_stiffness(structure, prepared.matrices, equivalent * line_ratios)
        # The shapes have unit modal mass, so that phi^T K phi is the squared frequency.
        shapes = modes.shapes
        ratios[str(name)] = np.einsum("ni,nm,mi->i", shapes, lossy, shapes) / modes.frequencies**2
    return ratios


def structure_devices(result: "EarthquakeResult") -> Sequence[DeviceTable]:
    """Return the devices parallel to the bearings of a result."""
    return _analysed_structure(result)[0].devices or ()


def periods_table(
    result: "EarthquakeResult",
    hysteretic: Mapping[str, Floats] | None = None,
    mode_limit: int | None = None,
    lines: "pd.DataFrame | None" = None,
) -> tuple[Table, "pd.DataFrame"]:
    """Return the first modes as a table, and all of them as a frame; empty without a run.

    Their periods and viscous damping ratios are those with the equivalent stiffness that the
    structure states for its lines, not with K_eff of `line_properties`. `hysteretic` are
    ratios by bearing (`hysteretic_ratios`), `mode_limit` is how many modes the table has. The note
    states K_0 of `lines`, those of `line_properties`.
    """
    attrs = result.dataset.attrs
    if "periods_s" not in attrs:
        return make_table(pd.DataFrame()), pd.DataFrame()
    frame = pd.DataFrame({"period_s": np.atleast_1d(attrs["periods_s"])})
    frame["damping_ratio"] = np.atleast_1d(attrs["damping_ratios"])
    frame.insert(0, "mode_number", range(1, len(frame) + 1))
    period = quantity("period_s", head="Period, entered stiffness", form=".3f")
    columns: list[str | Quantity] = ["mode_number", period]
    columns.append(quantity("damping_ratio", head="Viscous damping ratio"))
    sentences = [
        "Periods and damping ratios are those with the equivalent stiffness that was entered for "
        "each bearing line."
    ]
    if hysteretic:
        sentences.append(
            "The effective period and damping of the bridge, with K_eff of its bearings at their "
            "design displacement, have their own table. Hysteretic damping of the bearings is "
            "equivalent, at their design displacement and warmest temperature, by their share in "
            "the strain energy of the mode; it is not in the viscous ratio."
        )
    # With one bearing, or lines with their own on one bridge, the heads name none.
    labels = result.bearing_labels
    ends = {name: f", {label}" if len(labels) > 1 else "" for name, label in labels.items()}
    for name, ratios in (hysteretic or {}).items():
        frame[f"hysteretic_{name}"] = ratios
        ratio = quantity("damping_ratio", head=f"Hysteretic damping ratio{ends[name]}")
        columns.append(replace(ratio, name=f"hysteretic_{name}"))
    for name in dict.fromkeys(result["bearing"].values.tolist()):
        frame[name] = np.atleast_1d(attrs[f"initial_periods_s:{name}"])
        columns.append(replace(period, name=name, head=f"Initial period, K_0{ends[name]}"))
    sentences.append(
        "Initial periods are those with the initial stiffness K_0 of the model of each bearing, "
        "its tangent without displacement, at the temperature of the first run"
        f"{_initial_numbers(lines)}."
    )
    if mode_limit is not None and len(frame) > mode_limit:
        sentences.append(f"The first {mode_limit} of {len(frame)} modes; all are in {MODES_FILE}.")
    caption = "Natural periods and damping" if hysteretic else "Natural periods and viscous damping"
    if result.directions and not result.in_plan:
        caption += f" along {result.directions[0]}"
    shown = frame.head(mode_limit or len(frame))
    return make_table(shown, columns, caption, note=" ".join(sentences)), frame


def _initial_numbers(lines: "pd.DataFrame | None") -> str:
    """Return K_0 and K_1 of the bearings of lines at the temperature of the first run, in words."""
    if lines is None or not len(lines):
        return ""
    first = lines[lines["ambient_degC"] == lines["ambient_degC"].iloc[0]]
    numbers = dict.fromkeys(
        f"{row['line_bearing']}: {row['K_0_kN_mm']:.2f} kN/mm"
        + (f", K_1 of its loop {row['K_1_kN_mm']:.2f}" if row["kind"] else "")
        for row in first.to_dict("records")
    )
    return f" ({'; '.join(numbers)})"
