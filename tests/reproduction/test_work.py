"""The whole program: its directory, its screen, its document; what breaks is said."""

import io
import json
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from reproduction import work
from reproduction.__main__ import main
from reproduction.claims import (
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
from reproduction.report import SETS, Drawn
from reproduction.runs import DATA
from reproduction.tables import printed_tables
from thermobearing.border.errors import InputError
from thermobearing.report.pieces import Heading
from thermobearing.report.template import _arranged

pytestmark = pytest.mark.drawn


FEW = [
    Claim(
        id="sizes", place="Table 3.1", statement="S1 is 12",
        computed="[bearing(n).geometry.first_shape_factor for n in SPECIMENS]",
        rule=Within(value=(12.0, 12.0), per_cent=1.0), flips=("t_r",), depends="geometry",
        figure="fig_0_01",
    ),
    Claim(
        id="height", place="3.2.1", statement="more than 40 mm of rubber",
        computed="[30.0, 16.0]", rule=Limit(above=40.0, unit="mm"),
    ),
    Claim(
        id="nothing", place="nowhere", statement="no function", computed="nothing()",
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

    def draw(name: str) -> Drawn:
        return Drawn(name, "a caption", _picture())

    known = {claim.id: claim for claim in FEW}
    monkeypatch.setattr(work, "split_parts", parts)
    monkeypatch.setattr(work, "_claims_by_id", lambda: known)
    monkeypatch.setattr(work, "draw", draw)


def _picture() -> bytes:
    result = io.BytesIO()
    Figure(figsize=(1.0, 1.0)).savefig(result, format="png")
    return result.getvalue()


def test_a_broken_row_does_not_stop_the_others(few: None, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    result = work.reproduce(jobs=1, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 2), (2, 2)]
    assert [row.verdict.kind for row in result.rows] == ["reproduced", "contradicted", "failed"]
    assert set(result.broken) == {"nothing"}
    assert result.outcome == "partly"
    assert result.groups["statements"][FAILED] == 1
    folder = result.save(tmp_path / "out")
    ledger = json.loads((folder / "ledger.json").read_text())
    assert [row["id"] for row in ledger] == [claim.id for claim in FEW]
    assert ledger[0]["flips"]["t_r"] == pytest.approx(0.0125, abs=0.005)
    assert ledger[0]["numbers"] == [12.0, 12.0]
    assert "NameError" in json.loads((folder / "summary.json").read_text())["broken"]["nothing"]
    assert (folder / "figures" / "fig_0_01.png").read_bytes().startswith(b"\x89PNG")


def test_a_row_that_nothing_flips_says_what_was_tried() -> None:
    holds, none = Verdict("trend holds", "trend holds"), Flip("t_r", None)
    assert Row(FEW[0], holds, 1.0, (none,), True).flip_words == "none: t_r changed by up to 50 %"
    assert Row(FEW[0], holds, 1.0, (none, Flip("a", 0.2)), True).flip_words == "a +20.0 %"
    assert Row(FEW[1], holds, 1.0, (), True).flip_words == "none"
    assert Row(FEW[0], Verdict("contradicted", "contradicted")).flip_words == ""


def test_the_document_has_every_claim(few: None, tmp_path: Path) -> None:
    result = work.reproduce(jobs=1)
    pieces = result.pieces()
    assert dict(map(tuple, pieces.tables["counts"].rows))[REPRODUCED] == 1
    assert pieces.figures["fig_0_01"].caption == "a caption"
    assert "1 reproduced, 1 contradicted" in pieces.answer[0]
    assert any("nothing" in warning for warning in pieces.warnings)
    blocks = _arranged(pieces, DATA / "report.md")
    headings = {block.text for block in blocks if isinstance(block, Heading)}
    assert {"How to read it", "Expressions and functions"} <= headings
    (page,) = result.write_report(result.save(tmp_path / "out"), pdf=False)
    assert "Expressions of the claims" in page.read_text(encoding="utf-8")


def test_the_template_has_every_figure_and_table() -> None:
    text = (DATA / "report.md").read_text(encoding="utf-8")
    for name in [*work.list_figures(None), "slips"]:
        assert f"{{{{ figure {name}? }}}}" in text
    for name in [*PARTS, *(table.name for table in printed_tables()), *SETS, "slips"]:
        assert f"{{{{ table {name}? }}}}" in text


@pytest.mark.thorough
def test_slips_are_a_table_and_a_figure_of_the_same_numbers() -> None:
    (part,) = [part for part in work.split_parts(None, figures=True) if part.names == ("slips",)]
    assert part.kind == work.BOTH
    done = work.carry_out(part)
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


def test_a_figure_or_table_that_breaks_says_why() -> None:
    drawn = work.draw("fig_9_99")
    assert drawn.image is None
    assert "fig_9_99" in drawn.caption
    assert "no_tables" in str(work.make_tables("no_tables")["no_tables"])


@pytest.mark.parametrize("words", [{"chapter": 2}, {"jobs": 0}, {"jobs": 65}])
def test_bad_words_are_refused(words: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(words))):
        work.reproduce(**words)


def test_the_program_says_counts_and_what_is_contradicted(
    few: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--jobs", "1", "-o", str(tmp_path / "out")]
    assert main(words) == 3  # a row broke
    output = capsys.readouterr().out
    for name in (REPRODUCED, CONTRADICTED, FAILED, "statements", "more than 40 mm of rubber"):
        assert name in output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"summary.json", "ledger.csv", "ledger.json", "index.md", "figures"} <= names
    assert main(words) == 2
    assert "exists" in capsys.readouterr().err
    assert main([*words, "--overwrite"]) == 3
