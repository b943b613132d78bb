"""A calibration as a folder of quoFEM (NHERI SimCenter): inputs, model, parameters and data.

quoFEM writes the parameters of a run into `params.py`, calls `model.py`, and reads `results.out`.
Responses are weighted, so that their differences from the data are the residuals of `identify`, and
parameters are on the scale of the search, on which the prior is uniform. What is held at an assumed
value has a normal prior in its standard uncertainties in the Bayesian input. The keys of the inputs
are those of quoFEM 3.5 and 4 (its examples qfem-0018 and qfem-0034).
"""

import json
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, short_repr, shortened
from thermobearing.border.library import data_path
from thermobearing.border.opener import read_json
from thermobearing.border.schema import validated
from thermobearing.border.units import is_number
from thermobearing.core.records import Floats
from thermobearing.identify.fit.parameters import BACKWARD, Parameter, parameter_set
from thermobearing.identify.fit.problem import LOST, Problem
from thermobearing.identify.records.record import WEIGHTS, TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.covariance import moved_parts
from thermobearing.identify.uncertainty.groups import Group
from thermobearing.laws import load, loaded_files
from thermobearing.results.directory import write_directory

DRIVER, PARAMETERS, MEASURED = "model.py", "params.py", "measured.csv"
PROBLEM, README = "calibration.json", "README.md"
RESULTS = "results.out"  # which quoFEM reads
BEFORE = {"linear": "", "log": "ln_", "log1p": "ln1p_"}  # a symbol, by the scale of the parameter
HELD = "z_"  # before a group that is held at an assumed value
SAMPLES = "time", "displacement", "force", "block"
LARGEST_FILE = 1_000_000_000  # bytes of the problem, with the samples of all tests
# What reading of JSON with other keys or values than those of `_problem_table` raises.
DAMAGED = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError)
KEPT = (
    "name",
    *SAMPLES,
    "ambient",
    "air_offset",
    "ambient_uncertainty",
    "temperatures",
    "places",
    *WEIGHTS,
)  # of a test
INPUTS = "deterministic.json", "bayesian.json"  # of Dakota, of UCSD-UQ
MODEL = '''"""Run the tests with the parameters of quoFEM, and write the responses."""

import params

from thermobearing.identify.quofem import write_responses

write_responses(vars(params))
'''


def write_quofem(identification: Identification, folder: str | Path) -> Path:
    """Write a calibration as a folder that quoFEM opens and runs.

    Parameters
    ----------
    found : Identification
        Its free parameters, bounds, tests, weights and starting values are used.
    folder : str or Path
        New directory. `bayesian.json` is for TMCMC, `deterministic.json` for least squares.

    Returns
    -------
    Path
        The directory.

    Raises
    ------
    OutputError
        The directory exists, or cannot be written.
    """

    def _fill(target: Path) -> None:
        for file, name in _law_files().items():
            shutil.copy(file, target / name)
        starts = {_name(p): _searched(p, p.value) for p in identification.pset.free}
        data = identification.problem.data()
        changes = dict.fromkeys(map(_held_name, _groups(identification)), 0.0)
        texts = {
            DRIVER: MODEL,
            PARAMETERS: "".join(f"{k} = {value!r}\n" for k, value in (starts | changes).items()),
            MEASURED: _row(data, ","),
            PROBLEM: json.dumps(_problem_table(identification), default=np.ndarray.tolist),
            README: _readme(identification),
        }
        lengths = [len(part) for part in data]
        inputs = {name: _input(identification, name, starts, lengths) for name in INPUTS}
        texts |= {name: json.dumps(table, indent=4) for name, table in inputs.items()}
        for name, text in texts.items():
            (target / name).write_text(text, encoding="utf-8")

    return write_directory(Path(folder), _fill)


def write_responses(params: Mapping[str, Any], folder: str | Path = ".") -> None:
    """Run the tests of a folder of `write_quofem` with some parameters, and write results.out.

    `params` holds the values by name, as in params.py. A test that ends early is as far from the
    data as `identify` takes it to be. An InputError names a file of the folder that was damaged, or
    a parameter without a value.
    """
    place = Path(folder)
    problem, groups = _read_problem(place)
    scales = [(p, BACKWARD[p.kind.scale]) for p in problem.pset.free]
    names = [_name(parameter) for parameter in problem.pset.free]
    held = {name: params.get(name, 0.0) for name in map(_held_name, groups)}
    faults = [
        f"{name} = {short_repr(value)}: must be a finite number"
        for name, value in [*((name, params.get(name)) for name in names), *held.items()]
        if not is_number(value) or not np.isfinite(value)
    ]
    if faults:
        raise InputError(faults, str(place / PARAMETERS))
    pairs = zip(names, scales, strict=True)
    try:
        cube = np.array([p.place(inverse(float(params[name]))) for name, (p, inverse) in pairs])
    except OverflowError:
        message = "a logarithm of a parameter is beyond the range of numbers"
        raise InputError(message, str(place / PARAMETERS)) from None
    changes = [(group, float(held[_held_name(group)])) for group in groups]
    residuals: list[Floats] | None = problem.parts(cube, fine=True)
    # At their assumed values the models of the problem are used again; a change builds new ones.
    if any(sigmas != 0.0 for _, sigmas in changes):
        residuals = moved_parts(problem, problem.pset.bearing(cube), changes)
    if residuals is None:
        residuals = [np.full(len(data), LOST) for data in problem.data()]
    parts = zip(problem.data(), residuals, strict=True)
    (place / RESULTS).write_text(_row([data + residual for data, residual in parts], " "))


def _read_problem(place: Path) -> tuple[Problem, list[Group]]:
    """Return the least-squares problem of a folder, and what is held at assumed values."""
    file = place / PROBLEM
    table = read_json(file, LARGEST_FILE)
    try:
        for law in table["laws"]:
            load(place / law)
        return _problem(table), [Group(**group) for group in table["assumed"]]
    except InputError as error:
        raise error.located(file) from None
    except DAMAGED as error:
        cure = "write the folder again with identify --quofem"
        fault = f"is damaged ({type(error).__name__}: {shortened(str(error))}); {cure}"
        raise InputError(fault, str(file)) from None


def _law_files() -> dict[str, str]:
    """Return the files of registered laws, and their names in a folder of quoFEM.

    Files of one name from two folders, and files with the name of another file of the folder, get
    a number; case does not count, as on Windows.
    """
    taken = {DRIVER, PARAMETERS}
    names: dict[str, str] = {}
    for file in map(Path, loaded_files()):
        name, number = file.name, 1
        while name.casefold() in taken:
            number += 1
            name = f"{file.stem}_{number}{file.suffix}"
        taken.add(name.casefold())
        names[str(file)] = name
    return names


def _row(parts: list[Floats], between: str) -> str:
    return between.join(f"{value:.12g}" for value in np.concatenate(parts)) + "\n"


def _name(parameter: Parameter) -> str:
    """Return the name of a parameter in quoFEM, which is one of Python."""
    return BEFORE[parameter.kind.scale] + re.sub(r"\W", "_", parameter.kind.symbol)


def _groups(identification: Identification) -> tuple[Group, ...]:
    """Return the groups of numbers that a calibration assumes."""
    return identification.uncertainty.assumed.groups


def _held_name(group: Group) -> str:
    """Return the name of the change of an assumed group in quoFEM."""
    return HELD + re.sub(r"\W+", "_", group.name.replace("-", "minus_"))


def _searched(parameter: Parameter, value: float) -> float:
    """Return a value on the scale of the search, between the bounds."""
    low, high = parameter.ends
    return low + parameter.place(value) * (high - low)


def _problem_table(identification: Identification) -> dict[str, Any]:
    """Return the least-squares problem of a calibration as JSON takes it, without rounding."""
    ties = {p.kind.key: p.tie for p in identification.pset.parameters if p.tie is not None}
    free = {p.kind.key: (p.lower, p.upper) for p in identification.pset.free}
    tests = []
    problem = identification.problem
    for record, weights in zip(problem.records, problem.weights, strict=True):
        test = {name: getattr(record, name) for name in KEPT}
        tests.append(test | {"clipped": np.flatnonzero(weights == 0.0)})
    return {
        "bearing": identification.pset.base.model_dump(mode="json"),
        "free": [
            *free,
            *(f"{key} = {factor!r} * {tied_key}" for key, (tied_key, factor) in ties.items()),
        ],
        "bounds": free,
        "temperatures": problem.temperatures,
        "laws": list(_law_files().values()),
        "assumed": [group.model_dump() for group in _groups(identification)],
        "tests": tests,
    }


def _problem(table: dict[str, Any]) -> Problem:
    """Return the least-squares problem of `_problem_table`."""
    records, clipped = [], []
    for test in table["tests"]:
        bad = np.zeros(len(test["time"]), dtype=bool)
        bad[np.array(test.pop("clipped"), dtype=np.int64)] = True
        clipped.append(bad)
        samples: dict[str, Any] = {name: np.array(test[name]) for name in SAMPLES}
        samples["temperatures"] = {
            title: np.array(readings, dtype=np.float64)  # null is a missing one
            for title, readings in test["temperatures"].items()
        }
        records.append(TestRecord(**(test | samples)))
    for record in records:
        lengths = {len(getattr(record, name)) for name in SAMPLES}
        if len(lengths | {len(values) for values in record.temperatures.values()}) > 1:
            raise ValueError(f"the samples of {record.name} differ in number")
    bearing = validated(Bearing, table["bearing"], PROBLEM, from_file=False)
    pset = parameter_set(bearing, table["free"], [], table["bounds"])
    return Problem(records, pset, temperatures=table["temperatures"], clipped=clipped)


def _input(
    identification: Identification, name: str, starts: dict[str, float], lengths: list[int]
) -> dict[str, Any]:
    """Return an input of quoFEM: applications, their settings, responses and parameters."""
    variables: list[dict[str, Any]] = []
    for parameter, (symbol, start) in zip(identification.pset.free, starts.items(), strict=True):
        low, high = parameter.ends
        kind: dict[str, Any] = {"distribution": "Uniform", "variableClass": "Uncertain"}
        # Least squares needs a design variable with a start, a Bayesian run a random variable.
        if name == INPUTS[0]:  # versions of quoFEM differ in the spelling of the start
            kind = {"distribution": "ContinuousDesign", "variableClass": "Design"}
            kind |= {"initialpoint": start, "initialPoint": start}
        ends = {"lowerbound": low, "upperbound": high, "inputType": "Parameters", "refCount": 1}
        variables.append({"name": symbol, "value": f"RV.{symbol}", **kind, **ends})
    for group in _groups(identification) if name != INPUTS[0] else ():
        symbol = _held_name(group)
        normal = {"distribution": "Normal", "mean": 0.0, "stdDev": group.widening}
        settings = {"variableClass": "Uncertain", "inputType": "Parameters", "refCount": 1}
        variables.append({"name": symbol, "value": f"RV.{symbol}", **normal, **settings})
    responses = [
        {"name": f"test_{number}", "type": "field", "length": length}
        for number, length in enumerate(lengths, 1)
    ]
    table: dict[str, Any] = json.loads(_template(name))
    return table | {"EDP": responses, "randomVariables": variables}


def _readme(identification: Identification) -> str:
    uncertainty = identification.uncertainty
    estimates = [(item.parameter, item.value) for item in uncertainty.estimates.values()]
    return _template(README).format(
        bearing=identification.bearing.name,
        version=thermobearing.__version__,
        tests=", ".join(record.name for record in identification.records),
        samples=uncertainty.samples,
        worth=uncertainty.effective_samples,
        wider=(uncertainty.samples / uncertainty.effective_samples) ** 0.5,
        found=", ".join(
            f"{_name(parameter)} = {_searched(parameter, value):.6g}"
            for parameter, value in estimates
        ),
    )


def _template(name: str) -> str:
    return data_path("identify", "quofem", name).read_text(encoding="utf-8")
