"""What the documents of fits, validations, factors, bounds, designs and motions say."""

import hashlib
import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.regression.cases import INPUTS
from tests.unit.report_words import assert_well_formed, numbers_in
from thermobearing.bearing.model import Validity
from thermobearing.design import report as design_report
from thermobearing.design.case import make_design_case
from thermobearing.design.run import run_bounds, run_design, run_factors
from thermobearing.identify import certificate as identify_certificate
from thermobearing.identify import report as identify_report
from thermobearing.identify.fit.parameters import M_T
from thermobearing.identify.records.cycles import compare_loops
from thermobearing.identify.result import _range_of_law
from thermobearing.identify.treatments import describe_treatments
from thermobearing.motions import report as motions_report
from thermobearing.motions.library import load_motion
from thermobearing.motions.run import examine_motion
from thermobearing.quantities.words import first_sentences
from thermobearing.report import pdf
from thermobearing.report.pieces import EXCEEDED, PASSED, Pieces, checks_table
from thermobearing.report.template import _arranged, document
from thermobearing.reporting import make_report
from thermobearing.results.drawing import save_figures
from thermobearing.results.metrics import measure_history
from thermobearing.results.saved import SavedResult
from thermobearing.validate import report as validate_report

SPECIMEN = "shen-hdr-specimen"


def loaded(path: Path) -> SavedResult:
    result = tb.load_result(path)
    assert isinstance(result, SavedResult)
    return result


@pytest.fixture(scope="module")
def record() -> tb.TestRecord:
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, closing_strain=None, dt=0.02)
    return replace(tb.synthetic_record(SPECIMEN, -20.0, test), name="cold")


@pytest.fixture(scope="module")
def fitted(record: tb.TestRecord, tmp_path_factory) -> SavedResult:
    result = tb.identify_bearing(record, SPECIMEN, free=["K_r", "d_y"], starts=1)
    saved = result.save(tmp_path_factory.mktemp("fit") / "out", figures=False)
    save_figures({"loops": result.plot.loops}, saved / "figures", vector=True)
    return loaded(saved)


@pytest.fixture(scope="module")
def fit(fitted: SavedResult) -> Pieces:
    return identify_report.build_pieces(fitted)


def test_fit_form(fit: Pieces) -> None:
    assert_well_formed(fit)
    _arranged(fit)


def test_certificate_of_a_fit(fitted: SavedResult, record: tb.TestRecord) -> None:
    """K_eq, Q_d and h_eq of each cycle are those of `measure`; parameters have intervals."""
    made = identify_certificate.build_certificate(fitted)
    assert_well_formed(made)
    cycles = made.tables["cycles"]
    result = {
        column.name: [row[k] for row in cycles.rows] for k, column in enumerate(cycles.columns)
    }
    side = 1.0 if record.displacement[np.abs(record.displacement) > 1.0][0] > 0.0 else -1.0
    bearing = tb.load_bearing(SPECIMEN)
    measured = measure_history(
        side * record.displacement,
        side * record.force,
        area=bearing.area,
        total_rubber_thickness=bearing.total_rubber_thickness,
    )
    exact = [one.characteristic_strength_kN for one in measured[: len(cycles.rows)]]
    assert_allclose(result["Q_d_test"], exact, rtol=0.05)  # of the noise at zero
    symbols = [row[0] for row in made.tables["parameters"].rows]
    assert symbols == [item["symbol"] for item in fitted.summary["parameters"].values()]
    assert len(made.signatures) == 3
    assert document(made, {}).close  # one page
    assert "/s" in made.answer[0]
    assert " 1/s" not in made.answer[0].replace("about 1/s", "")


@pytest.mark.parametrize("fonts", ["installed", "none"])
def test_certificate_is_one_page(
    fonts: str, fitted: SavedResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Codes and a warning replace letters that no font of the machine has."""
    pytest.importorskip("typst", reason="pip install 'thermobearing[report]'")
    pdfium = pytest.importorskip("pypdfium2", reason="pip install pypdfium2")
    if fonts == "none":
        for name in ("_undrawn", "_compiled"):
            function = getattr(pdf, name)
            monkeypatch.setattr(
                pdf, name, lambda *given, call=function, **_: call(*given, system_fonts=False)
            )
    client = "国土交通省"
    title = {"project": "Brücke 12, Niño", "client": client, "number": "B-12"}
    files = make_report(fitted.path, title=title, certificate=True)
    assert [file.name for file in files] == ["certificate.html", "certificate.pdf"]
    document = pdfium.PdfDocument(files[1])
    assert len(document) == 1
    page = document[0].get_textpage().get_text_bounded()
    assert all(word in page for word in ("Brücke 12, Niño", "Approved by", "K_r"))
    codes = "".join(f"[U+{ord(letter):04X}]" for letter in client)
    replaced = codes in "".join(page.split())
    assert replaced == (client not in page) == ("fonts-noto-cjk" in page)
    assert replaced or fonts == "installed"
    assert page.count("kN/mm") == 5  # in four heads and beside K_r, each on one line
    text = files[0].read_text(encoding="utf-8")
    assert client in text
    assert text.count("Signature") == 3


def test_certificate_of_many_cycles_is_one_page(fitted: SavedResult, tmp_path: Path) -> None:
    """It lists cycles from the first to the last, and the page is full with all of the title."""
    pytest.importorskip("typst", reason="pip install 'thermobearing[report]'")
    pdfium = pytest.importorskip("pypdfium2", reason="pip install pypdfium2")
    folder = shutil.copytree(fitted.path, tmp_path / "fit")
    first = fitted["cycles"].iloc[[0]]
    many = pd.concat([first.assign(cycle=k, test=name) for name in "ab" for k in range(1, 41)])
    many.to_csv(folder / "cycles.csv", index=False)
    table = identify_certificate.build_certificate(loaded(folder)).tables["cycles"]
    assert identify_report.CLOSING not in table.note
    numbers = [row[2] for row in table.rows]
    assert len(numbers) == 8
    assert numbers[:4] == numbers[4:] == [1, 14, 27, 40]
    assert "has all 80" in table.note
    (folder / "logo.png").write_bytes(next(folder.rglob("*.png")).read_bytes())
    title = dict.fromkeys(("project", "structure", "client", "author", "number", "revision"), "A")
    title |= {"date": "2026-11-23", "logo": str(folder / "logo.png")}
    files = make_report(folder, title=title, certificate=True)
    assert len(pdfium.PdfDocument(files[1])) == 1


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a" * identify_certificate.LINE, "a" * identify_certificate.LINE),
        ("The model differs. " + "cause " * 20, "The model differs."),
        ("It is off by 54 %. " + "cause " * 20, "It is off by 54 %."),
        (
            "The zero " + "(cold; " + "x " * 50 + ") is off; it",
            "The zero (cold; " + "x " * 50 + ") is off.",
        ),
        ("The zero is off " + "x " * 50, "The zero is off " + "x " * 50),
    ],
)
def test_a_warning_of_the_certificate_is_not_cut_in_a_clause(text: str, line: str) -> None:
    assert first_sentences(text, identify_certificate.LINE) == line


def test_a_certificate_keeps_what_a_warning_says_of_its_numbers() -> None:
    """The sentence on intervals is beyond the end of a line, and stays; its warning is first."""
    narrow = "The 95 % intervals of s and d_y are too narrow"
    step = (
        "test: the displacement changes by 0.38 mm. " + "Record it " + "again " * 20 + "at 130 Hz"
    )
    clause = (
        "The noise is large" + " so" * 40 + "; its intervals are narrow. Filter it" + " now" * 20
    )
    others = [f"Another cause {k} of no number. " + "reason " * 20 for k in range(3)]
    warnings = identify_certificate._certified_warnings([*others, f"{step}. {narrow}", clause])
    assert warnings[0] == f"Warning: test: the displacement changes by 0.38 mm. {narrow}."
    assert warnings[1] == f"Warning: {clause.partition(' Filter')[0]}"
    assert warnings[2] == "Warning: Another cause 0 of no number."
    assert warnings[3].startswith("The file report.html has 2 more warnings")
    assert len(warnings) == identify_certificate.MOST_WARNINGS + 1


@pytest.mark.parametrize(
    ("value", "printed"), [(0.99958, 0.9996), (0.99998, 0.9999), (0.5, 0.5), (1.0, 1.0)]
)
def test_a_check_of_the_agreement_states_1_of_none_but_a_perfect_one(
    fitted: SavedResult, value: float, printed: float
) -> None:
    records = [{**record, "R2": value} for record in fitted.summary["records"]]
    checks = identify_report._report_checks({**fitted.summary, "records": records})
    assert checks_table(checks).rows[0][1] == printed


def test_a_certificate_names_specimens_sizes_and_references(fitted: SavedResult) -> None:
    records = [
        record | {"conditions": record["conditions"] | {"specimen": name}}
        for record in fitted.summary["records"]
        for name in ("B-07", "B-08", "B-07")
    ]
    plain = identify_certificate.build_certificate(fitted)
    assert plain.title.endswith(f"certificate of {SPECIMEN}")
    named = replace(fitted, summary={**fitted.summary, "records": records[:1]})
    assert identify_certificate.build_certificate(named).title.endswith("of specimen B-07")
    both = replace(fitted, summary={**fitted.summary, "records": records})
    assert identify_certificate.build_certificate(both).title.endswith("of specimens B-07 and B-08")
    assert "compound.toml" in plain.question
    item = next(iter(fitted.summary["parameters"].values()))
    parameters = {**fitted.summary["parameters"], "m": {**item, "symbol": "m_T"}}
    table = identify_certificate._certified_parameters(
        {**fitted.summary, "parameters": parameters},
        {"hysteresis": {"reference_temperature": "23.0 degC"}},
    )
    assert table.note.startswith("K_r is the value at 23 °C and m_T is per 100 K. ")


def test_certificate_explains_numbers_that_are_missing(fitted: SavedResult) -> None:
    """The fourth of five cycles closed a block."""
    first = fitted["cycles"].iloc[[0]]
    table = identify_certificate._certified_cycles(
        pd.concat([first.assign(cycle=k) for k in (1, 2, 3, 5)]), 9
    )
    assert table.note == identify_report.CLOSING


def test_certificate_of_many_tests_leaves_cycles_to_their_file(fitted: SavedResult) -> None:
    """22 rows have room on the page; the figure states how many tests it shows."""
    for count, listed in ((5, True), (7, False)):  # a row for each test, and two parameters
        records = fitted.summary["records"] * count
        made = identify_certificate.build_certificate(
            replace(fitted, summary={**fitted.summary, "records": records})
        )
        assert ("cycles" in made.tables) is listed
        assert ("cycles.csv" in made.tables["tests"].caption) is not listed
        assert f"3 of {count} tests" in made.figures["loops"].caption


def test_certificate_states_the_treatment_of_each_record(fitted: SavedResult) -> None:
    """Offset, sign, spikes and drift with their numbers; a test held out stands in the table."""
    (record,) = fitted.summary["records"]
    treatment = record["treatment"] | {
        "subtracted": {"force_kN": -2.5, "displacement_mm": 1.5},
        "force_reversed": True,
        "spikes": {"displacement": 0, "force": 3},
        "spikes_removed": True,
        "drift": {"force_kN": 4.11},
        "drift_error": {"force_kN": 0.18},
        "drift_removed": ["force"],
    }
    worse = [cycle | {"G_eq_error": -0.123, "h_eq_error": 0.077} for cycle in record["cycles"]]
    held_out = record | {"name": "cool", "treatment": treatment, "cycles": worse}
    limits = {"K_eq": 0.15, "h_eq": 0.15}
    summary = fitted.summary | {"held_out": {"limits": limits, "tests": [], "records": [held_out]}}
    table = identify_certificate.build_certificate(replace(fitted, summary=summary)).tables["tests"]
    rows = [
        dict(zip((column.name for column in table.columns), row, strict=True))
        for row in table.texts()
    ]
    assert [(row["test"], row["use"]) for row in rows] == [
        ("cold", "calibration"),
        ("cool", "held out"),
    ]
    assert rows[1]["K_eq_error"].endswith("12.3")
    assert rows[1]["h_eq_error"] == "+7.7"
    (steps,) = (text for text in describe_treatments([held_out]))
    assert steps in table.note
    places = [
        steps.index(word)
        for word in ("2.5 kN", "1.5 mm", "sign", "3 spikes", "4.11 \N{PLUS-MINUS SIGN} 0.18")
    ]
    assert places == sorted(places)  # in the order of the treatment
    (plain,) = describe_treatments([record])
    assert not any(character.isdigit() for character in plain)


def test_certificate_names_tests_held_out_and_warnings(fitted: SavedResult, tmp_path: Path) -> None:
    """Three tests with their properties, ten parameters and five warnings fill one page."""
    pytest.importorskip("typst", reason="pip install 'thermobearing[report]'")
    pdfium = pytest.importorskip("pypdfium2", reason="pip install pypdfium2")
    folder = shutil.copytree(fitted.path, tmp_path / "fit")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    (key, item), *_ = summary["parameters"].items()
    more = {f"{key}_{k}": item for k in range(10 - len(summary["parameters"]))}
    test = {"role": "held out", "test": "cool", "ambient_degC": -10.0, "fold": 0}
    test |= {"K_eq_error": -0.127, "h_eq_error": 0.02}
    test |= {"K_eq_verdict": "within", "h_eq_verdict": "within"}
    tests = [test | {"role": "fitted", "K_eq_error": 0.333}, test]
    about = {"specimen": "SP-2026-04", "laboratory": "EMPA Zurich", "date": "2026-11-23"}
    record = summary["records"][0]
    properties = [
        one | {"test": f"{at} degC", "ambient_degC": at, "ratio": ratio, "measured_ratio": ratio}
        for at, ratio in ((23.0, None), (0.0, 1.4), (-20.0, 1.8))
        for one in summary["properties"]
    ]
    summary |= {
        "properties": properties,
        "parameters": summary["parameters"] | more,
        "records": 3 * [record | {"conditions": record["conditions"] | about}],
        "held_out": {"limits": {"K_eq": 0.15, "h_eq": 0.15}, "tests": tests, "verdict": "within"},
        "warnings": 5 * ["the force loops are at 2.9 kN, " + 20 * "not at zero, "],
    }
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    made = identify_certificate.build_certificate(loaded(folder))
    answer, brief = made.answer, made.tables["properties"]
    assert len(brief.rows) == 5  # three temperatures, and two ratios to the warmest
    (first, *_), (_, cold, *_) = brief.rows[0][1:], brief.rows[2]
    assert float(first) == pytest.approx(properties[0]["measured"], rel=0.005)
    assert float(cold) == 1.4
    middle, half = map(float, brief.rows[0][2].split("\N{PLUS-MINUS SIGN}"))
    assert middle == pytest.approx(properties[0]["model"], rel=0.005)
    width = properties[0]["upper"] - properties[0]["lower"]
    assert 0.5 * width <= half < 0.55 * width  # two digits, rounded up
    (held_out,) = (text for text in answer if "cool" in text)
    assert "12.7" in held_out
    assert "33.3" not in held_out
    warnings = [text for text in answer if text.startswith("Warning")]
    assert len(warnings) == identify_certificate.MOST_WARNINGS
    assert all(text.count("not at zero") == 20 for text in warnings)  # one clause
    title = dict.fromkeys(("project", "structure", "client", "author", "number", "revision"), "A")
    title["date"] = "2026-11-23"
    files = make_report(folder, title=title, certificate=True)
    pages = pdfium.PdfDocument(files[1])
    assert len(pages) == 1
    width, height = pages[0].get_size()
    assert width < height
    words = " ".join(pages[0].get_textpage().get_text_bounded().split())
    places = [words.index(f"Table {k}") for k in (1, 2, 3)]
    assert places == sorted(places)
    assert places[-1] < words.index("Signature")


def test_digests_of_a_certificate_are_those_of_the_files(
    record: tb.TestRecord, tmp_path: Path
) -> None:
    """Sidecars count too, and so do tests held out."""
    columns = {"time_s": record.time, "displacement_mm": record.displacement}
    files = []
    for name, offset in (("cold", 0.0), ("cool", 0.05 * record.peak_force)):
        files += [tmp_path / f"{name}.csv", tmp_path / f"{name}.toml"]
        pd.DataFrame(columns | {"force_kN": record.force + offset}).to_csv(files[-2], index=False)
        files[-1].write_text('ambient = "-20 degC"\n', encoding="utf-8")
    result = tb.cross_validate(
        [files[0]], SPECIMEN, hold_out=[files[2]], free=["K_r", "d_y"], starts=1
    )
    saved = loaded(result.save(tmp_path / "out", figures=False))
    listed = saved.path / "inputs.sha256"
    lines = dict(reversed(line.split("  ")) for line in listed.read_text("utf-8").splitlines())
    exact = {str(file): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}
    assert lines == exact
    made = identify_certificate.build_certificate(saved)
    digests = [row[-1] for row in made.tables["files"].rows]
    assert digests == [exact[str(file)] for file in files if file.suffix == ".csv"]
    digest = hashlib.sha256(listed.read_bytes()).hexdigest()
    assert sum(digest in text for text in made.answer) == 1
    # What the checks find in a test held out is a warning, and stands in its treatment.
    assert any(text.startswith("held out, cool: the zero of the force") for text in result.warnings)
    (kept,) = saved.summary["held_out"]["records"]
    assert kept["treatment"]["offsets"]["force_kN"] == pytest.approx(offset, rel=0.1)
    assert "offset of the force" in made.tables["tests"].note


@pytest.mark.parametrize(
    ("ends", "shown"),
    [
        (["-20.3 degC", "23.8 degC"], "\N{MINUS SIGN}20 to 24 °C"),
        (["1.0872 1/s", "1.0881 1/s"], "1.1/s"),
        ([0.0, 3.0], "0 to 3"),
    ],
)
def test_ranges_of_a_certificate_are_rounded(ends: list[Any], shown: str) -> None:
    assert identify_report.rounded_range(ends) == shown


@pytest.mark.parametrize(
    ("reached", "warmest"), [({}, 23.0), ({"rubber 3": 30.44, "lead": 80.0}, 30.4)]
)
def test_the_law_reaches_to_the_temperatures_of_the_rubber(
    record: tb.TestRecord, reached: dict[str, float], warmest: float
) -> None:
    """Those of thermocouples in the rubber; that of the lead says nothing on rubber."""
    places = {place: place for place in reached}
    temperatures = {place: np.array([23.0, highest]) for place, highest in reached.items()}
    warm = replace(record, ambient=23.0, places=places, temperatures=temperatures)
    stub: Any = SimpleNamespace(
        bearing=tb.load_bearing(SPECIMEN),
        records=[record, warm],
        uncertainty=SimpleNamespace(estimates={M_T: None}),
    )
    law = _range_of_law(stub)
    assert law is not None
    assert (law.coldest, law.warmest) == (-20.0, warmest)


def test_only_an_acceptable_calibration_has_a_certificate(fitted: SavedResult) -> None:
    poor = {**fitted.summary, "outcome": "poor_fit", "sentence": "too bad"}
    with pytest.raises(tb.InputError, match=r"no certificate .* \(poor fit: too bad\)"):
        identify_certificate.build_certificate(replace(fitted, summary=poor))
    other = {**fitted.summary, "command": "lambda"}
    with pytest.raises(tb.InputError, match="only a calibration"):
        identify_certificate.build_certificate(replace(fitted, summary=other))


def test_strength_of_a_cycle_is_exact() -> None:
    """Of an ellipse, half the difference of the forces at zero displacement is its Q."""
    angle = np.linspace(0.0, 4.0 * np.pi, 403)
    x, strength = 20.0 * np.sin(angle), 7.0
    record = tb.record_from_arrays(angle, x, 3.0 * x + strength * np.cos(angle), 23.0)
    loops, _ = compare_loops(record, 2.0 * record.force)
    assert len(loops) >= 1
    for loop in loops:
        assert_allclose(loop.strengths, [strength, 2.0 * strength], rtol=2e-4)


def test_fit_numbers(fitted: SavedResult, fit: Pieces) -> None:
    reported = fitted.summary["parameters"]["hysteresis.layer_stiffness"]
    (parameters,) = (text for text in fit.answer if "K_r" in text)
    assert f"K_r = {reported['value']:.4g} kN/mm" in parameters
    assert f"({reported['lower']:.4g} to {reported['upper']:.4g})" in parameters
    assert "G_e" in fit.answer[0]  # properties of the bearing before parameters of the model
    table = fit.tables["parameters"]
    assert numbers_in(table, "Estimate")[0] == reported["value"]
    assert numbers_in(table, "Standard error")[0] == reported["stderr"]
    cycles = fit.tables["cycles"]
    rows = fitted["cycles"]
    assert numbers_in(cycles, "K_eq, test") == rows["K_eq_test"].tolist()
    assert len(cycles.rows) == 2
    errors = [cycle["G_eq_error"] for cycle in fitted.summary["records"][0]["cycles"]]
    assert np.allclose(rows["K_eq_ratio"] - 1.0, errors, atol=1e-6)
    agreement = fit.tables["records"]
    heads = [column.name for column in agreement.columns]
    ends = [agreement.rows[0][heads.index(f"G_eq_error_{end}")] for end in ("least", "largest")]
    assert ends == pytest.approx([100.0 * min(errors), 100.0 * max(errors)])


def test_fit_says_what_the_test_was(fitted: SavedResult, fit: Pieces) -> None:
    tests = fit.inputs["tests"]
    row = dict(zip((column.name for column in tests.columns), tests.rows[0], strict=True))
    conditions = fitted.summary["records"][0]["conditions"]
    assert row["ambient_degC"] == -20.0
    assert row["largest_strain"] == pytest.approx(100.0, rel=1e-3)
    assert "sha256" not in row
    assert conditions["sha256"] in fit.identity.values()
    assert "treatment" in fit.inputs
    assert "shear strains of 100 % at ambient temperatures of −20 °C" in fit.answer[-1]
    assert not fit.validity
    parameters = {r[0]: r for r in fit.inputs[f"{SPECIMEN}-identified.parameters"].rows}
    assert "standard error" in parameters["Initial stiffness of one layer K_r"][3]
    assert any(row[0] == "conduction of heat" for row in fit.tables["undetermined"].rows)


def test_fit_figures_are_lines(fit: Pieces) -> None:
    loops = fit.figures["loops"]
    assert loops.image is not None
    assert b"<svg" in loops.image[:500]
    assert loops.plot is not None
    names = [[trace.name for trace in traces] for traces in loops.plot.choices.values()]
    assert names == [["test", "model"]]


def test_poor_fit_says_so_first(fitted: SavedResult, tmp_path) -> None:
    folder = tmp_path / "poor"
    folder.mkdir()
    reported = fitted.summary | {"outcome": "poor_fit", "sentence": "K_r at its bound. Look again."}
    (folder / "summary.json").write_text(json.dumps(reported))
    text = (fitted.path / "bearing.toml").read_text().split("\n", 1)
    (folder / "bearing.toml").write_text('poor_fit = "K_r at its bound"\n' + "\n".join(text))
    poor = identify_report.build_pieces(loaded(folder))
    assert_well_formed(poor)
    assert poor.answer[0].startswith(
        "The calibrated bearing is not acceptable (poor fit): K_r at its"
    )


def test_poorly_determined_parameters_are_reported(fitted: SavedResult) -> None:
    summary = json.loads(json.dumps(fitted.summary))
    item = summary["parameters"]["hysteresis.layer_stiffness"]
    item["stderr"], item["well_determined"] = 0.2 * item["value"], False
    weak = identify_report.build_pieces(replace(fitted, summary=summary))
    assert "These tests determine K_r poorly" in weak.answer[-2]
    assert weak.tables["undetermined"].rows[0][0] == "K_r"


def test_checks_of_tests(record: tb.TestRecord, tmp_path) -> None:
    from thermobearing.identify.records.checks import save_checks

    saved = save_checks([tb.check_test(record)], tmp_path / "check", figures=False)
    looked = identify_report.build_pieces(loaded(saved))
    assert_well_formed(looked)
    _arranged(looked)
    assert "can be used" in looked.answer[0]


def test_validation(record: tb.TestRecord, tmp_path) -> None:
    bearing = tb.load_bearing(SPECIMEN)
    soft = bearing.hysteresis.model_copy(update={"layer_stiffness": 20.0})
    tested = Validity(ambient=[0.0, 30.0])
    bearing = bearing.model_copy(update={"hysteresis": soft, "tested_range": tested})
    result = tb.validate_bearing(bearing, record)
    saved = loaded(result.save(tmp_path / "out", figures=False))
    pieces = validate_report.build_pieces(saved)
    assert_well_formed(pieces)
    _arranged(pieces)
    assert pieces.answer[0].startswith("The model exceeds a limit; largest errors K_eq −")
    worst = result.table["K_eq_error"][0]
    assert f"{100 * worst:.1f} %".replace("-", "−") in pieces.answer[0]
    reported = {check.what: check for check in pieces.checks}
    assert reported[f"error of K_eq, {record.name}"].verdict == EXCEEDED
    assert reported[f"error of K_eq, {record.name}"].value == pytest.approx(-100.0 * worst)
    assert any("ambient −20 °C, below the 0 °C tested" in text for text in pieces.validity)
    assert (0, 1) in pieces.tables["errors"].marked


@pytest.mark.thorough
def test_factors(tmp_path) -> None:
    report = run_factors(["shen-hdr-bridge"], temperatures=[-20.0, 40.0], strains=[1.0])
    saved = loaded(report.save(tmp_path / "out", figures=False))
    pieces = design_report.build_pieces(saved)
    assert_well_formed(pieces)
    _arranged(pieces)
    table = report.table.query("quantity == 'K_eq' and ambient_degC == -20 and basis == 'first'")
    assert f"first K_eq x {table['factor'].iloc[0]:.2f}" in pieces.answer[0]
    factors = pieces.tables["factors"]
    assert factors.columns[factors.keys].head.startswith("Value")  # after what it is of
    warm = [column.head for column in factors.columns].index("Factor at 40 °C")
    # Tested up to 23 degC; the sine is faster than the tests at every temperature.
    assert {column for _, column in factors.marked} == {0, warm}
    # A rate above the tests is a note, as under earthquakes, and no exceeded limit.
    rates = [one for one in (*pieces.checks, *pieces.validity) if "strain rate" in str(one)]
    assert not rates
    assert any("train rates reach 3.1/s" in note for note in pieces.notes)
    assert "shen-hdr-bridge.parameters" in pieces.inputs
    rows = {row[0]: row[3] for row in pieces.inputs["shen-hdr-bridge.parameters"].rows}
    assert rows["Strain hardening b"].startswith("Table 6.4")


def test_bounds(tmp_path) -> None:
    report = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0], duration=8)
    saved = loaded(report.save(tmp_path / "out", figures=False))
    pieces = design_report.build_pieces(saved)
    assert_well_formed(pieces)
    _arranged(pieces)
    table = report.table
    unsafe = int((table["verdict"] == "unsafe").sum())
    assert f"Of {len(table)} demands, {unsafe} are unsafe" in pieces.answer[0]
    assert f"gives {table['envelope_over_coupled'].min():.2f} of what" in pieces.answer[1]
    assert "structure" in pieces.inputs


def test_design(tmp_path) -> None:
    case = make_design_case({"tolerance": 0.1}, "example", motions=["jra-ii-i-1"])
    design = run_design(case)
    saved = loaded(design.save(tmp_path / "out", figures=False))
    pieces = design_report.build_pieces(saved)
    assert_well_formed(pieces)
    _arranged(pieces)
    assert design.bearings[0].name in pieces.answer[0]
    strain = next(check for check in pieces.checks if check.what == "shear strain")
    assert strain.value == pytest.approx(100.0 * design.checks[0].value)
    assert (strain.unit, strain.limit, strain.verdict) == ("%", 250.0, PASSED)
    assert len(pieces.tables["rounds"].rows) == len(design.rounds)


@pytest.mark.thorough
def test_design_of_several_lines(tmp_path) -> None:
    table = {"structure": "two-piers.toml", "dt": "10 ms", "ambient": ["-20 degC"]}
    case = make_design_case(table, "example", INPUTS, motions=["jra-i-i-1"], tolerance=0.1)
    design = run_design(case, templates=[tb.load_bearing("shen-hdr-bridge")])
    pieces = design_report.build_pieces(loaded(design.save(tmp_path / "out")))
    assert_well_formed(pieces)
    _arranged(pieces)
    for name, turn in zip(["on A", "on B"], design.taken, strict=True):
        assert f"for {name}, G8-{turn.size.side:g}" in pieces.answer[0]
    named = [check.what for check in pieces.checks]
    assert {"shear strain, on A", "shear strain, on B", "pier ductility, B"} <= set(named)
    cold = design.temperatures
    rows = pieces.tables["temperatures"].rows
    assert [row[0] for row in rows] == cold["group"].tolist()
    assert {row[1] for row in pieces.tables["rounds"].rows} == {"on A", "on B"}
    assert len(design.plot.rounds().axes) == len(design.plot.equal().axes) == 2


def test_motion(tmp_path) -> None:
    result = examine_motion(load_motion("jra-ii-i-1"))
    saved = loaded(result.save(tmp_path / "out", figures=False))
    pieces = motions_report.build_pieces(saved)
    assert_well_formed(pieces)
    _arranged(pieces)
    assert f"{saved.summary['pga_gal']:.0f} gal" in pieces.answer[0]
    measures = {row[0]: row for row in pieces.tables["measures"].rows}
    assert measures["Peak ground acceleration"][1:] == (f"{saved.summary['pga_gal']:.1f}", "gal")
    plot = pieces.figures["motion"].plot
    assert plot is not None
    peak = np.abs(plot.choices["all"][0].y).max()
    assert peak == pytest.approx(saved.summary["pga_gal"], rel=1e-3)
    assert [check.verdict for check in pieces.checks] == [PASSED]


def test_held_out_tests_beyond_the_fit_are_reported(record: tb.TestRecord, tmp_path) -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, closing_strain=None, dt=0.02)
    warm = replace(tb.synthetic_record(SPECIMEN, 23.0, test), name="warm")
    result = tb.cross_validate(record, SPECIMEN, hold_out=warm, free=["K_r"], starts=1)
    saved = loaded(result.save(tmp_path / "out", figures=False))
    assert any("held out" in text and "ambient 23 degC" in text for text in saved.warnings)
    pieces = identify_report.build_pieces(saved)
    assert_well_formed(pieces)
    assert any("ambient 23 °C, above the −20 °C tested" in text for text in pieces.validity)
    assert [row[0] for row in pieces.tables["held_out"].rows] == ["fitted", "held out"]
    assert pieces.tables["held_out"].marked == {(1, 2)}
