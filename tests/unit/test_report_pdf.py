"""Reports as PDF and as workbooks."""

import dataclasses
import io
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pikepdf
import pypdfium2
import pytest
from matplotlib.figure import Figure

from tests.unit.report_pieces import EVIL, LOGO, PIECES, line, many_columns, wide
from thermobearing.border.errors import InputError
from thermobearing.border.title import TitleBlock
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report import workbook
from thermobearing.report.figures import _svg_bytes, drawn, picture_size
from thermobearing.report.pdf import (
    SEAM,
    TURNED,
    UPRIGHT,
    _document_date,
    _fitted,
    _laid_out,
    _turned_together,
    pdf_bytes,
)
from thermobearing.report.pieces import (
    FigureBlock,
    Paragraph,
    Pieces,
    ReportFigure,
    Signatures,
    column_letters,
)
from thermobearing.report.template import document
from thermobearing.report.workbook import History, _history_tables, _sheet_name, workbook_bytes

pytestmark = pytest.mark.drawn


BLOCK = {"Project": EVIL, "Document": "B12-7", "Revision": "C", "Date": "2026-04-01"}
A4 = (595, 842)  # [pt]


def written(pieces: Pieces = PIECES, **block: str) -> bytes:
    return pdf_bytes(document(pieces, BLOCK | block, LOGO))


@pytest.fixture(scope="module")
def whole() -> bytes:
    return written()


def opened(raw: bytes) -> Any:
    return pikepdf.open(io.BytesIO(raw))


def page_texts(raw: bytes) -> list[str]:
    pdf = pypdfium2.PdfDocument(raw)
    texts = [page.get_textpage().get_text_range() for page in pdf]
    pdf.close()
    return texts


def paper(raw: bytes) -> set[tuple[int, int]]:
    """Sizes of the pages [pt]."""
    pdf = pypdfium2.PdfDocument(raw)
    sizes = {tuple(map(round, page.get_size())) for page in pdf}
    pdf.close()
    return sizes


def joined(raw: bytes) -> str:
    return " ".join(" ".join(page_texts(raw)).split())


def test_it_says_that_it_is_an_archive_and_accessible(whole: bytes) -> None:
    pdf = opened(whole)
    with pdf.open_metadata() as reported:
        assert (reported["pdfaid:part"], reported["pdfaid:conformance"]) == ("2", "A")
        assert reported["pdfuaid:part"] == "1"
        assert reported["dc:title"] == PIECES.title
        assert reported["xmp:CreateDate"].startswith("2026-04-01")
    assert "/StructTreeRoot" in pdf.Root
    assert bool(pdf.Root.MarkInfo.Marked)
    assert str(pdf.Root.Lang) == "en"
    assert bool(pdf.Root.ViewerPreferences.DisplayDocTitle)


def test_every_font_is_inside(whole: bytes) -> None:
    pdf = opened(whole)
    fonts = [
        item
        for item in pdf.objects
        if isinstance(item, pikepdf.Dictionary) and item.get("/Type") == "/FontDescriptor"
    ]
    assert len(fonts) >= 2
    files = {"/FontFile", "/FontFile2", "/FontFile3"}
    assert all(files & set(font.keys()) for font in fonts)


def test_figures_are_vectors_with_words_for_who_does_not_see_them(whole: bytes) -> None:
    pdf = opened(whole)
    kinds = [
        item.get("/S")
        for item in pdf.objects
        if isinstance(item, pikepdf.Dictionary) and item.get("/Alt") == "It rises."
    ]
    assert kinds == ["/Figure"]
    images = [
        o for o in pdf.objects if isinstance(o, pikepdf.Stream) and o.get("/Subtype") == "/Image"
    ]
    assert not images


def test_the_same_document_has_the_same_bytes(whole: bytes) -> None:
    assert written() == whole
    assert written(Revision="D") != whole


def test_text_of_users_is_text(whole: bytes) -> None:
    reported = joined(whole)
    assert reported.count(EVIL) >= 2  # title block and table
    assert "θ₀ Δ" in reported


def test_it_says_what_a_document_says(whole: bytes) -> None:
    reported = joined(whole)
    pieces = ["Contents", "1 Scope", "313 kN", "≤ 2.5", "exceeded", "Table 3.2"]
    pieces += ["outside the calibration range", "−312.6", "Figure 1: A parabola"]
    pieces += [f"page 1 of {len(page_texts(whole))}", "thermobearing 0.2.0"]
    for piece in pieces:
        assert piece in reported, piece
    assert "B12-7, revision C" in page_texts(whole)[1]  # the running head


def test_long_tables_go_over_pages_with_their_heads() -> None:
    raw = written(many_columns(4, rows=240))
    with_head = [text for text in page_texts(raw) if "Quantity 2" in text]
    assert len(with_head) >= 3
    reported = joined(raw)
    assert all(f"run {k} " in reported for k in range(240))
    # Its number and caption too, on each page but the first of them.
    assert ["(continued)" in text for text in with_head] == [False] + [True] * (len(with_head) - 1)


@pytest.mark.parametrize(("count", "turned"), [(8, False), (14, True), (40, True)])
def test_wide_tables_are_made_smaller_turned_or_parted_but_never_cut(
    count: int, turned: bool
) -> None:
    raw = written(many_columns(count))
    sizes = paper(raw)
    assert sizes == ({A4, A4[::-1]} if turned else {A4})
    pdf = pypdfium2.PdfDocument(raw)
    for page in pdf:
        width = page.get_size()[0]
        texts = page.get_textpage()
        rights = [texts.get_charbox(k)[2] for k in range(texts.count_chars())]
        assert max(rights) < width - 30
    pdf.close()
    reported = joined(raw)
    assert all(f"{100.0 * k:.1f}" in reported for k in range(count - 1))


def test_long_words_are_broken_and_numbers_are_not() -> None:
    digest, number = "0123456789abcdef" * 8, 10**23
    table = Table("x", list(map(Quantity, "abc")), [("hash", f"{digest} x", number)])
    (part,) = _fitted(column_letters(table, table.texts()), 1)
    assert part.broken(digest, 1).replace(SEAM, "") == digest
    assert SEAM in part.broken(digest, 1)
    assert part.broken("a short one", 1) == "a short one"
    assert sum(part.widths) <= UPRIGHT[0] < TURNED[0]


def test_wide_figures_stand_on_turned_pages_with_their_headings() -> None:
    pieces = dataclasses.replace(PIECES, tables={}, figures={"wide": ReportFigure("Wide", wide)})
    blocks = _laid_out(document(pieces, {}), None)["blocks"]
    assert not [block for block in blocks if block["kind"] == "turned"]  # it is not drawn yet
    assert A4[::-1] in {
        tuple(round(v) for v in list(p.mediabox)[2:]) for p in opened(written(pieces)).pages
    }


def test_a_figure_without_data_is_left_out() -> None:
    figures = {"empty": ReportFigure("Empty", Figure), "wide": ReportFigure("Wide", wide)}
    blocks = drawn(document(dataclasses.replace(PIECES, figures=figures), {})).blocks
    (block,) = [block for block in blocks if isinstance(block, FigureBlock)]
    assert block.figure.caption == "Wide"


def test_headings_skip_no_level(tmp_path: Path) -> None:
    template = tmp_path / "mine.md"
    template.write_text("## First\nwords\n### Second\nwords")
    blocks = _laid_out(document(PIECES, {}, template=template), None)["blocks"]
    assert [block["level"] for block in blocks if block["kind"] == "heading"] == [1, 2]
    assert pdf_bytes(document(PIECES, {}, template=template)).startswith(b"%PDF")


def test_letters_without_a_font_are_reported() -> None:
    raw = written(dataclasses.replace(PIECES, title="A \ue123 test"))
    reported = joined(raw)
    assert "A [U+E123] test" in reported
    assert "No installed font has some letters of its text (U+E123)" in reported


def test_letters_that_no_figure_can_show_are_reported() -> None:
    figure, missing = line(), set[str]()
    figure.suptitle("\ue123")
    svg = _svg_bytes(figure, missing)
    assert missing == {"\ue123"}
    assert picture_size(svg) == pytest.approx((127.0, 76.2))


def test_the_date_is_that_of_the_document_or_of_the_run() -> None:
    of_run = dataclasses.replace(PIECES, identity={"Date of the run": "2026-03-09"})
    assert str(_document_date(document(of_run, {}))) == "2026-03-09"
    assert str(_document_date(document(of_run, {"Date": "2026-04-01"}))) == "2026-04-01"
    assert str(_document_date(document(of_run, {"Date": "in spring"}))) == "2026-03-09"
    assert str(_document_date(document(of_run, {"Date": "2026-13-45"}))) == "2026-03-09"


def test_without_the_compiler_a_sentence_says_what_to_install(monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(InputError, match=r'pip install "thermobearing\[report\]"'):
        pdf_bytes(document(PIECES, {}))


def test_a_logo_that_is_no_picture_is_refused() -> None:
    with pytest.raises(InputError, match="the PDF cannot be made"):
        pdf_bytes(document(PIECES, {}, b"<svg nonsense"))


def test_a_caption_is_not_parted_from_its_table() -> None:
    tables = {
        f"t{k}": Table(f"Caption {k}", [Quantity("a")], [(j,) for j in range(3 + k % 5)])
        for k in range(60)
    }
    for text in page_texts(written(dataclasses.replace(PIECES, tables=tables))):
        before_foot = text.split("thermobearing 0.2.0 ·")[0].split()
        assert before_foot[-2] != "Caption"  # a number of it would follow
        assert before_foot[-1] != "a"


def test_a_note_stays_with_its_table_and_a_head_in_bold_with_its_text() -> None:
    tables = {
        f"t{k}": Table(
            f"Caption {k};", [Quantity("a")], [(j,) for j in range(3 + k % 5)], note=f"Note {k};"
        )
        for k in range(60)
    }
    raw = written(dataclasses.replace(PIECES, tables=tables))
    pages = [" ".join(text.split()) for text in page_texts(raw)]
    notes = [(text, k) for text in pages for k in range(60) if f"Note {k};" in text]
    assert len(notes) == 60
    assert all(f"Caption {k};" in text for text, k in notes)
    blocks = [
        Paragraph(words)
        for k in range(150)
        for words in (f"**Head {k};**", f"Text {k};", *["More."] * (k % 3))
    ]
    pages = page_texts(pdf_bytes(dataclasses.replace(document(PIECES, BLOCK, LOGO), blocks=blocks)))
    heads = [(text, k) for text in pages for k in range(150) if f"Head {k};" in text]
    assert len(heads) == 150
    assert all(f"Text {k};" in text for text, k in heads)


COLUMNS = [Quantity("time", "s"), Quantity("force", "kN")]
HISTORIES = {
    name: History({"Motion": name}, COLUMNS, np.arange(8.0).reshape(4, 2)) for name in ("a", EVIL)
}


def opened_workbook(raw: bytes) -> Any:
    return openpyxl.load_workbook(io.BytesIO(raw))


@pytest.fixture(scope="module")
def book() -> Any:
    return opened_workbook(workbook_bytes(PIECES, HISTORIES))


def test_a_sheet_for_each_thing(book: Any) -> None:
    assert book.sheetnames == ["Answer", "Checks", "bearing", "peaks", "Histories"]


def test_the_first_sheet_says_what_was_asked_and_found(book: Any) -> None:
    rows = [(a.value, b.value) for a, b in book["Answer"].iter_rows(min_row=4)]
    assert ("Answer", "313 kN at -20 °C.") in rows  # without the stars of its Markdown
    assert ("Warning", "it is cold") in rows
    assert ("Version", "thermobearing 0.2.0") in rows


def test_heads_have_units_and_stay_in_view(book: Any) -> None:
    sheet = book["peaks"]
    assert [cell.value for cell in sheet[3]] == ["Run", "Force [kN]", "Strain [%]"]
    assert sheet.freeze_panes == "B4"
    assert book["Histories"].freeze_panes == "C4"
    assert sheet.auto_filter.ref == "A3:C6"
    assert sheet.column_dimensions["A"].width > 20


def test_numbers_are_numbers_with_the_digits_of_their_column(book: Any) -> None:
    sheet = book["peaks"]
    assert (sheet["B4"].value, sheet["B4"].number_format) == (-312.64, "0.0")
    assert (sheet["C4"].value, sheet["C4"].number_format) == (175.0, "0")
    assert sheet["C5"].value is None
    assert sheet["B6"].value is None
    assert sheet["C6"].fill.fgColor.rgb.endswith(workbook.MARKED)
    assert not sheet["C4"].fill.fgColor.rgb.endswith(workbook.MARKED)


def test_no_formula_is_made_of_text(book: Any) -> None:
    assert book["peaks"]["A4"].value == EVIL
    assert book["peaks"]["A4"].data_type == "s"
    raw = zipfile.ZipFile(io.BytesIO(workbook_bytes(PIECES, HISTORIES)))
    sheets = [raw.read(n) for n in raw.namelist() if n.startswith("xl/worksheets/")]
    assert len(sheets) == 5
    assert not any(b"<f>" in sheet or b"<f " in sheet for sheet in sheets)


def test_the_same_result_has_the_same_bytes() -> None:
    first = workbook_bytes(PIECES, HISTORIES)
    assert workbook_bytes(PIECES, HISTORIES) == first
    raw = zipfile.ZipFile(io.BytesIO(first))
    assert {item.date_time for item in raw.infolist()} == {workbook.STAMP}
    assert b"dcterms:created" not in raw.read("docProps/core.xml")  # nor is the hour in there


def test_runs_stand_below_each_other_and_long_ones_are_thinned(monkeypatch: Any) -> None:
    (table,) = _history_tables(HISTORIES).values()
    assert [column.title for column in table.columns] == ["Motion", "time [s]", "force [kN]"]
    assert len(table.rows) == 8
    assert table.note == ""
    monkeypatch.setattr(workbook, "MOST_HISTORY_ROWS", 4)
    (thinned,) = _history_tables(HISTORIES).values()
    assert [row[1] for row in thinned.rows] == [0.0, 4.0, 0.0, 4.0]
    assert thinned.note == "One of every 2 samples of the result."


def test_wide_histories_are_thinned_by_their_cells(monkeypatch: Any) -> None:
    monkeypatch.setattr(workbook, "MOST_HISTORY_CELLS", 8)  # of the 16 of all
    (thinned,) = _history_tables(HISTORIES).values()
    assert [row[1] for row in thinned.rows] == [0.0, 4.0, 0.0, 4.0]


def test_turned_pages_do_not_interrupt_the_upright_blocks_of_a_section() -> None:
    """They stand before the next heading or figure, with a heading that has nothing else."""

    def _blocks(words: str) -> list[dict[str, Any]]:
        kinds = {"H": "heading", "F": "figure", "t": "table", "T": "table"}
        return [{"kind": kinds[w[0]], "turned": w[0] == "T", "name": w} for w in words.split()]

    def _order(words: str) -> str:
        result = []
        for block in _turned_together(_blocks(words)):
            inner = block.get("blocks", [block])
            text = " ".join(one["name"] for one in inner)
            result.append(f"({text})" if block["kind"] == "turned" else text)
        return " ".join(result)

    assert _order("H1 t1 T1 t2 T2 F1 T3 H2 t3") == "H1 t1 t2 (T1 T2) F1 (T3) H2 t3"
    assert _order("H1 T1 H2 T2 t1") == "(H1 T1) H2 t1 (T2)"
    assert _order("t1 H1 T1 H2 T2") == "t1 (H1 T1 H2 T2)"


def test_tables_have_the_numbers_of_the_page_on_turned_pages_and_in_parts_too() -> None:
    upright, broad = (many_columns(count).tables["wide"] for count in (3, 60))
    pieces = dataclasses.replace(PIECES, tables={"a": upright, "b": broad, "c": upright})
    laid_out = _laid_out(drawn(document(pieces, BLOCK, LOGO)), None)["blocks"]
    blocks = [b for block in laid_out for b in block.get("blocks", [block])]
    numbers = {b["number"] for b in blocks if b.get("caption", "").startswith("Wide (")}
    assert len(numbers) == 1  # of all parts
    others = [b["number"] for b in blocks if b.get("caption") == "Wide"]
    assert others == [min(numbers) - 1, max(numbers) + 1]


def test_histories_with_other_columns_have_a_sheet_of_their_own() -> None:
    other = History({"Motion": "c"}, COLUMNS[:1], np.arange(3.0).reshape(3, 1))
    assert list(_history_tables(HISTORIES | {"c": other})) == ["Histories 1", "Histories 2"]


def test_tables_longer_than_a_sheet_go_on_in_another(monkeypatch: Any) -> None:
    monkeypatch.setattr(workbook, "ROWS", 6)
    rows = [(k,) for k in range(5)]
    table = Table("Long", [Quantity("n", "", "d")], rows, marked=frozenset({(3, 0)}))
    pieces = dataclasses.replace(PIECES, tables={"long": table}, inputs={}, checks=())
    book = opened_workbook(workbook_bytes(pieces, {}))
    reported = {name: [c.value for c in book[name]["A"][3:]] for name in book.sheetnames[-3:]}
    assert reported == {"long": [0, 1], "long 2": [2, 3], "long 3": [4]}
    cells = [cell for name in reported for cell in book[name]["A"][3:]]
    filled = [c.value for c in cells if c.fill.fgColor.rgb.endswith(workbook.MARKED)]
    assert filled == [3]


@pytest.mark.parametrize(
    ("wanted", "name"),
    [
        ("peaks", "peaks 2"),
        ("PEAKS", "PEAKS 2"),
        ("a/b:c*[d]?", "a b c d"),
        ("x" * 40, "x" * 31),
        ("", "Sheet"),
        ("History", "History 2"),
    ],
)
def test_names_of_sheets_are_such_as_excel_takes(wanted: str, name: str) -> None:
    assert _sheet_name(wanted, {"peaks"}) == name


@pytest.mark.parametrize(
    ("value", "form", "shown"),
    [
        (312.64, ".4g", "0.0"),
        (0.01234, ".3g", "0.0000"),
        (1e-7, ".3g", "0.00E+00"),
        (12.0, ".4g", "0"),
        ("x", ".1f", "General"),
    ],
)
def test_formats_of_numbers(value: Any, form: str, shown: str) -> None:
    table = Table("T", [Quantity("a", "", form)], [(value,)])
    book = opened_workbook(workbook_bytes(dataclasses.replace(PIECES, tables={"t": table}), {}))
    assert book["t"]["A4"].number_format == shown


def test_without_the_library_a_sentence_says_what_to_install(monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(InputError, match=r'pip install "thermobearing\[report\]"'):
        workbook_bytes(PIECES, {})


def test_signatures_have_names_and_date_of_the_title_block() -> None:
    roles = ("Prepared by", "Checked by", "Approved by")
    pieces = Pieces("bridge", "A", "B", [], signatures=roles)
    block = TitleBlock(author="A. Engineer", checked="B. Engineer", date="2026-11-05").words()
    (signatures,) = [
        part for part in document(pieces, block).blocks if isinstance(part, Signatures)
    ]
    assert [(it.role, it.name, it.date) for it in signatures.signers] == [
        ("Prepared by", "A. Engineer", "2026-11-05"),
        ("Checked by", "B. Engineer", ""),
        ("Approved by", "", ""),
    ]
    assert not document(pieces, block).close
