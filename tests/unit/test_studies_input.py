"""What a study file may say wrong: one message with every fault, before anything is run."""

from pathlib import Path
from typing import Any

import pytest

from tests.unit.test_studies_factors import fit
from thermobearing.border.errors import InputError
from thermobearing.commands.check import check_file
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import plan

ONE = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": "0 degC"}
NORMAL = {"distribution": "normal", "mean": 1.0, "cov": 0.1}
SIZE = {"plan": "1000x1000mm", "layers": "20x8mm", "shim": "3mm", "lead": "180mm"}
DRAWN = {"kind": "sobol", "samples": 8}


def told(table: dict[str, Any], folder: Path = Path()) -> str:
    """The message on a study."""
    whole = {"kind": "study", "name": "bad"} | table
    with pytest.raises(InputError) as caught:
        plan(make_study(whole, "study.toml", folder))
    return str(caught.value)


FACTORS: list[tuple[dict[str, Any], str]] = [
    ({"motion": None}, "which motion? Give factors.motion"),
    ({"bearings": "x"}, 'did you mean "bearing"'),
    ({"bearing": ["shen-hdr-brigde"]}, 'did you mean "shen-hdr-bridge"'),
    ({"bearing": ["shen-hdr-bridge", "shen-hdr-bridge"]}, 'two are called "shen-hdr-bridge"'),
    ({"motion": ["jra-ii-i-9999"]}, "factors.motion.levels[0]"),
    ({"structure": ["pier-p2"]}, "factors.structure.levels[0]"),
    ({"ambient": [23]}, "has no unit"),
    ({"scale": {"of": "intensity", "levels": [2]}}, "has no unit"),
    ({"scale": {"of": "intensity", "levels": ["2 m"]}}, "factors.scale.levels[0]"),
    ({"scale": ["2 m/s2"]}, "must be a plain number"),
    ({"scale": [-1.0]}, "greater than 0"),
    ({"scale": [1.0, 1.0]}, "factors.scale.levels: one is given more than once"),
    ({"ambient": ["300 degC"]}, "at most 100 degC"),
    (
        {"scale": {"of": "intensity", "measure": "Sa", "levels": ["2 m/s2"]}},
        'measure = "Sa" needs one',
    ),
    ({"scale": {"of": "factor"}}, "either levels or a distribution"),
    ({"ambient": {"climate": "cold-town", "levels": ["0 degC"]}}, "give one of"),
    ({"ambient": {"climate": "cold-twon"}}, 'did you mean "cold-town"'),
    ({"ambient": {"weather": "no.epw"}}, "no such file"),
    ({"ambient": {"levels": ["0 degC"], "history": "3 d"}}, "history: of weather"),
    ({"ambient": {"climate": "cold-town", "years": 1, "history": "400 d"}}, "needs more of them"),
    ({"motion": {"levels": ["jra-ii-i-1"], "weights": [1]}}, "random = true"),
    (
        {"motion": {"levels": ["jra-ii-i-1"], "weights": [1, 2], "random": True}},
        "2 of them for 1 levels",
    ),
    ({"bearing.K_rr": NORMAL}, 'did you mean "bearing.K_r"'),
    ({"pier.mass": NORMAL}, "bearing, structure, case"),
    ({"bearing.K_r": NORMAL, "bearing.hysteresis.layer_stiffness": NORMAL}, "are one number"),
    ({"bearing.K_r": {"of": "value", "levels": [30.0]}}, "factors.bearing.K_r.levels[0]"),
    (
        {"bearing.K_r": {"distribution": "lognormall", "median": 1.0, "cov": 0.1}},
        'did you mean "lognormal"',
    ),
    ({"bearing.K_r": {"distribution": "normal", "mean": 1.0}}, "takes mean and sd or mean and cov"),
    (
        {"bearing.K_r": {"distribution": "normal", "mean": 1.0, "sd": 0.0}},
        "factors.bearing.K_r.sd = 0",
    ),
    (
        {"bearing.K_r": {"distribution": "uniform", "low": 2.0, "high": 1.0}},
        "low = 2 must be less than high = 1",
    ),
    (
        {"bearing.K_r": {"distribution": "normal", "mean": 1.0, "cov": 0.3}},
        "normal distribution reaches",
    ),
    ({"ambient": {"distribution": "normal", "mean": "-60 degC", "sd": "15 K"}}, "reaches -131"),
    ({"ambient": {"distribution": "normal", "mean": "0 degC", "sd": "40 K"}}, "cut it off"),
    ({"ambient": {"distribution": "normal", "mean": "10 degC", "cov": 0.2}}, "mean and sd"),
    (
        {
            "ambient": {"climate": "cold-town", "years": 1},
            "bearing.materials.rubber.conductivity": NORMAL,
        },
        'write history = "10 d" in factors.ambient',
    ),
    ({"bearing": {"posterior": "nowhere"}}, "holds no posterior.csv"),
    ({"bearing": {"posterior": "fit", "counts": 3}}, 'did you mean "count"'),
    ({"bearing": {"posterior": "fit", "levels": ["shen-hdr-bridge"]}}, "beside levels"),
    (
        {"bearing": {"compound": "natural-rubber", "size": SIZE | {"shim": 3.0}}},
        "size.shim = 3.0 has no unit",
    ),
    (
        {"bearing": {"compound": "natural-rubber", "size": SIZE | {"layer": "1x8mm"}}},
        'did you mean "layers"',
    ),
    ({"bearing": {"compound": "natural-rubbr", "size": SIZE}}, 'did you mean "natural-rubber"'),
]


@pytest.mark.parametrize(("factors", "word"), FACTORS)
def test_a_bad_factor_is_reported(tmp_path: Path, factors: dict[str, Any], word: str) -> None:
    fit(tmp_path / "fit")
    whole = {key: value for key, value in (ONE | factors).items() if value is not None}
    drawn = any("distribution" in str(value) or "climate" in str(value) for value in whole.values())
    design = {"design": DRAWN} if drawn or "posterior" in str(whole) else {}
    text = told({"factors": whole} | design, tmp_path)
    assert text.startswith("study.toml: ") or "factors" in text
    assert word in text


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"kind": "studdy"}, ['must be "study"']),
        ({"name": 3}, ["name = 3: no text"]),
        ({"desing": {}}, ['unknown key "desing"', 'did you mean "design"']),
        ({"design": {"kind": "sobol", "samples": 1000}}, ["powers of two, 512 or 1024"]),
        ({"design": {"kind": "latin-hypercube"}}, ['missing key "samples"']),
        ({"design": {"kind": "lhs", "samples": 3}}, ["design.kind = 'lhs'", "latin-hypercube"]),
        ({"design": {"samples": 16}}, ["nothing is drawn"]),
        ({"design": {"arrangement": "saltelli"}}, ["needs draws"]),
        ({"factors": ONE | {"bearing.K_r": NORMAL}}, ["how many draws of bearing.K_r"]),
        ({"keep": {"histories": "best 10"}}, ["keep.histories", "worst 10"]),
        ({"case": {"weather": "w.csv"}}, ["case.weather: give it as factors.ambient"]),
        ({"case": {"motions": "jra-ii-i-1"}}, ["factors.motion says it too"]),
        ({"case": {"duration": 40}}, ["duration", "has no unit"]),
        ({"case": {"duration": "1 ms"}}, ["shorter than a step"]),
        ({"case": {"analysis": {"dtt": "1 ms"}}}, ["analysis.dtt"]),
        ({"case": {"lines": [{"line": "G9", "count": 3}]}}, ['no bearing line is called "G9"']),
        (
            {"case": {"command": "hybrid", "laboratory": {"mode": ["rt", "pd"]}}},
            ["case.laboratory.mode: a study takes one"],
        ),
        ({"case": [], "factors": 3}, ["case: must be a table", "factors: must be a table"]),
    ],
)
def test_a_bad_study_is_told(table: dict[str, Any], words: list[str]) -> None:
    whole = {"factors": ONE} | table
    text = told({key: value for key, value in whole.items() if value is not None})
    for word in words:
        assert word in text, text


def test_every_fault_is_in_one_message() -> None:
    text = told({"factors": ONE | {"ambient": [23], "scale": ["x"], "hour": 3}, "nme": 1})
    for word in ("problems", 'unknown key "nme"', 'unknown factor "hour"', "has no unit"):
        assert word in text


def test_check_says_what_a_study_would_run(tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    head = 'kind = "study"\nname = "p1"\n[design]\nkind = "sobol"\nsamples = 8\n[factors]\n'
    file.write_text(
        head + 'bearing = ["shen-hdr-bridge", "shen-lhdr-bridge"]\nmotion = "jra-ii-i-1"\n'
        'ambient = {climate = "cold-town", years = 1}\n'
    )
    kind, facts, _ = check_file(file)
    assert (kind, facts["runs"], facts["bearing"]) == ("study", "16", "2 levels")


def test_what_the_message_on_heat_says_to_write_is_enough() -> None:
    number = {"distribution": "uniform", "low": 0.9, "high": 1.1}
    ambient = {"climate": "cold-town", "years": 1, "history": "10 d"}
    factors = ONE | {"ambient": ambient, "bearing.materials.rubber.conductivity": number}
    table = {"kind": "study", "name": "heat", "design": DRAWN, "factors": factors}
    assert len(plan(make_study(table, "study.toml"))) == DRAWN["samples"]
