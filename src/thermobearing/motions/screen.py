"""A ground motion on the terminal."""

from thermobearing.motions.record import MM_S2_PER_GAL, GroundMotion
from thermobearing.motions.result import MM_PER_CM, MotionResult
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.results.screen import print_facts

SHOWN = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0)  # periods [s]


def print_names(motions: list[GroundMotion]) -> None:
    """One line for each motion: name, size, length, what it is."""
    for motion in motions:
        size = f"{motion.pga / MM_S2_PER_GAL:5.0f} gal {motion.duration:6.1f} s"
        _print(f"{motion.name:15}{size}  {motion.description}")


def print_motion(result: MotionResult) -> None:
    """Size, duration and ends of a motion, and how well it fits."""
    told = result.summary()
    facts = {
        "samples": f"{told['samples']} every {told['dt_s']:g} s",
        "largest acceleration": f"{told['pga_gal']:.1f} gal",
        "largest velocity": f"{told['pgv_cm_s']:.1f} cm/s",
        "largest displacement": f"{told['pgd_cm']:.1f} cm",
        "at the end": f"{told['end_velocity_cm_s']:.3g} cm/s, {told['end_displacement_cm']:.3g} cm",
        "Arias intensity": f"{told['arias_intensity_m_s']:.2f} m/s",
        "duration": f"{told['duration_s']:g} s, of which 5 to 95 %: "
        f"{told['significant_duration_s']:.1f} s",
    }
    reference, misfit = result.reference, result.misfit
    if reference is not None and misfit is not None:
        facts["misfit"] = (
            f"{100 * misfit:.1f} % rms over 0.1 to 3 s against Level 2 "
            f"Type {reference.kind}, ground {reference.ground}"
        )
    facts["description"] = result.motion.description or "-"
    print_facts(result.motion.name, facts)


def print_spectrum(result: MotionResult) -> None:
    """Response spectrum at ten periods, beside the standard one."""
    motion, reference, damping = result.motion, result.reference, result.damping
    found = response_spectrum(motion, SHOWN, damping)
    standard = None if reference is None else reference.at(SHOWN)
    last = f"  Type {reference.kind}, ground {reference.ground} [gal]" if reference else ""
    _print(f"{motion.name}, {100 * damping:g} % damping")
    _print(f"period [s]  acceleration [gal]  velocity [cm/s]  displacement [cm]{last}")
    for i, period in enumerate(SHOWN):
        a = found.acceleration[i] / MM_S2_PER_GAL
        v, d = found.velocity[i] / MM_PER_CM, found.displacement[i] / MM_PER_CM
        end = f"{standard[i] / MM_S2_PER_GAL:20.0f}" if standard is not None else ""
        _print(f"{period:10g}{a:20.1f}{v:17.1f}{d:19.2f}{end}")


def _print(line: str) -> None:
    """A line as it is, too long for the terminal or not; told at once if the reader has gone."""
    print(line, flush=True)
