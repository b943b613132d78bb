"""Sentences of the README whose numbers are computed: cold bearings, and limits of the library."""

import thermobearing as tb
from thermobearing.design.run import run_factors

HEADLINE = "jra-ii-i-1"  # the motion of the headline, one of those of ground I
LEAD_BEARING = "shen-lhdr-bridge"  # of the headline, its picture and README's bridge
NATURAL_RUBBER = "lrb-example"  # the bearing of the library that is not of high-damping rubber
FORCE, STRAIN = "bearing_force_max_kN", "bearing_strain_max"


def _stiffening_sentence() -> str:
    """Return how much stiffer the library's bearings are in the cold, by kind of rubber."""
    ratios: dict[bool, list[float]] = {True: [], False: []}
    for bearing in tb.list_bearings():
        high_damping = bearing != NATURAL_RUBBER
        for strain in (0.5, 1.75):
            test = tb.cyclic_test(strain=[strain], cycles=3)
            table = tb.run(bearing, test, ambient=[23, -20]).table
            modulus = table.pivot(index="cycle", columns="ambient_degC", values="G_eq_MPa")
            ratios[high_damping] += list(modulus[-20.0] / modulus[23.0])
    high, natural = (f"{min(values):.1f} to {max(values):.1f}" for values in ratios.values())
    return (
        "In tests of the library's high-damping rubber bearings at 50 and 175 % of strain the "
        f"shear modulus at -20 °C is {high} times that at 23 °C in the first three cycles (a maker "
        f"publishes about 1.5 times for his rubbers; `{NATURAL_RUBBER}`, of natural rubber with a "
        f"lead core, an example that was not tested, has {natural} times)."
    )


def _pier_sentences() -> str:
    """Return what cold bearings do to the pier of the default bridge, with its range by motion."""
    motions = [name for name in tb.list_motions() if name.split("-")[2] == "i"]
    table, undamped = (
        tb.bridge(LEAD_BEARING, motions, ambient=[23, -20], damping=damping).table
        for damping in (None, "none")
    )
    ratios = []
    for name in (FORCE, "pier_moment_max_kN_m"):
        peaks = table.pivot(index="motion", columns="ambient_degC", values=name)
        ratios.append(100.0 * (peaks[-20.0] / peaks[23.0] - 1.0))
    force, moment = (f"{ratio[HEADLINE]:.0f} %" for ratio in ratios)
    forces, moments = (f"{ratio.min():.0f} to {ratio.max():.0f} %" for ratio in ratios)
    cold, cold_undamped = (rows[rows["ambient_degC"] == -20.0] for rows in (table, undamped))
    shares = 100.0 * cold["damping_of_input"]
    ductile, more_ductile = (
        f"{rows['pier_ductility'].min():.1f} to {rows['pier_ductility'].max():.1f}"
        for rows in (cold, cold_undamped)
    )
    return (
        "In the same earthquake, high-damping rubber bearings with lead cores "
        f"(`{LEAD_BEARING}`) transmit "
        f"{force} more force at -20 °C than at 23 °C, and the bending moment at the base of the "
        f"bridge pier is {moment} larger ({forces} and {moments} in the {len(motions)} built-in "
        "motions of ground I). An analysis with the properties at 23 °C shows neither. "
        "The viscous damping of this bridge (10 % in its foundation, as published) takes "
        f"{shares.min():.0f} to {shares.max():.0f} % of the input energy at -20 °C: without it "
        f"the pier has a ductility of {more_ductile} instead of {ductile}."
    )


def headline() -> str:
    """Return by how much bearings stiffen in the cold, and what follows for a bridge pier."""
    return f"{_stiffening_sentence()}\n\n{_pier_sentences()}"


def bullets_on_library() -> str:
    """Return what virgin rubber does to the default bridge, and how far its rates leave tests."""
    motions = [name for name in tb.list_motions() if name.split("-")[2] == "i"]
    bearings = ["shen-hdr-bridge", LEAD_BEARING]
    states = ("tested", "virgin")
    results = [tb.bridge(bearings, motions, [23, -20], state=state) for state in states]
    tested, virgin = (
        result.table.set_index(["bearing", "ambient_degC", "motion"]) for result in results
    )
    limits = results[0].tested_range
    rates = limits[limits["limit"] == "strain_rate"]
    changes = (100.0 * (virgin[[FORCE, STRAIN]] / tested[[FORCE, STRAIN]] - 1.0)).sort_index()
    parts = []
    for bearing, words in zip(bearings, ("HDR", "LHDR"), strict=True):
        for ambient in (23.0, -20.0):
            ratios = [changes[name].loc[bearing, ambient] for name in (FORCE, STRAIN)]
            force, strain = (f"{ratio.min():+.0f} to {ratio.max():+.0f} %" for ratio in ratios)
            parts.append(f"{words} at {ambient:g} °C: force {force}, displacement {strain}")
    ductile = [table["pier_ductility"].max() for table in (tested, virgin)]
    return (
        "* The library bearings represent tested (scragged) rubber. Virgin rubber is stiffer, by "
        "how much is assumed from one real test (`--state virgin`, "
        "[how-to](docs/guide/bridge.md#virgin-and-recovered-rubber)). On pier P1 in the "
        f"{len(motions)} built-in motions of ground I: {'; '.join(parts)}; pier ductility up to "
        f"{ductile[1]:.2f}, {ductile[0]:.2f} with tested rubber.\n"
        f"* Strain rates reach {rates['demand'].max():.0f}/s in these motions, "
        f"{rates['largest'].min():.2g} to {rates['largest'].max():.2g}/s in the tests of these "
        "bearings. The force of HDR does not depend on the rate here, since no test of it decides "
        f"how ({_undecided_strength()}); the branch of LHDR is extrapolated "
        "([limits](docs/theory.md#limits))."
    )


def _undecided_strength() -> str:
    """Return how far the rate dependence of HDR, which tests leave open, moves its Q_d."""
    report = run_factors(["shen-hdr-bridge"], temperatures=[23], reference=23, strains=[1.75])
    bands = report.bands.set_index("quantity")
    low, high = (100.0 * bands.loc["Q_d", end] for end in ("lowest", "highest"))
    return f"`lambda`: {low:.0f} to {high:+.0f} % of Q_d at 175 %"
