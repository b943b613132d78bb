"""Make stored built-in motions again: `python -m thermobearing.motions.regenerate [NAME...]`."""

import json
import sys
from collections.abc import Collection
from typing import Any

import numpy as np

from thermobearing.motions.jra import GROUNDS, KINDS
from thermobearing.motions.library import ABOUT, STORED_DT, stored_motions
from thermobearing.motions.phases import motion_name
from thermobearing.motions.synthesis import make_motion

SEEDS = (1, 2, 3)


def regenerate(names: Collection[str] = ()) -> None:
    """Write the file of the built-in motions: three seeds per type and ground.

    Kept as 32-bit numbers: what that leaves of the end velocity is a rounding. Made on another
    machine they differ by such roundings, so that with names the others stay as they are.

    Parameters
    ----------
    names : of the motions to make again; all by default.
    """
    arrays: dict[str, Any] = {}
    about: dict[str, dict[str, str]] = {}
    if names:
        with np.load(stored_motions()) as stored:
            about = json.loads(str(stored[ABOUT]))
            arrays = {name: stored[name] for name in about}
    for kind in KINDS:
        for ground in GROUNDS:
            for seed in SEEDS:
                if names and motion_name(kind, ground, seed) not in names:
                    continue
                motion = make_motion(kind, ground, seed, STORED_DT)
                arrays[motion.name] = motion.acceleration.astype(np.float32)
                about[motion.name] = {
                    "description": motion.description,
                    "citation": motion.citation,
                }
                print(motion.description)
    arrays[ABOUT] = np.array(json.dumps(about))
    stored_motions().parent.mkdir(exist_ok=True)
    np.savez_compressed(stored_motions(), **arrays)


if __name__ == "__main__":
    regenerate(sys.argv[1:])
