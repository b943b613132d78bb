"""`thermobearing reproduce`: its directory, its screen, its document; what breaks is told."""

import json
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.border.errors import InputError
from thermobearing.report.pieces import Heading
from thermobearing.report.template import arranged, default_template
from thermobearing.reporting import build_pieces
from thermobearing.reproduce import work
from thermobearing.reproduce.claims import (
    CONTRADICTED,
    FAILED,
    PARTS,
    REPRODUCED,
    Claim,
    Flip,
    Limit,
    Row,
    Verdict,
    Within,
)
from thermobearing.reproduce.report import SETS
from thermobearing.reproduce.run import reproduce_source
from thermobearing.reproduce.runs import Runs
from thermobearing.reproduce.tables import printed_tables

FEW = [
    Claim(
        id="sizes", place="Table 3.1", statement="S1 is 12",
        computed="chapter_3.first_shape_factor",
        rule=Within(value=(12.0, 12.0), per_cent=1.0), flips=("t_r",), depends="geometry",
        figure="fig_0_01",
    ),
    Claim(
        id="height", place="3.2.1", statement="more than 40 mm of rubber",
        computed="chapter_3.total_thicknesses", rule=Limit(above=40.0, unit="mm"),
    ),
    Claim(
        id="nothing", place="nowhere", statement="no function", computed="chapter_3.nothing",
        rule=Limit(above=1.0),
    ),
]  # fmt: skip


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three claims, one of them broken; a figure; tables of which one breaks."""

    def parts(chapter: int | None, *, figures: bool, flips: bool) -> list[work.Part]:
        names = tuple(claim.id for claim in FEW)
        drawn = [work.Part("figure", ("fig_0_01",))] if figures else []
        return [work.Part("claims" if flips else "verdicts", names), *drawn]

    def draw(name: str) -> work.Drawn:
        return work.Drawn(name, "a caption", _picture())

    known = {claim.id: claim for claim in FEW}
    monkeypatch.setattr("thermobearing.reproduce.run.split_parts", parts)
    monkeypatch.setattr(work, "_known", lambda: known)
    monkeypatch.setattr(work, "draw", draw)


def _picture() -> bytes:
    import io

    found = io.BytesIO()
    Figure(figsize=(1.0, 1.0)).savefig(found, format="png")
    return found.getvalue()


def test_a_broken_row_does_not_stop_the_others(few: None, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    found = reproduce_source(jobs=1, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 2), (2, 2)]
    assert [row.verdict.kind for row in found.rows] == ["reproduced", "contradicted", "failed"]
    assert set(found.broken) == {"nothing"}
    assert found.outcome == "partly"
    assert sum(found.counts.values()) == 3
    folder = found.save(tmp_path / "out")
    ledger = json.loads((folder / "ledger.json").read_text())
    assert [row["id"] for row in ledger] == [claim.id for claim in FEW]
    assert ledger[0]["flips"]["t_r"] == pytest.approx(0.0125, abs=0.005)
    assert ledger[0]["numbers"] == [12.0, 12.0]
    assert (
        "chapter_3.nothing"
        in json.loads((folder / "summary.json").read_text())["broken"]["nothing"]
    )
    assert (folder / "figures" / "fig_0_01.png").read_bytes().startswith(b"\x89PNG")


def test_a_row_that_nothing_flips_says_what_was_tried() -> None:
    holds, none = Verdict("trend holds", "trend holds"), Flip("t_r", None)
    assert Row(FEW[0], holds, 1.0, (none,), True).flip_words == "none: t_r changed by up to 50 %"
    assert Row(FEW[0], holds, 1.0, (none, Flip("a", 0.2)), True).flip_words == "a +20.0 %"
    assert Row(FEW[1], holds, 1.0, (), True).flip_words == "none"
    assert Row(FEW[0], Verdict("contradicted", "contradicted")).flip_words == ""


def test_verdicts_alone_have_no_flips(few: None) -> None:
    row = reproduce_source(jobs=1, flips=False).rows[0]
    assert row.verdict.kind == REPRODUCED
    assert row.flips == ()


def test_the_document_has_every_claim(few: None, tmp_path: Path) -> None:
    folder = reproduce_source(jobs=1).save(tmp_path / "out")
    loaded = tb.load_result(folder)
    pieces = build_pieces(loaded, folder)
    assert dict(map(tuple, pieces.tables["counts"].rows))[REPRODUCED] == 1
    assert pieces.figures["fig_0_01"].caption == "a caption"
    assert "1 reproduced, 1 contradicted" in pieces.answer[0]
    assert any("nothing" in warning for warning in pieces.warnings)
    words = {block.text for block in arranged(pieces) if isinstance(block, Heading)}
    assert {"How to read it", "Functions"} <= words
    assert default_template("reproduce").name == "reproduce.md"


def test_the_template_has_every_figure_and_table() -> None:
    text = default_template("reproduce").read_text(encoding="utf-8")
    for name in [*work.report_figures(None), *work.OWN_FIGURES]:
        assert f"{{{{ figure {name}? }}}}" in text
    for name in [*PARTS, *(table.name for table in printed_tables()), *SETS, "slips"]:
        assert f"{{{{ table {name}? }}}}" in text


def test_slips_are_a_table_and_a_figure_of_the_same_numbers() -> None:
    (part,) = [part for part in work.split_parts(None, figures=True) if part.names == ("slips",)]
    assert part.kind == work.BOTH
    done = work.do(part)
    assert done.tables is not None
    assert len(done.tables["slips"]) == 18
    assert done.drawn is not None
    assert done.drawn.image
    (alone,) = [part for part in work.split_parts(None, figures=False) if part.names == ("slips",)]
    assert alone.kind == work.TABLES


def test_parts_of_a_chapter_have_its_claims_and_figures() -> None:
    whole, fourth = work.split_parts(None, figures=True), work.split_parts(4, figures=True)
    ids = [name for part in fourth if part.kind == "claims" for name in part.names]
    assert ids == [claim.id for claim in work.list_claims(4)]
    assert all(part.names[0].startswith("fig_4_") for part in fourth if part.kind == "figure")
    assert {part.kind for part in work.split_parts(4, figures=False)} == {"claims"}
    assert len(whole) > len(fourth)


def test_a_figure_or_table_that_breaks_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = work.draw("fig_9_99")
    assert drawn.image is None
    assert "fig_9_99" in drawn.caption
    assert "no_tables" in str(work.report_tables_by_name("no_tables")["no_tables"])


@pytest.mark.parametrize("words", [{"chapter": 2}, {"jobs": 0}, {"jobs": 65}])
def test_bad_words_are_refused(words: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(words))):
        reproduce_source(**words)


def test_the_command_says_counts_and_what_is_contradicted(few: None, tmp_path: Path) -> None:
    done = command("reproduce", "--jobs", "1", "-o", str(tmp_path / "out"), "--json")
    assert done.exit_code == 3  # a row broke
    for name in (REPRODUCED, CONTRADICTED, FAILED, "statements"):
        assert name in done.output
    assert "contradicted: 16 mm" not in done.output
    assert "more than 40 mm of rubber" in done.output
    last = json.loads(done.output.splitlines()[-1])
    assert last["outcome"] == "partly"
    assert {"ledger.csv", "ledger.json", "index.md", "figures/fig_0_01.png"} <= set(last["files"])
    again = command("reproduce", "--jobs", "1", "-o", str(tmp_path / "out"))
    assert again.exit_code == 2


def test_light_runs_keep_less() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1)
    light = Runs(light=True).cyclic("shen-hdr-specimen", 23.0, test)
    assert "temperature" not in light.dataset
    assert "temperature" in Runs().cyclic("shen-hdr-specimen", 23.0, test).dataset
