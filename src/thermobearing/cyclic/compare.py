"""The same case with the multi-layer model and with every earlier model that fits the bearing."""

from typing import get_args

from thermobearing.cyclic.case import Case
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run_case
from thermobearing.model.earlier import Model

REFERENCE: Model = "multi-layer"


def comparable_models(case: Case) -> list[Model]:
    """Models that can run a case: `lead-alone` needs lead."""
    return [m for m in get_args(Model) if m != "lead-alone" or case.bearing.lead is not None]


def compare_models(case: Case) -> dict[str, Result]:
    """Results of models by name, the multi-layer one first.

    Parameters
    ----------
    case : with the conservative scheme and automatic stack, as earlier models use them.

    Returns
    -------
    dict of Result

    Raises
    ------
    InputError : scheme or stack are not those.

    Examples
    --------
    >>> from thermobearing.cyclic.case import make_case
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1)
    >>> results = compare_models(make_case({}, "example", test=test, ambient=[23.0]))
    >>> list(results)[:2]
    ['multi-layer', 'adiabatic']
    """
    results: dict[str, Result] = {}
    for model in comparable_models(case):
        analysis = case.analysis.model_copy(
            update={"model": model, "scheme": "conservative", "stack": "auto"}
        )
        results[model] = run_case(case.model_copy(update={"analysis": analysis}))
    return results
