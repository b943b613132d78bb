"""Inputs that the levels of a study name, loaded once."""

from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing, load_device
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.new import new_bearing
from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.library import is_path
from thermobearing.climate.generator import generate_weather
from thermobearing.climate.hourly import Hourly
from thermobearing.climate.readers import read_weather
from thermobearing.core.records import Ints
from thermobearing.earthquake.case import Motion
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.motions.record import GroundMotion
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.studies.definition.motions import factor_motions, motion_levels
from thermobearing.studies.definition.record import AmbientFactor, BearingFactor, Posterior, Study

AnyBearing: TypeAlias = Bearing | BilinearBearing
YEARS = 50  # of weather that is made up, where nothing is said


class Levels:
    """The levels of a study.

    A bearing is known by its place in `bearings`, where each sample of a posterior has its own.
    """

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def _each(self) -> list[list[AnyBearing]]:
        """Bearings of each level: the samples of a posterior, or a single one."""
        return [
            list(posterior_bearings(one.bearing, Path(one.posterior), one.count)[1:])
            if isinstance(one, Posterior)
            else [one]
            for one in self.study.factors.bearing.levels
        ]

    @cached_property
    def bearings(self) -> list[AnyBearing]:
        """All bearings, level after level."""
        return [bearing for level in self._each for bearing in level]

    @cached_property
    def counts(self) -> Ints:
        """Number of samples of each level of the bearing; 0 of a single one."""
        levels = zip(self._each, self.study.factors.bearing.levels, strict=True)
        counts = [len(each) if isinstance(one, Posterior) else 0 for each, one in levels]
        return np.array(counts, dtype=np.int64)

    def place(self, level: Ints, sample: Ints) -> Ints:
        """Return places in `bearings` of samples (-1: none) of levels."""
        taken = np.maximum(self.counts, 1)
        return np.asarray((np.cumsum(taken) - taken)[level] + np.maximum(sample, 0))

    @cached_property
    def motions(self) -> list[GroundMotion]:
        """Ground motions, not yet scaled."""
        return factor_motions(self.study.factors.motion)

    @cached_property
    def listed(self) -> list[Motion]:
        """The same as data, each with the factor of its level."""
        return motion_levels(self.study.factors.motion)

    @cached_property
    def weather(self) -> Hourly | None:
        """Hourly weather; None where the air is levels or a distribution."""
        return study_weather(self.study.factors.ambient)


def study_weather(ambient: AmbientFactor) -> Hourly | None:
    """Return the weather of a study, read or generated once."""
    if ambient.series is None and ambient.weather is not None:
        ambient.keep_series(read_weather(ambient.weather))
    if ambient.series is None and ambient.climate is not None:
        years, seed = ambient.years or YEARS, ambient.seed or 0
        ambient.keep_series(generate_weather(ambient.climate, years, seed))
    return ambient.series


AnyLevel = Bearing | BilinearBearing | Posterior | Any  # what is none of them, checks will find
ANY = "shen-bilinear-bridge"
OF_POSTERIOR = ("posterior", "bearing", "count", "name")
OF_DRAWING = ("compound", "size", "name")
SIZES = ("plan", "diameter", "layers", "shim", "end_plate", "sealing_plate", "lead")  # text
OTHERS = ("cores", "confined", "end_spreading")


def settle_bearings(table: dict[str, Any], folder: Path, faults: list[str]) -> None:
    """Replace the levels of a table `factors.bearing` by records of bearings and posteriors.

    A calibration or a compound may stand in the table itself instead of `levels`.
    """
    own: dict[str, Any] = {}
    if {"posterior", "compound"} & set(table):
        own = {key: table.pop(key) for key in list(table) if key not in BearingFactor.model_fields}
    if own and "levels" in table:
        faults.append(
            f"factors.bearing: {', '.join(sorted(own))} beside levels; put it among them, as "
            '{posterior = "fit"}'
        )
    levels = table.get("levels") if not own else [own]
    if not isinstance(levels, list):
        return
    settled: list[AnyLevel] = []
    before = len(faults)
    for number, item in enumerate(levels):
        key = "factors.bearing" if own else f"factors.bearing.levels[{number}]"
        try:
            settled += _level(item, folder)
        except InputError as error:
            faults += error.lines(key)
    # A stand-in for what is reported already, so that the other checks go on.
    table["levels"] = settled or [load_device(ANY)] if len(faults) > before else settled
    names = [getattr(item, "name", "") for item in settled]
    twice = dict.fromkeys(name for name in names if name and names.count(name) > 1)
    faults += [
        f'factors.bearing.levels: two are called "{name}"; give each a name' for name in twice
    ]


def _level(item: Any, folder: Path) -> list[AnyLevel]:
    if isinstance(item, str | Path):
        return [load_device(folder / item if str(item).endswith(".toml") else item)]
    if isinstance(item, dict) and "posterior" in item and item.get("kind") != "posterior":
        return [_posterior(item, folder)]
    if isinstance(item, dict) and "compound" in item:
        return list(_drawn(item, folder))
    return [item]


def _posterior(item: dict[str, Any], folder: Path) -> Posterior:
    """Return the samples of a calibration, by its directory or file; read once to be checked."""
    _refuse_unknown(item, OF_POSTERIOR)
    given = item["posterior"]
    if not isinstance(given, str | Path) or not str(given):
        raise InputError("posterior: must name the directory of a fit, or its posterior.csv")
    path = (folder / given).absolute()
    path = path if is_file(path) else path / SAMPLES
    if not is_file(path):
        raise InputError(
            f'posterior = "{given}": holds no {SAMPLES}; identify writes it with --posterior'
        )
    fitted, bearing = path.with_name(IDENTIFIED), item.get("bearing")
    if bearing is None and not is_file(fitted):
        raise InputError(f"posterior: no {IDENTIFIED} next to it; give its bearing")
    if isinstance(bearing, str | Path):
        own = str(bearing).endswith(".toml")
        bearing = load_bearing(folder / bearing if own else bearing)
    bearing = load_bearing(fitted) if bearing is None else bearing
    if not isinstance(bearing, Bearing):
        raise InputError("bearing: must be the name or the file of a bearing")
    more = {"count": item["count"]} if "count" in item else {}
    made = Posterior(
        name=item.get("name", bearing.name), posterior=str(path), bearing=bearing, **more
    )
    posterior_bearings(made.bearing, path, made.count)
    return made


def _drawn(item: dict[str, Any], folder: Path) -> list[Bearing]:
    """Return bearings of a compound, one for each combination of the sizes that are given."""
    _refuse_unknown(item, OF_DRAWING)
    size = item.get("size")
    if not isinstance(size, dict) or not size:
        raise InputError(
            'size: a table such as {plan = "1 x 1 m", layers = "20x8mm", shim = "3 mm"}'
        )
    for key in size:
        if key not in (*SIZES, *OTHERS):
            raise InputError(f'size: unknown key "{key}"{nearest(key, [*SIZES, *OTHERS])}')
    if missing := [key for key in ("layers", "shim") if key not in size]:
        raise InputError(f"size: missing {' and '.join(missing)}")
    compounds = _listed(item["compound"])
    several = {"compound": compounds} | {key: _listed(value) for key, value in size.items()}
    for key in set(SIZES) & set(size):
        for value in several[key]:
            if not isinstance(value, str):
                raise InputError(f'size.{key} = {value!r} has no unit; write "{value} mm"')
    vary = [key for key, values in several.items() if len(values) > 1]
    found = []
    for values in product(*several.values()):
        one = dict(zip(several, values, strict=True))
        compound = one.pop("compound")
        own = folder / compound if is_path(compound) else compound
        words = [str(item.get("name", Path(str(compound)).stem))]
        words += [f"{key} {one[key]}" for key in vary if key != "compound"]
        if "name" in item and "compound" in vary:
            words.append(Path(str(compound)).stem)
        name = " ".join(words).replace("/", " ").replace("\\", " ")
        found.append(new_bearing(name, own, **one))
    return found


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _refuse_unknown(item: dict[str, Any], known: tuple[str, ...]) -> None:
    unknown = [f'unknown key "{key}"{nearest(key, known)}' for key in item if key not in known]
    if unknown:
        raise InputError(unknown)
