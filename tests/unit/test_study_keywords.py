"""`bridge` and `hybrid`: every option is a named argument, and reaches the case."""

import inspect
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

import thermobearing as tb
import thermobearing.earthquake.analysis as study
from thermobearing.border.errors import InputError
from thermobearing.cyclic.case import Keep
from thermobearing.earthquake.case import EarthquakeAnalysis, EarthquakeCase, Stepping
from thermobearing.model.options import ModelKeywords, ModelOptions, Side
from thermobearing.model.stack import EndFace
from thermobearing.structure.model import load_structure

BOTH = [study.bridge, study.hybrid]
# Every argument with a value that is not its default, and where it must come out.
VALUES: dict[str, Any] = {
    "duration": 3.0,
    "dt": 0.004,
    "method": "linear-acceleration",
    "mass": "published",
    "damping": "element",
    "keep": ("rubber", "cells"),
    "model": "single-temperature",
}
# The same of the fields of the record that `model` takes.
OPTIONS: dict[str, Any] = {
    "scheme": "published",
    "integrator": "euler",
    "hardening": "monotone",
    "small_loops": "closed",
    "heat_source": "dissipation",
    "lead_ends": "half-space",
    "clock": "lead",
    "upper_face": EndFace(eta=1.5),
    "lower_face": EndFace(eta=2.5),
    "side": Side(film=12.0),
    "stack": "full",
}


@pytest.fixture
def make_case(monkeypatch: pytest.MonkeyPatch) -> Callable[..., EarthquakeCase]:
    def make_case(call: Callable[..., Any], *args: Any, **options: Any) -> EarthquakeCase:
        result: list[EarthquakeCase] = []
        monkeypatch.setattr(study, "run_earthquake", lambda case, **_: result.append(case))
        call(*args, **options)
        return result[0]

    return make_case


def test_keywords_are_the_fields_of_the_records() -> None:
    besides = {"axial_force", "limits", "fixed_base", "duration", *Stepping.model_fields}
    assert set(study.EarthquakeKeywords.__annotations__) >= {"state", "exposure"} | besides
    for name, kind in get_type_hints(ModelKeywords).items():
        field = ModelOptions.model_fields[name].annotation
        assert set(get_args(field)) <= {*get_args(kind)} or field in get_args(kind), name


def test_other_former_keywords_are_refused_with_their_place() -> None:
    with pytest.raises(InputError) as caught:
        tb.run("lrb-example", conditioned=6.0)  # type: ignore[call-arg]
    assert 'initial = tb.InitialState(conditioning={"conditioned": ...})' in str(caught.value)
    with pytest.raises(InputError) as caught:
        tb.hybrid("shen-hdr-specimen", specimen="tcp://127.0.0.1:9")  # type: ignore[call-arg]
    assert 'laboratory = {"specimen": ...}' in str(caught.value)
    start = tb.InitialState(conditioning={"conditioned": 6.0})
    with pytest.raises(InputError, match="begins at the ambient"):
        tb.bridge("lrb-example", "jra-ii-i-1", -20, initial=start)


def test_each_field_of_the_model_has_one_place() -> None:
    """In `model`, except what `ModelKeywords` repeats; the refusal of a former keyword says so."""
    fields = set(ModelOptions.model_fields) - {"model"}
    assert set(OPTIONS) == fields - set(ModelKeywords.__annotations__)
    for name in OPTIONS:
        for call in (tb.run, *BOTH, tb.element, tb.BearingElement, tb.opensees.serve):
            with pytest.raises(InputError) as caught:
                call("shen-hdr-bridge", **{name: OPTIONS[name]})
            assert f'"{name}"; give it in model = tb.ModelOptions({name}=...)' in str(caught.value)


@pytest.mark.parametrize("call", [tb.run, *BOTH, tb.element])
def test_named_arguments_are_few(call: Callable[..., Any]) -> None:
    kinds = [one.kind for one in inspect.signature(call).parameters.values()]
    assert kinds.count(inspect.Parameter.KEYWORD_ONLY) <= 10


@pytest.mark.parametrize("call", BOTH)
@pytest.mark.parametrize("name", VALUES)
def test_an_argument_reaches_the_case(
    call: Callable[..., Any], name: str, make_case: Callable[..., EarthquakeCase]
) -> None:
    case = make_case(call, "shen-hdr-bridge", "jra-ii-i-1", -20, **{name: VALUES[name]})
    holder = case.analysis if name in EarthquakeAnalysis.model_fields else case
    assert getattr(holder, name) == VALUES[name]
    default = make_case(call, "shen-hdr-bridge", "jra-ii-i-1", -20)
    holder = default.analysis if name in EarthquakeAnalysis.model_fields else default
    assert getattr(holder, name) != VALUES[name]


@pytest.mark.parametrize("call", BOTH)
def test_options_of_the_model_reach_the_case(
    call: Callable[..., Any], make_case: Callable[..., EarthquakeCase]
) -> None:
    default = make_case(call, "shen-lhdr-bridge", "jra-ii-i-1", -20).analysis
    for name, value in OPTIONS.items():
        chosen = {name: value} | ({"lead_ends": "half-space"} if name == "clock" else {})
        model = ModelOptions(**chosen)
        case = make_case(call, "shen-lhdr-bridge", "jra-ii-i-1", -20, model=model)
        assert getattr(case.analysis, name) == value != getattr(default, name)


@pytest.mark.parametrize("call", BOTH)
def test_what_is_named_reaches_the_case(
    call: Callable[..., Any], make_case: Callable[..., EarthquakeCase], tmp_path: Path
) -> None:
    weather = tmp_path / "night.csv"
    weather.write_text("time_s,temperature_degC\n0,5\n3600,-5\n")
    lab = {"mode": "pd", "speed": "5 mm/s"}
    case = make_case(
        call,
        ["shen-hdr-bridge", "shen-bilinear-bridge"],
        {"name": "jra-ii-i-2", "factor": 2.0},
        structure=load_structure("hybrid-pier"),
        ambient=weather,
        **({"laboratory": lab} if call is study.hybrid else {}),
        method="predictor-corrector",
    )
    assert [bearing.name for bearing in case.bearings] == [
        "shen-hdr-bridge",
        "shen-bilinear-bridge",
    ]
    assert (case.motions[0].name, case.motions[0].factor) == ("jra-ii-i-2", 2.0)
    assert case.structure.name == "hybrid-pier"
    assert case.weather == str(weather)
    if call is study.bridge:
        return
    assert case.laboratory is not None
    assert (case.laboratory.mode, case.laboratory.speed) == (("pd",), 5.0)


@pytest.mark.parametrize("call", BOTH)
@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"durration": 3}, ['unknown key "durration"', 'did you mean "duration"?']),
        ({"metod": "x", "masss": 1}, ['"metod"; did you mean "method"?', '"mass"?']),
        ({"bearings": ["shen-hdr-bridge"]}, ['did you mean "bearing"?']),
        ({"lines": "G1"}, ["lines", "must be a list"]),
        ({"method": "newmark"}, ["method", "average-acceleration"]),
        ({"keep": Keep(every=0)}, ["keep_every"]),
    ],
)
def test_bad_arguments_are_reported(
    call: Callable[..., Any], options: dict[str, Any], pieces: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        call("shen-hdr-bridge", **options)
    assert str(caught.value).startswith(f"{call.__name__}()")
    for piece in pieces:
        assert piece in str(caught.value)


def test_executor_and_progress_are_used() -> None:
    reported: list[tuple[int, int]] = []
    with ThreadPoolExecutor(1) as pool:
        study.bridge(
            "shen-bilinear-bridge",
            "jra-ii-i-1",
            [23.0, 0.0],
            duration=0.1,
            executor=pool,
            progress=lambda done, total: reported.append((done, total)),
        )
    assert reported == [(1, 2), (2, 2)]
