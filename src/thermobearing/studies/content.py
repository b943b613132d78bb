"""What the parts of a study hold, as digests: a run is known by its input, not by its name."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.columns import THINGS
from thermobearing.studies.intensity import intensity
from thermobearing.studies.levels import Ints, Levels
from thermobearing.studies.record import Study

RUN_BYTES = 8  # of the digest that names a run: among ten million, two alike once in 400 000


def digest(*parts: Any) -> bytes:
    """Digest of numbers, texts and arrays, the same on every machine."""
    found = hashlib.sha256()
    for part in parts:
        if isinstance(part, bytes):
            raw = part
        elif isinstance(part, Strict):
            raw = json.dumps(part.model_dump(), sort_keys=True).encode()
        elif hasattr(part, "tobytes"):
            raw = part.astype("<f8").tobytes()
        else:
            raw = json.dumps(part, sort_keys=True).encode()
        found.update(len(raw).to_bytes(8, "little") + raw)
    return found.digest()


def motion_digest(motion: GroundMotion, factor: float) -> bytes:
    """Of the samples of a motion, whatever file they come from, and the factor of its level."""
    return digest(motion.dt, motion.acceleration, factor)


def shared_digest(case: EarthquakeCase) -> bytes:
    """Of what all runs share: the case without what the factors hold, and without documents."""
    table = case.model_dump(
        exclude={"structure", "bearings", "motions", "ambient", "weather", "sources", "rig"}
    )
    for key in ("keep", "keep_every"):
        table["analysis"].pop(key)
    return digest(table)


def run_ids(heads: Sequence[bytes], of_row: Ints, numbers: Floats) -> list[str]:
    """Names of runs, 16 hexadecimal digits each.

    Parameters
    ----------
    heads : digests of what rows have besides their numbers.
    of_row : which head a row has.
    numbers : [rows, columns] of each row.
    """
    raw, width = numbers.astype("<f8").tobytes(), 8 * numbers.shape[1]
    return [
        hashlib.blake2b(
            heads[head] + raw[row * width : (row + 1) * width], digest_size=RUN_BYTES
        ).hexdigest()
        for row, head in enumerate(of_row.tolist())
    ]


class Contents:
    """What the levels of a study hold; rows of a plan have their places among them.

    Attributes
    ----------
    levels : the levels themselves.
    intensities : of each motion, with the factor of its level, see `intensity`.
    """

    def __init__(self, study: Study) -> None:
        factors = study.factors
        self.levels = Levels(study)
        motions, given = self.levels.motions, [one.factor for one in self.levels.listed]
        self.intensities = np.array(
            [
                factor * intensity(motion, factors.scale)
                for motion, factor in zip(motions, given, strict=True)
            ]
        )
        weather = self.levels.weather
        air = [] if weather is None else [weather.temperature, weather.recurs]
        self._shared = digest(shared_digest(study.case), *air, factors.ambient.history)
        self._parts = {
            "structure": [digest(one) for one in factors.structure.levels],
            "bearing": [digest(one) for one in self.levels.bearings],
            "motion": [motion_digest(*one) for one in zip(motions, given, strict=True)],
        }

    def heads(self, places: Mapping[str, Ints], names: Sequence[str]) -> tuple[list[bytes], Ints]:
        """Digests of what rows have besides their numbers, and which of them each row has.

        Parameters
        ----------
        places : of the things of each row, by column; of bearings those in `Levels.bearings`.
        names : of the numbers, which mean something by them only.
        """
        counts = [len(self._parts[name]) for name in THINGS]
        whole = np.ravel_multi_index(tuple(places[name] for name in THINGS), counts)
        different, of_row = np.unique(whole, return_inverse=True)
        heads = []
        for here in zip(*np.unravel_index(different, counts), strict=True):
            things = [self._parts[name][place] for name, place in zip(THINGS, here, strict=True)]
            heads.append(digest(self._shared, *things, list(names)))
        return heads, of_row

    def ids(self, places: Mapping[str, Ints], numbers: Mapping[str, Floats]) -> list[str]:
        """Names of runs, 16 hexadecimal digits each.

        Parameters
        ----------
        places : see `heads`.
        numbers : of each row by name; NaN where a run has no such number.
        """
        names = sorted(numbers)
        values = np.column_stack([numbers[name] for name in names])
        without = np.isnan(values)
        ids = np.empty(len(values), dtype=object)
        for gaps in np.unique(without, axis=0):
            rows = np.flatnonzero((without == gaps).all(axis=1))
            own = {name: place[rows] for name, place in places.items()}
            told = [name for name, gap in zip(names, gaps, strict=True) if not gap]
            heads, of_row = self.heads(own, told)
            ids[rows] = run_ids(heads, of_row, values[rows][:, ~gaps])
        return [str(text) for text in ids]
