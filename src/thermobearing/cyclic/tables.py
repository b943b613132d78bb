"""Tables of a displacement-controlled test, for the console and for reports."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.cyclic.comparison import comparison_table
from thermobearing.cyclic.equivalent import DESIGN_STRAIN
from thermobearing.cyclic.result import Result, run_name
from thermobearing.quantities.governing import place_of_least
from thermobearing.quantities.register import MINUS, Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.validity import VALID_UNTIL, with_invalid_marked
from thermobearing.report.content import LINE, beyond_mark
from thermobearing.reported import bearing_check_tables
from thermobearing.results.metrics import BACKBONE_DEFINITION, THIRD_CYCLE, CycleMeasures
from thermobearing.results.ranges import MARKED
from thermobearing.results.selection import layer_groups, layer_names

MEASURES = ("G_eq_MPa", "K_eq_kN_mm", "h_eq", "energy_kN_mm")
BACKBONE = ("characteristic_strength_kN", "post_yield_stiffness_kN_mm")
PLANE = tuple(
    f"{name}_{side}_{unit}"
    for name, unit in (("peak_force", "kN"), ("energy", "kN_mm"), ("K_eq", "kN_mm"))
    for side in ("x", "y")
)
LABELS = ("ambient_degC", "amplitude_strain", "cycle")
LIMITED = {"ambient_degC": "ambient", "amplitude_strain": "strain"}
LIMITED |= {"cycle": "cycles", "lead_degC": "lead_temperature"}
MOST_ROWS = 60
FEW_CYCLES = 20  # that the console prints one by one
SAME_AMPLITUDE = 0.999  # of the largest amplitude: rounding only
SAME = 0.05  # of the temperatures of layers that share a column [K]
MODELS = [f"{name} largest K" for name in ("inner layer", "lead")]
MODELS += [f"{name} %" for name in ("peak force", "last G_e", "last h_eq", "last energy")]
MEANINGS = (
    "G_e: equivalent shear modulus (Eq. 3.1); h_eq: equivalent damping ratio (Eq. 3.2); "
    "Q_d, K_d: characteristic strength and post-yield stiffness of the bearing; "
    "temperatures at the end of the cycle."
)
IN_PLANE = (
    "G_e, K_eq: from the force along the largest displacement; h_eq: energy over 4π times the "
    "elastic energy at that displacement; x, y: of single components; temperatures at the end of "
    "the cycle."
)


def result_tables(result: Result) -> dict[str, Table]:
    """Return the tables that the console prints: cycles, energy balance, other models."""
    tables = {"cycles": cycles_table(result)} if len(result.cycles) else {}
    tables |= bearing_check_tables(result)
    tables["energy"] = energy_table(result.energy)
    if result.compared:
        errors = comparison_table(result.compared)
        if result.in_plane:
            return tables | {"line": make_table(errors, caption=LINE, keys=2)}
        names = ["ambient_degC", "model", *MODELS]
        caption = (
            "Earlier models: largest temperature error, error of the peak force and of the last "
            "cycle"
        )
        tables["models"] = make_table(errors, names, caption, keys=2)
    return tables


def measured_cycle_table(result: Result) -> Table | None:
    """Return the cycle that standards measure, at each temperature; None for short tests."""
    cycles = result.cycles
    if len(cycles) <= FEW_CYCLES or result.in_plane or result.compared:
        return None
    strains = cycles["amplitude_strain"].to_numpy(dtype=float)
    strain = float(strains[place_of_least(np.abs(strains - DESIGN_STRAIN))])
    # The design strain, or the amplitude of this test that is nearest to it.
    nearest_cycles = cycles[np.abs(strains - strain) <= (1.0 - SAME_AMPLITUDE) * strain]
    cycle = min(THIRD_CYCLE, int(nearest_cycles["cycle"].max()))
    frame = nearest_cycles[nearest_cycles["cycle"] == cycle].drop_duplicates("ambient_degC")
    warmest = frame.loc[frame["ambient_degC"] == frame["ambient_degC"].max(), "G_eq_MPa"].iloc[0]
    frame = frame.assign(G_eq_ratio=frame["G_eq_MPa"] / warmest)
    caption = f"Cycle {cycle} of {100.0 * strain:.0f} % ({len(cycles)} cycles: --table)"
    columns: list[str | Quantity] = [
        "ambient_degC",
        "G_eq_MPa",
        "K_eq_kN_mm",
        "G_eq_ratio",
        "h_eq",
        "energy_kN_mm",
        *BACKBONE,
        quantity("rubber_degC", name=inner_layer(result), head="Inner rubber"),
        "lead_degC",
        VALID_UNTIL,
    ]
    table = make_table(frame, columns, caption, keys=1, keep_keys=True)
    return with_invalid_marked(table, frame, [*MEASURES, "G_eq_ratio", *BACKBONE])


def largest_cycles(cycles: "pd.DataFrame") -> "pd.DataFrame":
    """Return the cycles of the largest amplitude, which rounding may divide, of `Result.cycles`."""
    strain = cycles["amplitude_strain"]
    selected: pd.DataFrame = cycles[strain >= SAME_AMPLITUDE * strain.max()]
    return selected


def cycles_table(result: Result, *, brief: bool = False) -> Table:
    """Return the measures of cycles; in brief the first, third and last of each amplitude.

    All cycles of a short test are listed in brief too. Of the layer temperatures, the brief table
    holds only that of the innermost layer.
    """
    cycles, cycles_shown = result.cycles, "each cycle"
    if brief and len(cycles) > MOST_ROWS // 3:
        group = _loadings(cycles)
        ends = (group != group.shift()) | (group != group.shift(-1))
        cycles = cycles[ends | (cycles["cycle"] == THIRD_CYCLE)].head(MOST_ROWS)
        cycles_shown = "the first, the third and the last cycle of each amplitude"
    area = float(result.dataset.attrs["area_mm2"])
    least = cycles.get("stress_min_MPa", 0.0)  # in a plane there is none
    peak = np.maximum(cycles["stress_max_MPa"], -least) * (area / 1e3)
    layers = cycles.filter(regex="^rubber")
    groups = layer_groups(layers.to_numpy(), False, SAME) if len(layers.columns) else []
    heat = [
        quantity("rubber_degC", name=layers.columns[j], head=head.partition(" (")[0].capitalize())
        for head, j in groups
    ]
    if brief:
        heat = [quantity("rubber_degC", name=inner_layer(result), head="Inner rubber")]
    columns: list[str | Quantity] = [
        *LABELS,
        *MEASURES,
        "peak_force_kN",
        *(("local_strain", *PLANE) if result.in_plane else BACKBONE),
        *heat,
        "lead_degC",
        VALID_UNTIL,
    ]
    rows, marked = result.tested_range.to_dict("records"), {}
    for name, limit in LIMITED.items():
        if name in cycles:
            pairs = zip(cycles["ambient_degC"], cycles[name], strict=True)
            marked[name] = [beyond_mark(rows, run_name(t), limit, float(v)) for t, v in pairs]
    note = IN_PLANE if result.in_plane else MEANINGS
    note = f"{note} {MARKED}." if any(map(any, marked.values())) else note
    frame = cycles.assign(peak_force_kN=peak)
    table = make_table(
        frame, columns, f"Measures of {cycles_shown}", keys=3, marked=marked, note=note
    )
    return with_invalid_marked(table, frame, [*MEASURES, "peak_force_kN", *BACKBONE, *PLANE])


def _loadings(cycles: "pd.DataFrame") -> "pd.Series[Any]":
    """Return a number for each loading: cycles of one run that follow each other."""
    return ((cycles["cycle"].diff() != 1) | (cycles["ambient_degC"].diff() != 0)).cumsum()


def inner_layer(result: Result) -> str:
    """Return the column of `Result.cycles` of the layer farthest from the end plates."""
    layers = int(result.dataset.sizes.get("layer", 1))
    return f"rubber{layers if result.dataset.attrs['half_stack'] else layers // 2 + 1}_degC"


def ratio_table(result: Result) -> Table | None:
    """Return the last cycle of each amplitude over that at the warmest ambient temperature.

    None with one temperature. Cycles that a run did not come to are left out.
    """
    cycles = result.cycles
    if not len(cycles) or cycles["ambient_degC"].nunique() < 2:
        return None
    last = cycles[_loadings(cycles) != _loadings(cycles).shift(-1)]
    place = last.groupby("ambient_degC").cumcount()
    warmest = float(last["ambient_degC"].max())
    warmest_cycles = last[last["ambient_degC"] == warmest].reset_index(drop=True).reindex(place)
    names = ["G_eq_MPa", "h_eq", "energy_kN_mm", "characteristic_strength_kN"]
    names = [name for name in names if name in last]
    ratios = last.assign(**{n: last[n].to_numpy() / warmest_cycles[n].to_numpy() for n in names})
    if VALID_UNTIL in last:  # one of the two cycles is enough
        ratios[VALID_UNTIL] = last[VALID_UNTIL].fillna(
            pd.Series(warmest_cycles[VALID_UNTIL].to_numpy(), index=last.index)
        )
    same_cycle = last["cycle"].to_numpy() == warmest_cycles["cycle"].to_numpy()
    ratios = ratios[same_cycle & (last["ambient_degC"] != warmest).to_numpy()]
    if not len(ratios):
        return None
    changes: dict[str, Any] = {"unit": "", "factor": 1.0, "form": ".2f"}
    columns = [quantity(n, head=f"{quantity(n).head} ratio", **changes) for n in names]
    caption = f"Last cycle of each amplitude over that at {warmest:g} °C"
    ratios = ratios.sort_values("ambient_degC", kind="stable")
    table = make_table(ratios, [*LABELS, *columns], caption.replace("-", MINUS), keys=3)
    return with_invalid_marked(table, ratios, names)


def warming(result: Result) -> "pd.DataFrame":
    """Return the highest temperature and the rise of rubber layers and lead in each run.

    Of more than three layers the first and the last; empty where they were not kept.
    """
    data = result.dataset
    if "rubber_temperature" not in data:
        return pd.DataFrame()
    names = layer_names(data.sizes["layer"], bool(data.attrs["half_stack"]))
    places = [0, len(names) - 1] if len(names) > 3 else range(len(names))
    rows = []
    for run, ambient in enumerate(data["ambient"].values):
        in_run = data["segment"].values[run] >= 0
        rubber = data["rubber_temperature"].values[run, in_run]
        histories = {names[place]: rubber[:, place] for place in places}
        if result.has_lead:
            histories["lead"] = data["lead_temperature"].values[run, in_run]
        for name, values in histories.items():
            highest = float(values.max())
            rows.append((float(ambient), name, highest, float(values.max() - values[0])))
    return pd.DataFrame(rows, columns=["ambient_degC", "part", "highest_degC", "rise_K"])


def energy_table(energy: "pd.DataFrame") -> Table:
    """Return the energy balance of bearings at the end of each run."""
    note = (
        "Work in = heat released + recoverable; heat released = stored + lost. Residuals are "
        "relative to the largest of these energies."
    )
    return make_table(energy, caption="Energy balance at the end of each run", note=note)


def measured_table(
    cycles: Sequence[CycleMeasures], ends: Sequence[str], strains: Sequence[float]
) -> Table:
    """Return the measures of the cycles of a measured history, and how each ends.

    `strains` are their amplitudes, whose turns may be between two samples.
    """
    frame = pd.DataFrame([vars(m) for m in cycles]).assign(
        cycle=np.arange(1, len(cycles) + 1),
        amplitude_strain=list(strains),
        K_eq_kN_mm=[m.stiffness_kN_mm for m in cycles],
        ends=list(ends),
    )
    strain: list[str | Quantity] = ["cycle", quantity("amplitude_strain", form=".1f")]
    return make_table(
        frame, [*strain, *MEASURES, *BACKBONE, "ends"], "", note=f"{BACKBONE_DEFINITION}."
    )
