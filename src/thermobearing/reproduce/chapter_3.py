"""What chapter 3 says, computed: a function for each claim of `data/claims/chapter-3.toml`."""

from thermobearing.reproduce.runs import Runs

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
Numbers = float | tuple[float, ...] | list[tuple[float, ...]]


def first_shape_factor(runs: Runs) -> Numbers:
    """S1 of both specimens."""
    return tuple(runs.bearing(name).geometry.first_shape_factor for name in (HDR, LHDR))


def modulus_in_the_cold(runs: Runs) -> Numbers:
    """G_e of the fifth cycle of 250 %, HDR, warm to cold [MPa]."""
    table = runs.cyclic(HDR).cycles
    rows = table[(table["cycle"] == 5) & (table["amplitude_strain"] == 2.5)]
    rows = rows.sort_values("ambient_degC", ascending=False)
    return tuple(float(value) for value in rows["G_eq_MPa"])
