"""What the default way of heat out of lead changes: `python -m benchmarks.lead_defaults`.

Cyclic tests and one bridge with both values of `lead_ends`, printed as a Markdown table: the
numbers of docs/verification.md, "Is one dimension good enough?".
"""

import numpy as np

import thermobearing as tb
from thermobearing.model.constants import LeadEnds

WAYS: tuple[LeadEnds, ...] = ("half-space", "finite-plate")
AMBIENT = -20.0  # [degC]
CYCLES = {"step": "cycles", "strain": 1.75, "wave": "sine", "period": 2.0, "count": 11}
TEST = tb.CyclicTest(steps=[CYCLES, {"step": "rest", "duration": 600.0}, CYCLES])
COLUMNS = (("lead_degC", "lead, degC"), ("characteristic_strength_kN", "Q_d, kN"))
ENERGY = ("energy_kN_mm", "energy, kJ")
MOTION, LENGTH = "jra-ii-i-1", 60.0  # [s]
SPECIMEN, BRIDGE, RUBBER = "shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"

Line = tuple[str, list[float]]


def cyclic(name: str) -> list[Line]:
    """Lead temperature, Q_d and energy of single cycles, before and after a rest."""
    results = [
        tb.run(name, TEST, AMBIENT, model=tb.ModelOptions(lead_ends=lead_ends))
        for lead_ends in WAYS
    ]
    lines: list[Line] = []
    for cycle in (11, 12, 22):
        for column, label in (*COLUMNS, ENERGY):
            scale = 1e-3 if column == ENERGY[0] else 1.0
            values = [scale * float(result.cycles[column].iloc[cycle - 1]) for result in results]
            lines.append((f"{name}, cycle {cycle}: {label}", values))
    return lines


def bridge(name: str) -> list[Line]:
    """Pier P1 in one Level 2 motion."""
    studies = [
        tb.bridge(
            name, MOTION, AMBIENT, duration=LENGTH, model=tb.ModelOptions(lead_ends=lead_ends)
        )
        for lead_ends in WAYS
    ]
    subject = f"pier P1 on {name}"
    lead = [float(np.nanmax(study["lead_temperature"].values)) for study in studies]
    lines: list[Line] = [(f"{subject}: lead, degC", lead)]
    for key, label, scale in (
        ("bearing_displacement_max", "bearing displacement, mm", 1.0),
        ("bearing_energy_end", "energy in the bearing, kJ", 1e-3),
        ("pier_ductility", "pier ductility", 1.0),
    ):
        values = [scale * float(study[key].values.ravel()[0]) for study in studies]
        lines.append((f"{subject}: {label}", values))
    return lines


def main() -> None:
    """Print the table."""
    lines = [*cyclic(SPECIMEN), *cyclic(BRIDGE), *cyclic(RUBBER), *bridge(BRIDGE), *bridge(RUBBER)]
    print("| | half-space (old) | finite plates (new) | change |")
    print("|---|---|---|---|")
    for label, (old, new) in lines:
        print(f"| {label} | {old:.4g} | {new:.4g} | {new - old:+.2g} |")


if __name__ == "__main__":
    main()
