"""Records of the tests of Shen (2023): which ones rows want, and what comes out of them.

Rows of kind "needs-test-data" say in `measured` which records judge them, by names of
`data/records.toml`; `python -m reproduction --records FOLDER` looks for files of these names. The
public functions here with simulations as first argument are words of expressions, as those of
`measures`; `tests` and `motions` are the names of the records of a row.
"""

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from reproduction.runs import HYBRID_PIER, Runs, load_data, model_over
from thermobearing.border.errors import InputError
from thermobearing.border.opener import is_folder
from thermobearing.border.schema import Strict, in_unit
from thermobearing.core.records import Floats
from thermobearing.earthquake.analysis import hybrid
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.identify.comparison import LEAST_RISE, Comparison
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.records.checks import NOT_NEEDED, check_test
from thermobearing.identify.records.cycles import compare_loops
from thermobearing.identify.records.record import TestRecord, build_record
from thermobearing.motions.library import load_motion
from thermobearing.motions.readers import read_motion
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.tables.columns import Layout, read_columns
from thermobearing.tables.laboratory import read_laboratory
from thermobearing.tables.text import Form

SAME_AIR = 5.0  # between the temperature of a name and that of its record, at most [K]
REST = 60.0  # after a loading: its first minute is compared [s]
FIRST_SECONDS = 20.0  # of the motion that are simulated, 4.4.2.1 and 5.4.2.1 [s]
HYBRID_MOTION = "motion-ii-ii-1"
PIER = {"pier displacement": "mm", "pier acceleration": "mm/s^2"}  # titles of columns, and units
OF_A_RUN = {  # columns of the table of a study for them, and factors to their units
    "pier displacement": ("pier_top_displacement_max_mm", 1.0),
    "pier acceleration": ("pier_top_acceleration_max_m_s2", 1e3),
}
LOOP = tuple(f"loop_{k}" for k in ("F_plus_kN", "F_minus_kN", "D_plus_mm", "D_minus_mm"))
ENERGY = "loop_energy_kN_mm"
OF_A_TEST = "`time_s`, `displacement_mm`, `force_kN`; ambient temperature"
OF_A_MOTION = "time and acceleration with its unit"
COLUMNS = {  # what a row may want of a test besides, in the words of the list
    "thermocouples": "thermocouples in rubber layers and lead",
    "pier displacement": "`pier_displacement_mm` of the full-scale pier top",
    "pier acceleration": "`pier_acceleration_mm/s2` (absolute) of the full-scale pier top",
}


class Series(Strict):
    """Records of a kind: tests of a specimen at some ambient temperatures, or an accelerogram."""

    name: str
    means: str
    bearing: str = ""
    ambient: tuple[Annotated[float, in_unit("degC")], ...] = ()
    mode: Literal["rt", "pd"] | None = None
    stand_in: str = ""

    def records(self) -> dict[str, float]:
        """Return the ambient temperature of each record by name [degC]; nan of an accelerogram."""
        names = {
            f"{self.name}-{ambient:g}".replace("--", "-minus"): ambient for ambient in self.ambient
        }
        return names or {self.name: np.nan}


class _AllSeries(Strict):
    series: tuple[Series, ...]


class Needs(Strict):
    """Records by name, with `*` for any letters, and what each test has to hold besides force."""

    records: Annotated[tuple[str, ...], Field(min_length=1)]
    columns: tuple[Literal["thermocouples", "pier displacement", "pier acceleration"], ...] = ()

    def wants(self, name: str) -> bool:
        """Return whether a record is among them."""
        return any(fnmatchcase(name, pattern) for pattern in self.records)


class Test(NamedTuple):
    """A test as it was read, and the histories of the pier that its computer moved."""

    record: TestRecord
    rests: list[tuple[int, int]]  # first and last sample of each
    pier: dict[str, Floats]  # those of `PIER` that the file has

    def holds(self, column: str) -> bool:
        """Return whether what a row wants is there."""
        return column in self.pier if column in PIER else bool(self.record.places)


@cache
def _series() -> dict[str, tuple[Series, float]]:
    listed = load_data(_AllSeries, "records.toml").series
    return {
        name: (series, ambient) for series in listed for name, ambient in series.records().items()
    }


def record_words(needs: Needs) -> dict[str, list[str]]:
    """Return the names of the tests and of the accelerograms that a row wants, in order."""
    names: dict[str, list[str]] = {"tests": [], "motions": []}
    for name, (series, _) in _series().items():
        if needs.wants(name):
            names["tests" if series.bearing else "motions"].append(name)
    return names


def _file(folder: Path, name: str) -> Path | None:
    """Return the file of a record, its sidecar if it has one; None if there is none."""
    files = sorted(folder.glob(f"{name}.*"))
    sidecars = [file for file in files if file.suffix.lower() == ".toml"]
    if not sidecars and len(files) > 1:
        names = ", ".join(file.name for file in files)
        raise InputError(f"{names}: keep one of these files, or add {name}.toml", str(folder))
    return next(iter(sidecars or files), None)


@cache
def _load(folder: Path, name: str) -> Test | GroundMotion:
    (series, ambient), path = _series()[name], _file(folder, name) or folder / f"{name}.csv"
    if not series.bearing:
        return read_motion(path)
    readings = read_laboratory(path)
    record, bearing = build_record(readings), Runs().bearing(series.bearing)
    if abs(record.ambient - ambient) > SAME_AIR:
        raise InputError(
            f"the ambient temperature is {record.ambient:g} degC, but the name says {ambient:g} "
            f'degC: set ambient = "{ambient:g} degC" in {name}.toml, or rename the file',
            str(path),
        )
    report = check_test(record.of_bearing(bearing), bearing)
    # A hybrid test has the cycles of its earthquake, not those that a calibration needs.
    allowed = NOT_NEEDED if series.mode else ()
    faults = [f for f in report.findings if f.level == "refused" and f.check not in allowed]
    if faults or report.treatment is None:
        raise InputError([fault.sentence for fault in faults], str(path))
    sidecar = readings.sidecar
    form = Form(None, sidecar.decimal, sidecar.encoding, sidecar.sheet)
    layout = Layout(sidecar.lines_before, sidecar.lines_after, form=form)
    pier = read_columns(readings.recognised.file, PIER, optional=PIER, layout=layout)
    return Test(report.treatment.cleaned, report.treatment.rests, pier)


def check_records(folder: Path) -> dict[str, str]:
    """Read all records that a folder has; return the names of their files by name.

    Raises
    ------
    InputError : no folder; a record that cannot be used, with its file and the reason.
    """
    if not is_folder(folder):
        raise InputError("no such folder of records", str(folder))
    files = {name: file.name for name in _series() if (file := _file(folder, name))}
    for name in files:
        _load(folder, name)
    return files


def missing(needs: Needs, folder: Path) -> str:
    """Return which files, or columns of them, keep a row from being judged; "" if all are there."""
    names = record_words(needs)
    absent = [f"{k}.csv" for some in names.values() for k in some if _file(folder, k) is None]
    if absent:
        return f"missing {', '.join(absent)}"
    tests = {name: _load(folder, name) for name in names["tests"]}
    lacking = {
        name: [column for column in needs.columns if not test.holds(column)]
        for name, test in tests.items()
        if isinstance(test, Test)
    }
    return "; ".join(f"{k} has no {' and no '.join(v)}" for k, v in lacking.items() if v)


def list_wanted(needs: Mapping[str, Needs]) -> list[list[str]]:
    """Return files, what they are, their columns and the rows that want them, a line a series."""
    lines = []
    for series in dict.fromkeys(series for series, _ in _series().values()):
        names = list(series.records())
        rows = {row: need for row, need in needs.items() if any(map(need.wants, names))}
        columns = dict.fromkeys(c for need in rows.values() for c in need.columns if series.bearing)
        contents = [OF_A_TEST if series.bearing else OF_A_MOTION, *(COLUMNS[c] for c in columns)]
        files = ", ".join(f"{name}.csv" for name in names)
        lines.append([files, series.means, "; ".join(contents), ", ".join(rows)])
    return lines


# Words of expressions.


def _test(runs: Runs, name: str) -> Test:
    record = _load(runs.folder, name)
    assert isinstance(record, Test)
    return record


def _motion(runs: Runs, name: str) -> GroundMotion:
    record = _load(runs.folder, name)
    assert isinstance(record, GroundMotion)
    return record


def _compared(runs: Runs, name: str, model: Any = "multi-layer") -> Comparison:
    """Return a test with the model moved by the measured displacement."""

    def make() -> Comparison:
        record, bearing = _test(runs, name).record, runs.bearing(_series()[name][0].bearing)
        options = model_over(runs.options, model)
        forward = ForwardModel(record, bearing, fine=True, options=options)
        prediction = forward.run()
        if prediction is None:
            raise InputError(f"{name}: the model ended early: {forward.ended}")
        return Comparison(record, bearing.name, model, bearing.total_rubber_thickness, prediction)

    return runs.once(make, "record", name, model)


def r2(runs: Runs, tests: Sequence[str], model: Any = "multi-layer") -> Floats:
    """Return R2 of the force of tests, the model moved by their displacement (Eq. 4.38)."""
    return np.array([_compared(runs, name, model).R2 for name in tests])


def loop_ratios(
    runs: Runs, tests: Sequence[str], quantity: str, numbers: Sequence[int], least: float = 0.0
) -> Floats:
    """Return model over test in cycles of these numbers of their amplitude, from a strain on."""
    compared = [_compared(runs, name) for name in tests]
    return np.array(
        [
            1.0 + loop.errors[f"{quantity}_error"]
            for item in compared
            for loop in item.loops
            if loop.number in numbers and loop.amplitude >= least * item.rubber
        ]
    )


def _temperatures(item: Comparison) -> list[tuple[Floats, Floats]]:
    """Return the temperatures of the model and of the test at each thermocouple."""
    predicted = item.prediction.temperatures if item.prediction else {}
    return [(predicted[title], values) for title, values in item.record.temperatures.items()]


def _rests(test: Test) -> list[tuple[int, int]]:
    """Return the first and last sample of each rest of a minute or more after a loading."""
    time = test.record.time
    return [(a, b) for a, b in test.rests if a > 0 and time[b] - time[a] >= REST]


def rise_errors(runs: Runs, tests: Sequence[str], model: Any = "multi-layer") -> Floats:
    """Return the relative error of the rise at the end of each loading (Eq. 4.39), signed."""
    errors: list[float] = []
    for name in tests:
        rests, last = _rests(_test(runs, name)), len(_test(runs, name).record.time) - 1
        ends = [first for first, _ in rests]
        # A loading that no rest follows ends with the record.
        ends += [] if rests and rests[-1][1] == last else [last]
        for values, measured in _temperatures(_compared(runs, name, model)):
            rise, measured_rise = values[ends] - values[0], measured[ends] - measured[0]
            errors += (rise / measured_rise - 1.0)[measured_rise > LEAST_RISE].tolist()
    return np.array(errors)


def cooling_ratios(runs: Runs, tests: Sequence[str], model: Any = "multi-layer") -> Floats:
    """Return the fall of the model over that of the test in the first minute after loadings."""
    ratios: list[float] = []
    for name in tests:
        time, rests = _test(runs, name).record.time, _rests(_test(runs, name))
        for values, measured in _temperatures(_compared(runs, name, model)):
            for first, _ in rests:
                ends = time[first] + np.array([REST, 0.0])
                fall, measured_fall = (
                    np.diff(np.interp(ends, time, v))[0] for v in (values, measured)
                )
                ratios += [fall / measured_fall] if measured_fall > LEAST_RISE else []
    return np.array(ratios)


def _simulated(runs: Runs, name: str, model: Any = "multi-layer") -> EarthquakeResult:
    """Return the simulation of a hybrid test with the accelerogram of the records."""
    series, record = _series()[name][0], _test(runs, name).record
    motion = _motion(runs, HYBRID_MOTION)

    def make() -> EarthquakeResult:
        return hybrid(
            runs.bearing(series.bearing),
            motion,
            record.ambient,
            structure=runs.structure(HYBRID_PIER),
            laboratory={"mode": series.mode},
            duration=min(FIRST_SECONDS, motion.duration),
            **runs.over_all({"model": model}),
        )

    return runs.once(make, "simulated record", name, model)


def hybrid_ratios(runs: Runs, tests: Sequence[str], model: Any = "multi-layer") -> Floats:
    """Return F+, F-, D+, D-, energy of the largest loop, simulation over test, a row each."""
    ratios = []
    for name in tests:
        record = _test(runs, name).record
        loop = compare_loops(record, record.force)[1]
        if loop is None:
            raise InputError(f"{name}: no loop")
        sides = [loop.test["F+"], loop.test["F-"], loop.displacement_max, loop.displacement_min]
        row = _simulated(runs, name, model).table.loc[0, [*LOOP, ENERGY]]
        ratios.append(row.to_numpy(dtype=float) / [*sides, loop.test["energy"]])
    return np.array(ratios)


def pier_ratios(runs: Runs, tests: Sequence[str], column: str) -> Floats:
    """Return the largest displacement or acceleration of the pier, simulation over test."""
    name, factor = OF_A_RUN[column]
    runs_of_tests = [_simulated(runs, test).table[name].item() * factor for test in tests]
    return np.divide(runs_of_tests, [np.abs(_test(runs, k).pier[column]).max() for k in tests])


def largest_forces(runs: Runs, tests: Sequence[str]) -> Floats:
    """Return the largest force of each test [kN]."""
    return np.array([_test(runs, name).record.peak_force for name in tests])


def peak_times(runs: Runs, motions: Sequence[str]) -> Floats:
    """Return when the acceleration of recorded motions is largest [s]."""
    read = [_motion(runs, name) for name in motions]
    return np.array([motion.time[int(np.abs(motion.acceleration).argmax())] for motion in read])


def spectrum_ratios(runs: Runs, motions: Sequence[str], periods: Floats) -> Floats:
    """Return spectra of recorded motions over those of our stand-ins, a row of periods each."""
    ratios = []
    for name in motions:
        pair = _motion(runs, name), load_motion(_series()[name][0].stand_in)
        ratios.append(np.divide(*(response_spectrum(m, periods).acceleration for m in pair)))
    return np.array(ratios)
