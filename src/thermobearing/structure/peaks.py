"""The largest of everything over a run, without its rows."""

from thermobearing.core.compile import compiled
from thermobearing.core.step import layer_temperature
from thermobearing.structure.lines import Bearings
from thermobearing.structure.types import Motion, Peaks, System


@compiled
def note_watches(motion: Motion, ground: float, peaks: Peaks) -> None:
    """Displacements and accelerations; `ground` is that of the ground [mm/s2]."""
    for p in range(len(peaks.watches)):
        seen = peaks.watches[p]
        displacement, acceleration = 0.0, peaks.carried[p] * ground
        for i in range(motion.tangent.shape[0]):
            displacement += peaks.places[p, i] * motion.points[i].q
            acceleration += peaks.places[p, i] * motion.points[i].a
        seen.displacement = max(seen.displacement, abs(displacement))
        seen.residual = displacement
        seen.acceleration = max(seen.acceleration, abs(acceleration))


@compiled
def note_lines(bearings: Bearings, peaks: Peaks) -> None:
    """What every bearing line is asked for."""
    for k in range(len(bearings)):
        kind = bearings[k]
        cells = kind.constants.layer_cells
        for m in range(len(kind.lines)):
            seen, books = peaks.lines[kind.lines[m]], kind.states.books[m, 0]
            seen.displacement = max(seen.displacement, abs(books.displacement))
            seen.force = max(seen.force, abs(books.force))
            seen.mismatch = max(seen.mismatch, books.layer_force_mismatch)
            lead = kind.states.branches[m, 0].lead_temperature
            seen.lead_temperature = max(seen.lead_temperature, lead)
            temperature = kind.states.temperature[m]
            for j in range(len(cells)):
                warm = layer_temperature(cells, temperature, j)
                seen.rubber_temperature = max(seen.rubber_temperature, warm)


@compiled
def note_peaks(
    system: System, bearings: Bearings, motion: Motion, ground: float, peaks: Peaks
) -> None:
    """Note where structure, hinges and bearings are, if they are farther than before."""
    note_watches(motion, ground, peaks)
    if len(peaks.lines) > 0:
        note_lines(bearings, peaks)
    for h in range(len(peaks.hinges)):
        seen, bend = peaks.hinges[h], motion.hinges.bends[h]
        seen.rotation = max(seen.rotation, abs(bend.rotation))
        seen.moment = max(seen.moment, abs(bend.moment))
