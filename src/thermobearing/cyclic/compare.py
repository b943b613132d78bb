"""The same case with the multi-layer model and with every earlier model that fits the bearing."""

from thermobearing.cyclic.case import Case
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run_case
from thermobearing.model.earlier import models_that_fit


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
    for model in models_that_fit(case.bearing):
        analysis = case.analysis.model_copy(
            update={"model": model, "scheme": "conservative", "stack": "auto"}
        )
        results[model] = run_case(case.model_copy(update={"analysis": analysis}))
    return results
