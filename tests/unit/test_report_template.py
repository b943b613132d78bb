"""Templates: what stands where in a document, and what a wrong template is told."""

from dataclasses import replace

import pytest

from thermobearing.border.errors import InputError
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report.pieces import (
    Bullets,
    Check,
    ChecksBlock,
    FigureBlock,
    Heading,
    Paragraph,
    Pieces,
    ReportFigure,
    TableBlock,
)
from thermobearing.report.template import arranged

TABLE = Table("Cycles", [Quantity("Cycle", "", "d"), Quantity("Force", "kN", ".1f")], [(1, 2.0)])
PIECES = Pieces(
    "cyclic",
    "A test",
    "How stiff is it?",
    ["1.2 MPa.", "Warm.", "Fine."],
    tables={"cycles": TABLE, "layers": TABLE},
    figures={"loops": ReportFigure("Loops", image=b"")},
    checks=[Check("force", 1.0, 2.0, "kN", "Table 1", "within")],
    warnings=["it melts"],
)


def blocks_of(text, tmp_path, pieces=PIECES):
    path = tmp_path / "mine.md"
    path.write_text(text)
    return arranged(pieces, path)


def test_pieces_called_by_name_are_not_told_again(tmp_path):
    blocks = blocks_of(
        "{{ tables }}\n{{ table layers }}\n{{ figure loops }}\n{{ figures }}", tmp_path
    )
    assert [(type(b), b.name) for b in blocks] == [
        (TableBlock, "cycles"),
        (TableBlock, "layers"),
        (FigureBlock, "loops"),
    ]


def test_lines_join_to_paragraphs_and_lists(tmp_path):
    blocks = blocks_of("# One\na\nb\n\nc\n- d\n- e\n## Two\nf", tmp_path)
    assert blocks == [
        Heading(1, "One"),
        Paragraph("a b"),
        Paragraph("c"),
        Bullets(["d", "e"]),
        Heading(2, "Two"),
        Paragraph("f"),
    ]


def test_headings_with_nothing_under_them_are_left_out(tmp_path):
    text = (
        "# Checks\n{{ checks }}\n# Books\n## All\n{{ books }}\n# Validity\n## Of it\n{{ validity }}"
    )
    kept = [block.text for block in blocks_of(text, tmp_path) if isinstance(block, Heading)]
    assert kept == ["Checks", "Validity", "Of it"]


def test_warnings_are_marked_and_checks_come_whole(tmp_path):
    blocks = blocks_of("{{ warnings }}\n{{ checks }}", tmp_path)
    assert blocks == [Bullets(["it melts"], "warning"), ChecksBlock(PIECES.checks)]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("{{ table cycle }}", 'did you mean "cycles"'),
        ("{{ figure lead }}", 'write "lead?" where it may be missing'),
        ("{{ tabels }}", 'did you mean "tables"'),
        ("{{ chapter one }}", "table NAME or figure NAME"),
        ("so {{ tables }}", "a line of its own"),
    ],
)
def test_wrong_placeholders_are_told_with_their_line(line, told, tmp_path):
    with pytest.raises(InputError, match="line 2: ") as error:
        blocks_of(f"# Head\n{line}", tmp_path)
    assert told in str(error.value)


def test_what_may_be_missing_may_be_missing(tmp_path):
    assert blocks_of("# Lead\n{{ figure lead? }}", tmp_path) == []


def test_without_a_verdict_on_validity_the_reason_is_told(tmp_path):
    unknown = Pieces("cyclic", "A test", "?", [], validity_unknown="no range is given")
    assert blocks_of("{{ validity }}", tmp_path, unknown) == [
        Paragraph("no range is given", "warning")
    ]


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [
        (-1.25, ".1f", "\N{MINUS SIGN}1.2"),
        (-0.01, ".1f", "0.0"),
        (float("nan"), ".1f", ""),
        (None, ".1f", ""),
        (True, "", "yes"),
        (3, "d", "3"),
        ("pier A", ".1f", "pier A"),
    ],
)
def test_cells_as_a_reader_sees_them(value, form, text):
    assert Quantity("x", "", form).text(value) == text


def test_checks_are_listed_by_severity(tmp_path):
    verdicts = ["within", "not judged", "exceeded", "within", "exceeded"]
    checks = [Check(str(k), 1.0, 2.0, "kN", "-", verdict) for k, verdict in enumerate(verdicts)]
    blocks = blocks_of("{{ checks }}\n", tmp_path, replace(PIECES, checks=checks))
    assert [check.what for check in blocks[0].checks] == ["2", "4", "1", "0", "3"]
