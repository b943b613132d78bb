"""What the figures have in common: bearings, motions, and the studies that several of them show."""

from collections.abc import Sequence

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.reproduce.runs import AMBIENT, Runs

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
BRIDGE_HDR, BRIDGE_LHDR = "shen-hdr-bridge", "shen-lhdr-bridge"
BILINEAR = "shen-bilinear-bridge"
MOTIONS = ("jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2")
HYBRID_MOTION = "jra-ii-ii-1"
MULTI, SINGLE = "multi-layer", "single-temperature"  # the source's model, and TMC MPW before it
BOTH = ("rt", "pd")
MOMENTS = (5.0, 10.0, 15.0, 20.0)  # of the profiles of the hybrid tests [s]
KEPT = ("rubber", "cells")


def hybrid_tests(
    runs: Runs, bearing: str | Sequence[str], mode: str | Sequence[str] = BOTH, model: str = MULTI
) -> EarthquakeResult:
    """Some of the hybrid tests at 23, 0, -20 degC; all twelve are run together, once."""
    made = runs.hybrid((HDR, LHDR), AMBIENT, BOTH, HYBRID_MOTION, keep=KEPT, model=model)
    return made.sel(bearing=bearing, mode=mode)


def bridge_study(runs: Runs, bearing: str) -> EarthquakeResult:
    """Pier P1 on one kind of bearing: four motions at 23, 0, -20 degC; both kinds run together."""
    return runs.bridge((BRIDGE_HDR, BRIDGE_LHDR), MOTIONS).sel(bearing=bearing)


def bilinear_study(runs: Runs) -> EarthquakeResult:
    """All three bearings of the bridge at 23 degC, where the bilinear one is known."""
    return runs.bridge((BILINEAR, BRIDGE_HDR, BRIDGE_LHDR), MOTIONS, 23.0)
