"""Make the stored motions again: `python -m benchmarks.stored_motions [NAME...]`.

Kept as 32-bit numbers: what that leaves of the end velocity is a rounding. Made on another machine
they differ by such roundings, so that with names the others stay as they are.
"""

import json
import sys
from typing import Any

import numpy as np

from thermobearing.motions.library import ABOUT, STORED, STORED_DT
from thermobearing.motions.synthesis import _motion_name, make_motion
from thermobearing.motions.targets import GROUNDS, KINDS

SEEDS = (1, 2, 3)  # per type and ground


def regenerate(names: list[str]) -> None:
    """Write the file of the built-in motions, all or some of them made again."""
    arrays: dict[str, Any] = {}
    about: dict[str, dict[str, str]] = {}
    if names:
        with np.load(STORED) as stored:
            about = json.loads(str(stored[ABOUT]))
            arrays = {name: stored[name] for name in about}
    for kind, ground, seed in ((k, g, s) for k in KINDS for g in GROUNDS for s in SEEDS):
        if names and _motion_name(kind, ground, seed) not in names:
            continue
        motion = make_motion(kind, ground, seed, STORED_DT)
        arrays[motion.name] = motion.acceleration.astype(np.float32)
        about[motion.name] = {"description": motion.description, "citation": motion.citation}
        print(motion.description)
    arrays[ABOUT] = np.array(json.dumps(about))
    STORED.parent.mkdir(exist_ok=True)
    np.savez_compressed(STORED, **arrays)


if __name__ == "__main__":
    regenerate(sys.argv[1:])
