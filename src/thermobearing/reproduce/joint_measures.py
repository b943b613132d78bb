"""Measures of a set of choices: what `data/claims/joint.toml` holds between limits.

Each takes what was computed of a set and gives one number or several, all of which must stay
between the limits. Ratios are of the colder over the warmer, from each temperature to the next.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.design.result import source_design
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.structure.model import MassModel, Structure
from thermobearing.structure.result import examine_structure

PLAN = 1440.0  # side of the bearings that the specimen stands for, 3.4.1 [mm]
MOMENTS, LAYER = (5.0, 10.0, 20.0), (-15.0, -5.0)  # 3.4.4 [s, degC]
TYPE_II = "jra-ii-"
WARM, COLD = 23.0, -20.0  # [degC]


@dataclass(frozen=True)
class Computed:
    """Of one set.

    Attributes
    ----------
    structure, mass : as the set has them.
    hdr, lhdr : rows of the runs of each bearing: motion, mode ("" of the bridge), temperature.
    bearing : the HDR bearing.
    layer : of the first layer of the LHDR at -20 degC in real time at `MOMENTS` [degC].
    """

    structure: Structure
    mass: MassModel
    hdr: pd.DataFrame
    lhdr: pd.DataFrame
    bearing: Bearing
    layer: tuple[float, ...] = ()

    @property
    def both(self) -> tuple[pd.DataFrame, pd.DataFrame]:
        """HDR and LHDR."""
        return self.hdr, self.lhdr


def by_temperature(table: pd.DataFrame, column: str, mode: str | None = None) -> Floats:
    """A row a motion, a column a temperature from warm to cold."""
    rows = table if mode is None else table[table["mode"] == mode]
    grid = rows.pivot(index="motion", columns="ambient_degC", values=column)
    return grid[sorted(grid.columns, reverse=True)].to_numpy(dtype=float)


def colder(table: pd.DataFrame, column: str, mode: str | None = None) -> Floats:
    """Each temperature over the warmer one before."""
    grid = by_temperature(table, column, mode)
    return (grid[:, 1:] / grid[:, :-1]).ravel()


def _of_both(c: Computed, column: str, mode: str | None = None) -> Floats:
    """`colder` of both bearings."""
    return np.concatenate([colder(table, column, mode) for table in c.both])


def modes(table: pd.DataFrame, column: str) -> Floats:
    """Real time over pseudo-dynamic, warm to cold."""
    real, slow = (by_temperature(table, column, mode)[0] for mode in ("rt", "pd"))
    return np.asarray(real / slow)


def first_period(c: Computed) -> Floats:
    """With the equivalent stiffness of the bearings [s]."""
    found = examine_structure(c.structure, mass=c.mass, damping="none")
    return np.array([found.table["period_s"].iloc[0]])


def equivalent_stiffness(c: Computed) -> Floats:
    """Of the HDR bearing at its design displacement, 23 degC [kN/mm]."""
    strain = source_design()["bearing"]["u_B_mm"] / c.bearing.total_rubber_thickness
    return np.array([isothermal_cycle(c.bearing, strain).stiffness_kN_mm])


def warm_ductility(c: Computed) -> Floats:
    """Mean of the motions at 23 degC, HDR and LHDR."""
    return np.array([by_temperature(t, "pier_ductility")[:, 0].mean() for t in c.both])


def _type_ii(table: pd.DataFrame, inside: bool = True) -> pd.DataFrame:
    """Runs under motions of Type II, or the others."""
    return table[table["motion"].str.startswith(TYPE_II) == inside]


def cold_ductility(c: Computed) -> Floats:
    """Largest under Type II at -20 degC, HDR and LHDR."""
    found = [by_temperature(_type_ii(t), "pier_ductility")[:, -1].max() for t in c.both]
    return np.array(found)


def largest_ductility(c: Computed) -> Floats:
    """The larger of `cold_ductility`."""
    return np.array([cold_ductility(c).max()])


def colder_pier(c: Computed) -> Floats:
    """Pier displacement."""
    return _of_both(c, "pier_displacement_max_mm")


def types_of_pier(c: Computed) -> Floats:
    """Largest pier displacement under Type II over that under Type I, at each temperature."""
    name = "pier_displacement_max_mm"
    return np.concatenate(
        [
            by_temperature(_type_ii(t), name).max(axis=0)
            / by_temperature(_type_ii(t, False), name).max(axis=0)
            for t in c.both
        ]
    )


def colder_energy(c: Computed) -> Floats:
    """Energy of one bearing."""
    return _of_both(c, "bearing_energy_kN_mm")


def _energy_drops(c: Computed) -> Floats:
    """LHDR under the first motion of Type II, at 0 and -20 against 23 degC [%]."""
    first = by_temperature(_type_ii(c.lhdr), "bearing_energy_kN_mm")[0]
    return np.asarray(100.0 * (first[1:] / first[0] - 1.0))


def energy_at_0(c: Computed) -> Floats:
    """The first of `_energy_drops`."""
    return _energy_drops(c)[:1]


def energy_at_minus_20(c: Computed) -> Floats:
    """The last of `_energy_drops`."""
    return _energy_drops(c)[-1:]


def colder_strain(c: Computed) -> Floats:
    """Strain."""
    return _of_both(c, "bearing_strain_max")


def colder_force(c: Computed) -> Floats:
    """Force."""
    return _of_both(c, "bearing_force_max_kN")


def strain_of_bearings(c: Computed) -> Floats:
    """LHDR over HDR."""
    lhdr, hdr = (by_temperature(t, "bearing_strain_max") for t in (c.lhdr, c.hdr))
    return (lhdr / hdr).ravel()


def colder_deck(c: Computed) -> Floats:
    """Acceleration of the deck at -20 over 23 degC, mean of the motions, HDR and LHDR."""
    grids = [by_temperature(t, "deck_acceleration_max_m_s2") for t in c.both]
    return np.array([(grid[:, -1] / grid[:, 0]).mean() for grid in grids])


def axial_stress(c: Computed) -> Floats:
    """Of the deck on the bearings that the specimen stands for [MPa]."""
    deck = c.structure.report.deck
    weight = 1e3 * STANDARD_GRAVITY * sum(m.mass for m in c.structure.masses if m.body == deck)
    return np.array([weight / (c.structure.bearings[0].count * PLAN**2)])


def specimen_force(c: Computed) -> Floats:
    """Largest force of all tests [kN]."""
    return np.array([t["bearing_force_max_kN"].to_numpy().max() for t in c.both])


def force_of_modes_hdr(c: Computed) -> Floats:
    """At 0 and -20 degC."""
    return modes(c.hdr, "bearing_force_max_kN")[1:]


def force_of_modes_lhdr(c: Computed) -> Floats:
    """At 0 and -20 degC."""
    return modes(c.lhdr, "bearing_force_max_kN")[1:]


def first_layer(c: Computed) -> Floats:
    """Away from the temperatures told for 5 and 10 s, and above 0 degC at 20 s [K]."""
    early, later, late = c.layer
    return np.array([abs(early - LAYER[0]), abs(later - LAYER[1]), max(late, 0.0)])


def energy_of_bearings(c: Computed) -> Floats:
    """LHDR over HDR in real time."""
    lhdr, hdr = (by_temperature(t, "bearing_energy_kN_mm", "rt") for t in (c.lhdr, c.hdr))
    return (lhdr / hdr).ravel()


def colder_energy_rt(c: Computed) -> Floats:
    """Energy in real time."""
    return _of_both(c, "bearing_energy_kN_mm", "rt")


def energy_of_modes(c: Computed) -> Floats:
    """Real time over pseudo-dynamic, of the HDR at -20 degC its inverse."""
    hdr, lhdr = (modes(t, "bearing_energy_kN_mm") for t in c.both)
    return np.concatenate([hdr[:-1], 1.0 / hdr[-1:], lhdr])


def colder_pier_rt(c: Computed) -> Floats:
    """Pier displacement in real time."""
    return _of_both(c, "pier_top_displacement_max_mm", "rt")


def colder_acceleration_rt(c: Computed) -> Floats:
    """Pier acceleration in real time."""
    return _of_both(c, "pier_top_acceleration_max_m_s2", "rt")


def pier_of_modes_hdr(c: Computed) -> Floats:
    """Pier displacement."""
    return modes(c.hdr, "pier_top_displacement_max_mm")


def pier_of_modes_lhdr(c: Computed) -> Floats:
    """Pier displacement."""
    return modes(c.lhdr, "pier_top_displacement_max_mm")
