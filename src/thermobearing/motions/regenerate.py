"""Make the stored built-in motions again: `python -m thermobearing.motions.regenerate`."""

import json
from typing import Any

import numpy as np

from thermobearing.motions.jra import GROUNDS, KINDS
from thermobearing.motions.library import ABOUT, STORED_DT, stored_motions
from thermobearing.motions.synthesis import make_motion

SEEDS = (1, 2, 3)


def regenerate() -> None:
    """Write the file of the built-in motions: three seeds per type and ground.

    Kept as 32-bit numbers: what that leaves of the end velocity is a rounding.
    """
    arrays: dict[str, Any] = {}
    about: dict[str, dict[str, str]] = {}
    for kind in KINDS:
        for ground in GROUNDS:
            for seed in SEEDS:
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
    regenerate()
