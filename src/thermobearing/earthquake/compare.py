"""The same study with the multi-layer model and with every earlier model that fits a bearing."""

from concurrent.futures import Executor
from typing import get_args

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import Progress, run_earthquake
from thermobearing.model.earlier import REFERENCE, Model, models_that_fit


def compare_models(
    case: EarthquakeCase,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> dict[str, EarthquakeResult]:
    """Results of models by name, the multi-layer one first.

    Each model makes its own motion of the structure. Bilinear bearings are left out: they have no
    heat. A model is run for the bearings that it fits (`lead-alone` needs lead).

    Parameters
    ----------
    case : with the conservative scheme and automatic stack, as earlier models use them.
    executor : any `concurrent.futures` executor; threads by default.
    progress : called with (runs done, all runs) of each model.

    Returns
    -------
    dict of EarthquakeResult

    Raises
    ------
    InputError : all bearings are bilinear; or scheme, stack or model are not those.

    Examples
    --------
    >>> from thermobearing.earthquake.case import make_earthquake_case
    >>> table = {"command": "hybrid", "bearings": ["shen-hdr-specimen"], "ambient": ["0 degC"]}
    >>> results = compare_models(make_earthquake_case(table | {"duration": "1 s"}, "example"))
    >>> list(results)[:2], "lead-alone" in results
    (['multi-layer', 'adiabatic'], False)
    """
    refuse_incomparable(case)
    results: dict[str, EarthquakeResult] = {}
    for model in get_args(Model):
        fitting = [bearing for bearing in warm_bearings(case) if model in models_that_fit(bearing)]
        if fitting:
            analysis = case.analysis.model_copy(update={"model": model})
            mine = case.model_copy(update={"analysis": analysis, "bearings": fitting})
            results[model] = run_earthquake(mine, executor=executor, progress=progress)
    return results


def warm_bearings(case: EarthquakeCase) -> list[Bearing]:
    """Those that have heat."""
    return [bearing for bearing in case.bearings if isinstance(bearing, Bearing)]


def refuse_incomparable(case: EarthquakeCase) -> None:
    """InputError for a study that earlier models cannot be compared in."""
    options, faults = case.analysis, []
    if not warm_bearings(case):
        faults.append("bearings: all are bilinear, which no earlier model changes")
    if options.model != REFERENCE:
        faults.append(f'analysis.model = "{options.model}": all models are run; leave it out')
    if options.scheme != "conservative":
        faults.append(f'analysis.scheme = "{options.scheme}": earlier models need "conservative"')
    if options.stack == "half":
        faults.append('analysis.stack = "half": earlier models with one cell need "auto"')
    if faults:
        raise InputError([f"{fault} (asked for by --compare)" for fault in faults], case.command)
