"""What certificate and report of a calibration say of its tests, those held out included."""

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.identify.certificate import build_certificate
from thermobearing.identify.report import build_pieces
from thermobearing.identify.uncertainty.posterior import forecast
from thermobearing.report.pieces import marked_note
from thermobearing.report.template import TableBlock, _identity
from thermobearing.results.saved import SavedResult

SPECIMEN = "shen-hdr-specimen"
MISSING = "not stated"


def made(ambient: float, name: str) -> tb.TestRecord:
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, closing_strain=None, dt=0.02)
    record = tb.synthetic_record(SPECIMEN, ambient, test, noise=0.003)
    rise = 2.0 * (record.time - record.time[0]) / np.ptp(record.time)
    sensors = {"T": ambient + rise}
    return replace(record, name=name, temperatures=sensors, places={"T": "rubber 1"})


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> SavedResult:
    validation = tb.cross_validate(
        [made(23.0, "warm"), made(-20.0, "cold")],
        SPECIMEN,
        hold_out=[made(0.0, "cool")],
        free=["K_r", "d_y"],
        starts=1,
    )
    validation = validation.with_forecast(forecast(validation.final, [-30.0]))
    folder = tmp_path_factory.mktemp("fit")
    result = tb.load_result(validation.save(folder / "out", figures=False))
    assert isinstance(result, SavedResult)
    return result


def with_conditions(saved: SavedResult, **conditions: Any) -> SavedResult:
    """Return the result with more conditions of its first test."""
    first, *others = saved.summary["records"]
    records = [first | {"conditions": first["conditions"] | conditions}, *others]
    return replace(saved, summary={**saved.summary, "records": records})


def statement(saved: SavedResult) -> str:
    """Return the statement of a certificate on specimen, laboratory, date and load."""
    (text,) = (text for text in build_certificate(saved).answer if text.startswith("Specimen"))
    return text


def test_what_tests_do_not_state_is_not_stated(saved: SavedResult) -> None:
    assert statement(saved).count(MISSING) == 5
    stated = with_conditions(saved, laboratory="EMPA", stated_axial_force_kN=800.0)
    assert statement(stated).count(f"{MISSING} (cold, cool)") == 2
    assert "800 kN, without effect" in statement(stated)
    acting = with_conditions(saved, axial_force_kN=[790.0, 810.0])
    assert "790 to 810 kN, which acts" in statement(acting)
    dated = build_certificate(with_conditions(saved, date="2026-11-23"))
    names = [column.name for column in dated.tables["tests"].columns]
    dates = [row[names.index("date")] for row in dated.tables["tests"].rows]
    assert dates == ["2026-11-23", MISSING, MISSING]
    assert not any("date:" in text for text in dated.answer)


def test_a_stated_load_is_in_the_summary(tmp_path: Path) -> None:
    record = made(23.0, "a")
    table = np.column_stack((record.time, record.displacement, record.force))
    file = tmp_path / "a.csv"
    head = "time_s,displacement_mm,force_kN"
    np.savetxt(file, table, delimiter=",", header=head, comments="")
    file.with_suffix(".toml").write_text('ambient = "23 degC"\naxial_force = "800 kN"\n')
    loaded = tb.load_test(file)
    assert (loaded.stated_axial_force, loaded.axial) == (800.0, None)
    assert made(23.0, "b").stated_axial_force is None


def test_a_test_held_out_has_loops_and_thermocouples(saved: SavedResult) -> None:
    certificate = build_certificate(saved)
    draw = certificate.figures["loops"].draw
    assert draw is not None
    axes = draw().axes
    titles = [ax.get_title(loc="left") or ax.get_title() for ax in axes]
    assert [" ".join(title.split()) for title in titles] == ["warm", "cold", "cool (held out)"]
    (samples,) = (item["conditions"]["samples"] for item in saved.summary["held_out"]["records"])
    assert [len(line.get_xdata()) for line in axes[2].get_lines()] == [samples] * 2
    rows = build_pieces(saved).tables["thermocouples"].rows
    assert [row[0] for row in rows] == ["warm", "cold", "cool (held out)"]


def test_statements_of_a_certificate(saved: SavedResult) -> None:
    """Its range, what would narrow the prediction, and the basis of the intervals."""
    certificate, report = build_certificate(saved), build_pieces(saved)
    assert certificate.answer[0].startswith("The parameters hold within")
    assert "strain rates of" in certificate.answer[0]
    strains = [0.5, 0.5, 0.999, 1.0, 1.001, 1.749, 1.751]
    cycle = saved.summary["records"][0]["cycles"][0]
    cycles = [{**cycle, "amplitude_strain": strain} for strain in strains]
    records = [{**item, "cycles": cycles} for item in saved.summary["records"]]
    six = build_certificate(replace(saved, summary={**saved.summary, "records": records}))
    assert "2 at 175 % and 3 at 100 % shear strain" in six.answer[0]
    narrowing = [text for text in certificate.answer if "would be less with one of" in text]
    (row,) = (row for row in saved.summary["posterior"]["predicted"] if row["quantity"] == "K_eq")
    best, lower, upper = (f"{row[name]:#.3g}" for name in ("best", "lower", "upper"))
    assert len(narrowing) == 1
    assert f"extrapolated beyond the tests: {best} kN/mm (95 %: {lower} to {upper})" in narrowing[0]
    assert "largest amplitude (100 % shear strain), in a test like warm at" in narrowing[0]
    assert narrowing[0] in report.tables["posterior"].note
    assert "since the start" in report.tables["thermocouples"].note
    assert "of the tests used" in " ".join(report.answer)
    for pieces in (certificate, report):
        basis = pieces.tables["parameters"].note
        assert "thickness of the rubber \N{PLUS-MINUS SIGN} 2 %" in basis
        assert "no error of the model" in basis


def test_a_misfit_of_a_certificate_has_size_and_cause(saved: SavedResult) -> None:
    misfit = "model and test differ by more than noise: the force most in cold. Possible causes: "
    misfit += "many of them, " * 10
    other = {"name": "clock", "key": "x", "size": 2.0, "sizes": [1.0, 2.0], "unit": "K"}
    other |= {"plausible": True, "named": True}
    suspect = {"name": "delay of the force", "key": "force_delay", "size": 12.3, "unit": "ms"}
    summary = {**saved.summary, "warnings": [misfit], "suspects": [suspect]}
    both = {**summary, "suspects": [suspect, other]}
    text, several = (
        next(
            text
            for text in build_certificate(replace(saved, summary=content)).answer
            if text.startswith("Warning")
        )
        for content in (summary, both)
    )
    assert "not distinguish: delay of the force, +12 ms; clock, +1 to +2 K." in several
    assert "cause of the difference of the force: delay of the force, +12 ms." in text


def test_a_certificate_has_the_digest_of_the_description_of_the_bearing(
    saved: SavedResult,
) -> None:
    digest = hashlib.sha256((saved.path / "bearing.toml").read_bytes()).hexdigest()
    assert sum(digest in text for text in build_certificate(saved).answer) == 1


def test_what_an_assumed_value_moves(saved: SavedResult) -> None:
    """The force twice as large moves the stiffness in proportion: 0.3 % of its value."""
    items = {item["keys"][0]: item for item in saved.summary["assumed"]}
    assert items["force"]["moves"] == "K_r"
    assert abs(items["force"]["moves_by"]) == pytest.approx(0.003, rel=0.1)


def test_tables_of_a_report_have_no_marks_of_markdown(saved: SavedResult) -> None:
    report = build_pieces(saved)
    assert "`lambda`" in report.tables["posterior"].note  # as on the console
    assert "`" not in marked_note(report.tables["posterior"])
    (identity,) = _identity(report)
    assert isinstance(identity, TableBlock)
    assert not any("`" in row[0] for row in identity.table.rows)
    assert any("`" in label for label in report.identity)


def test_a_misfit_is_the_first_warning_of_a_certificate(saved: SavedResult) -> None:
    """Also where three parameters are poorly determined, whose warnings concern the page."""
    poor = [f"{name} is poorly determined, its standard error is 13 %" for name in "abc"]
    misfit = "model and test differ by more than noise: the temperature rise by 10 K. More of it"
    summary = {**saved.summary, "warnings": [*poor, misfit]}
    answer = build_certificate(replace(saved, summary=summary)).answer
    warnings = [text for text in answer if text.startswith("Warning")]
    assert "the temperature rise by 10 K" in warnings[0]
    assert [poor[k] in warnings[k + 1] for k in range(2)] == [True, True]


def test_the_table_of_tests_has_the_errors_of_temperature_rises(saved: SavedResult) -> None:
    """Those of the table of the report, of tests held out too."""
    table = build_certificate(saved).tables["tests"]
    place = [column.name for column in table.columns].index("temperature_error")
    tests = saved.summary["held_out"]["tests"]
    errors = {test["test"]: 100.0 * test["temperature_error"] for test in tests}
    assert {row[0]: row[place] for row in table.rows} == pytest.approx(errors)
    assert "Rise error" in table.note
