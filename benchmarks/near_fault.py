"""Compare the substitute for II-II-1 with records.

Usage: `python -m benchmarks.near_fault [RECORD[*FACTOR] ...]`.

Prints what the motions are (section 3.4.2) and what the hybrid tests on them give on two bearings
(sections 3.4.3 to 3.4.6), as the Markdown tables of docs/texts/near_fault.md. With `--search` it
looks for the stream of random numbers that `data/phases` names instead; with `--draws` it prints
the displacements that choose the first draws of Type II, ground I.
"""

import sys
from collections.abc import Callable
from dataclasses import replace
from itertools import count, product

import numpy as np
from scipy.optimize import least_squares

import thermobearing as tb
from benchmarks.stored_motions import SEEDS
from thermobearing.core.types import Floats
from thermobearing.motions.matching import matched, misfit
from thermobearing.motions.measures import measure_motion, significant_interval
from thermobearing.motions.process import baseline_corrected
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import Pulse, _first_draw, _motion_name, _near_fault, _phases
from thermobearing.motions.targets import standard_spectrum

NAME, NEAR = "jra-ii-ii-1", 0.1  # [s]
CORNER = 0.1  # of the high-pass filter that records need before velocities are compared [Hz]
USED = 20.0  # [s]
SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)
MOMENTS = [5.0, 10.0, 15.0, 20.0]  # of the first layer [s]
AMBIENT = [23.0, 0.0, -20.0]
PIER = "hybrid-pier-two-bearings"
HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
RUBBER, DESIGN = 112.0, 178.0  # Tables 6.1 and 6.3 [mm]
TRIED = 8  # starts that are followed to their own minimum


def format_values(values: Floats | list[float], form: str) -> str:
    """Numbers with commas."""
    return ", ".join(form.format(value) for value in values)


def fitted_pulse(motion: GroundMotion) -> tuple[Pulse, float]:
    """The pulse nearest to a velocity, and the share of its square that it leaves."""
    velocity = motion.velocity
    time = np.arange(len(velocity)) * motion.dt
    limits = ([100.0, 0.4, 1.0, -9.0, 0.0], [3000.0, 5.0, 8.0, 9.0, USED])

    def gap(numbers: Floats) -> Floats:
        size, period, cycles, phase, middle = (float(number) for number in numbers)
        return Pulse(size, period, cycles, phase, middle).velocity(time) - velocity

    def error(numbers: Floats) -> float:
        return float((gap(numbers) ** 2).sum())

    grid = product((0.9, 1.3, 1.8, 2.5), (1.3, 2.2, 3.2), (0, 1.6, 3.1, 4.7), np.arange(3, 12, 0.5))
    starts = sorted((np.array([1000.0, *point]) for point in grid), key=error)
    ends = [least_squares(gap, start, bounds=limits).x for start in starts[:TRIED]]
    best = min(ends, key=error)
    return Pulse(*(float(number) for number in best)), error(best) / float((velocity**2).sum())


def motion_lines(motion: GroundMotion) -> dict[str, str]:
    """What the motion is."""
    quiet = motion
    if abs(motion.velocity[-1]) > 1.0:  # no record of ours ends so; one that was never corrected
        quiet = baseline_corrected(motion, high_pass=CORNER)
    pulse, unexplained = fitted_pulse(quiet)
    measures, velocity = measure_motion(quiet), quiet.velocity
    peak, fastest = int(np.abs(motion.acceleration).argmax()), int(np.abs(velocity).argmax())
    growth = [significant_interval(motion, 0.0, share)[1] for share in SHARES]
    error = misfit(motion, lambda periods: standard_spectrum("II", "II", periods))
    return {
        "PGA, gal; at, s": f"{motion.pga / 10:.0f}; {peak * motion.dt:.2f}",
        "PGV, cm/s; at, s": f"{measures.pgv / 10:.0f}; {fastest * motion.dt:.2f}",
        "PGD, cm": f"{measures.pgd / 10:.0f}",
        "Arias intensity, m/s": f"{measures.arias_intensity / 1000:.1f}",
        "its 5, 25, 50, 75, 95 %, s": format_values(growth, "{:.1f}"),
        "5-95 % duration, s": f"{growth[-1] - growth[0]:.1f}",
        "fitted pulse: A, cm/s; T, s; gamma; nu, degrees; t0, s": (
            f"{pulse.amplitude / 10:.0f}; {pulse.period:.2f}; {pulse.cycles:.2f}; "
            f"{np.degrees(pulse.phase) % 360.0:.0f}; {pulse.time:.2f}"
        ),
        "share of velocity squared that it explains": f"{1.0 - unexplained:.2f}",
        "misfit to the spectrum, 0.1-3 s": f"{100.0 * error:.1f} %",
    }


def hybrid_lines(motion: str | dict[str, object]) -> dict[str, str]:
    """The default hybrid tests at 23, 0, -20 degC, and what the source says of them."""
    result = tb.hybrid(
        [HDR, LHDR], motion, AMBIENT, structure=PIER, laboratory={"mode": ["rt", "pd"]}
    )
    table = result.table

    def of(bearing: str, mode: str, column: str) -> Floats:
        rows = table[(table["bearing"] == bearing) & (table["mode"] == mode)]
        rows = rows.sort_values("ambient_degC", ascending=False)
        return np.asarray(rows[column], dtype=float)

    lines = {"first layer, LHDR, -20 degC, at 5, 10, 15, 20 s, degC": first_layer(motion)}
    force, energy = "bearing_force_max_kN", "bearing_energy_kN_mm"
    for name, bearing in (("HDR", HDR), ("LHDR", LHDR)):
        lines |= {
            f"{name}: strain, rt": format_values(of(bearing, "rt", "bearing_strain_max"), "{:.2f}"),
            f"{name}: force, rt, kN": format_values(of(bearing, "rt", force), "{:.0f}"),
            f"{name}: force, rt/pd": format_values(
                of(bearing, "rt", force) / of(bearing, "pd", force), "{:.3f}"
            ),
            f"{name}: energy, rt/pd": format_values(
                of(bearing, "rt", energy) / of(bearing, "pd", energy), "{:.3f}"
            ),
            f"{name}: energy, rt, of that at 23 degC": format_values(
                of(bearing, "rt", energy) / of(bearing, "rt", energy)[0], "{:.2f}"
            ),
            f"{name}: pier displacement, rt, mm": format_values(
                of(bearing, "rt", "pier_displacement_max_mm"), "{:.0f}"
            ),
            f"{name}: pier top acceleration, rt, m/s2": format_values(
                of(bearing, "rt", "pier_top_acceleration_max_m_s2"), "{:.1f}"
            ),
        }
    ratio: Callable[[str], Floats] = lambda mode: of(LHDR, mode, energy) / of(HDR, mode, energy)  # noqa: E731
    for mode in ("rt", "pd"):
        lines[f"LHDR/HDR energy, {mode}"] = format_values(ratio(mode), "{:.2f}")
    return lines


def first_layer(motion: str | dict[str, object]) -> str:
    """Of the LHDR at -20 degC in real time."""
    result = tb.hybrid(LHDR, motion, -20.0, structure=PIER)
    time, outer = result["time"].values[0], result["rubber_temperature"].values[0, :, 0]
    recorded = np.isfinite(time)
    return format_values(np.interp(MOMENTS, time[recorded], outer[recorded]), "{:.1f}")


def search() -> None:
    """Print the first stream whose motion peaks where the accelerogram does."""
    wanted = _near_fault()[NAME]
    for number in count():
        fit = matched(
            _phases("II", "II", 1, number - wanted.stream[-1], 0.01),
            0.01,
            lambda periods: standard_spectrum("II", "II", periods),
        )
        peak = float(np.abs(fit.acceleration).argmax()) * 0.01
        if abs(peak - wanted.peak_time) <= NEAR:
            print(f"stream {[*wanted.stream[:-1], number]}: peak at {peak:.2f} s")
            return


def draws() -> None:
    """Print the displacement of the bilinear bearing over its design for draws 0 to the chosen."""
    for seed in SEEDS:
        chosen = _first_draw(_motion_name("II", "I", seed))
        for draw in range(chosen + 1):
            history = _phases("II", "I", seed, draw - chosen, 0.01)
            fit = matched(history, 0.01, lambda periods: standard_spectrum("II", "I", periods))
            motion = GroundMotion(f"draw-{draw}", 0.01, fit.acceleration)
            table = tb.bridge("shen-bilinear-bridge", motion, 23.0).table
            size = table["bearing_strain_max"].iloc[0] * RUBBER
            print(f"seed {seed}, draw {draw}: {size:.0f} mm, {size / DESIGN:.3f}")


def main() -> None:
    """Print both tables."""
    if "--draws" in sys.argv:
        draws()
        return
    if "--search" in sys.argv:
        search()
        return
    chosen = [NAME, *sys.argv[1:]]
    columns: list[dict[str, str]] = []
    for text in chosen:
        name, _, factor = text.partition("*")
        motion = tb.load_motion(name)
        motion = replace(motion, acceleration=motion.acceleration * float(factor or 1.0))
        case = {"name": name, "factor": float(factor or 1.0)}
        columns.append(motion_lines(motion) | hybrid_lines(case))
    print("| | " + " | ".join(chosen) + " |")
    print("|---" * (len(chosen) + 1) + "|")
    for key in columns[0]:
        print(f"| {key} | " + " | ".join(column[key] for column in columns) + " |")


if __name__ == "__main__":
    main()
