"""Lead of bearings drawn at random against finite elements: `python -m benchmarks.lead_drawn`.

None of them was looked at while the ways of heat out of lead were made; the numbers of
docs/verification.md, "Is one dimension good enough?". Needs scikit-fem.
"""

import numpy as np

from tests.verification.lead_cases import Case, errors, lead_rubber

SEED, DRAWN = 7, 10
FILMS = (None, 10.0, 50.0)  # W/(m2 K); none is eta = 2


def drawn(rng: np.random.Generator) -> tuple[str, Case]:
    """A round LRB in touch with its shims, a strain, cycles and a film."""
    diameter, cores = rng.uniform(400.0, 1300.0), int(rng.choice([1, 1, 1, 4]))
    core = diameter * rng.uniform(0.1, 0.28) / np.sqrt(cores)
    rubber, count, shim = (
        rng.uniform(4.0, 12.0),
        2 * int(rng.integers(5, 16)),
        rng.uniform(2.0, 5.0),
    )
    plate = rng.uniform(18.0, 50.0)
    bearing = lead_rubber(diameter, core, (count, rubber, shim), plate, cores=cores)
    film = FILMS[int(rng.integers(len(FILMS)))]
    case = Case(
        bearing, rng.uniform(0.7, 1.8), int(rng.integers(4, 10)), rng.uniform(1.5, 4.0), film
    )
    sizes = f"{diameter:.0f}/{core:.0f} mm, {cores} core(s), {count} x {rubber:.1f}/{shim:.1f} mm"
    return f"{sizes}, plate {plate:.0f} mm, film {film}", case


def main() -> None:
    """One line for each bearing."""
    rng = np.random.default_rng(SEED)
    for _ in range(DRAWN):
        label, case = drawn(rng)
        (ours, rise), (formula, _) = errors(case), errors(case, lead_ends="half-space")
        print(f"{label}: half-space {formula:+.1f}, finite plates {ours:+.1f} of {rise:.0f} K")


if __name__ == "__main__":
    main()
