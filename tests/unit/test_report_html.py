"""Reports as web pages, and templates of users."""

import base64
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tests import tolerances as tol
from tests.browser.document import HOSTILE, document
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report import figures
from thermobearing.report.content import summarize_checks
from thermobearing.report.html import MOST_ROWS, html_page
from thermobearing.report.pieces import (
    Block,
    Bullets,
    Check,
    Document,
    FigureBlock,
    Heading,
    Link,
    Paragraph,
    Pieces,
    Plot,
    ReportFigure,
    TableBlock,
    Trace,
    checks_table,
)
from thermobearing.report.template import _arranged
from thermobearing.results import drawing

pytestmark = pytest.mark.drawn


DATA = data_path("report-page")


class Parts(HTMLParser):
    """Start tags of a page with their attributes, and what stands in scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self._inside = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self._inside = tag == "script"
        if self._inside:
            self.scripts.append("")

    def handle_endtag(self, tag):
        self._inside = False

    def handle_data(self, data):
        if self._inside:
            self.scripts[-1] += data


@pytest.fixture(scope="module")
def page() -> str:
    return html_page(document())


def body(*blocks: Block) -> str:
    text = html_page(Document("A test", {}, None, blocks, {}))
    return text[text.index("<main") : text.index("</main>")]


def table_text(table: Table) -> str:
    return body(TableBlock("one", table))


def lines(*traces: Trace, **other) -> Plot:
    return Plot("x [mm]", "force [kN]", {"": list(traces)}, **other)


def numbers(data: dict, place: int) -> np.ndarray:
    return np.frombuffer(base64.b64decode(data["arrays"][place]), dtype="<f4")


def test_the_same_document_has_the_same_bytes(page):
    assert html_page(document()) == page


def test_what_users_wrote_is_no_part_of_the_page(page):
    assert "<script>window" not in page
    tags = Parts(page).tags
    assert not [attributes for _, attributes in tags if "onerror" in attributes]
    plots = sum(isinstance(b, FigureBlock) and b.figure.plot is not None for b in document().blocks)
    assert sum(tag == "script" for tag, _ in tags) == 2 + plots  # the page, plots; numbers
    hurt = Document(HOSTILE, {"Project": HOSTILE}, None, [Heading(1, HOSTILE)], {HOSTILE: HOSTILE})
    assert [tag for tag, _ in Parts(html_page(hurt)).tags].count("script") == 1


def test_nothing_is_asked_of_a_network_and_no_other_script_runs(page):
    parts = Parts(page)
    policy = next(a["content"] for _, a in parts.tags if a.get("http-equiv"))
    for part in ("default-src 'none'", "base-uri 'none'", "form-action 'none'"):
        assert part in policy.split("; ")
    running = [s for s, (_, a) in zip(parts.scripts, _scripts(parts), strict=True) if not a]
    hashes = [base64.b64encode(hashlib.sha256(s.encode()).digest()).decode() for s in running]
    assert re.findall(r"'sha256-(.+?)'", policy) == hashes
    sources = [a.get(name) for _, a in parts.tags for name in ("src", "href") if a.get(name)]
    assert all(source.startswith(("data:", "#")) for source in sources)


def _scripts(parts: Parts) -> list[tuple[str, dict[str, str | None]]]:
    return [(tag, attributes) for tag, attributes in parts.tags if tag == "script"]


def test_plots_have_a_script_only_where_they_are_and_pages_are_small(page):
    assert len(page) < 200_000
    small = html_page(Document("A test", {}, None, [Paragraph("It held.")], {}))
    assert len(small) < 40_000
    assert "IntersectionObserver" in page
    assert "IntersectionObserver" not in small
    for file in ("page.js", "plots.js"):  # nothing ends their element
        assert not re.search(r"</script|<!--", (DATA / file).read_text(), re.IGNORECASE)


def test_headings_go_down_one_by_one_and_every_name_is_given_once(page):
    tags = Parts(page).tags
    levels = [int(tag[1]) for tag, _ in tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[:2] == [1, 2]
    assert max(np.diff(levels)) == 1  # the third level below the first was asked for
    names = [a["id"] for _, a in tags if "id" in a]
    assert len(names) == len(set(names))
    links = {a["href"] for tag, a in tags if tag == "a"}
    assert {"#what-was-asked", "#tables", "#figures", "#content"} <= links
    assert links <= {f"#{name}" for name in names}
    pointed = [a[k] for _, a in tags for k in ("for", "aria-labelledby") if k in a]
    assert pointed
    assert set(pointed) <= set(names)


def test_addresses_within_a_page():
    text = body(*(Heading(1, words) for words in ("Content", "A & B", "a b", "冷")))
    assert re.findall(r'<h2 id="(.+?)"', text) == ["content-2", "a-b", "a-b-2", "section"]


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("**a** *b* `c`", "<strong>a</strong> <em>b</em> <code>c</code>"),
        ("[words](https://example.org)", '<a href="https://example.org">words</a>'),
        ("[words](javascript:alert(1))", "[words](javascript:alert(1))"),
        ("<b>bold</b> &lt;", "&lt;b&gt;bold&lt;/b&gt; &amp;lt;"),
        ("my_bearing_1 and 3 * 4 * 5", "my_bearing_1 and 3 * 4 * 5"),
    ],
)
def test_markdown_of_a_sentence(text, reported):
    assert f"<p>{reported}</p>" in body(Paragraph(text))


def test_pictures_from_elsewhere_and_links_in_headings_stay_words():
    assert "<img" not in body(Paragraph("![x](https://example.org/x.png)"))
    assert "<a" not in body(Heading(1, "[x](https://example.org)"))


def test_long_words_may_be_broken_and_stay_whole_when_they_are_copied():
    digest = "0123456789abcdef" * 4
    text = table_text(Table("x", [Quantity("a")], [(f"a {digest} <b>",)]))
    assert "<wbr>" in text
    assert f"a {digest} &lt;b&gt;" in text.replace("<wbr>", "")
    assert ">shen-lhdr-specimen<" in table_text(
        Table("x", [Quantity("a")], [("shen-lhdr-specimen",)])
    )


def test_cells_of_a_table():
    columns = [Quantity("Run"), Quantity("Force", "kN", ".1f"), Quantity("Value"), Quantity("Unit")]
    rows = [("a", -1.25, 3.0, "mm"), ("b", float("nan"), "steel", ""), ("c", 2.0, 4.0, "mm")]
    table = Table("Forces", columns, rows, marked=frozenset({(2, 1)}), note="N.")
    text = table_text(table)
    assert "Table 1." in text
    assert '<th scope="row" class="words brief">a</th>' in text
    assert '<td class="amount" data-value="-1.25">−1.2</td>' in text
    assert '<td class="amount" data-value=""></td>' in text  # nothing, and so below all others
    assert '<td class="amount">steel</td>' in text  # most of its column are numbers
    assert re.search(r'class="marked amount" data-value="2">†<span.+?</span> 2.0</td>', text)
    assert '<p class="note">† outside the calibration range. N.</p>' in text
    assert 'Force <span class="unit">[kN]</span></button>' in text
    assert "<button" not in table_text(Table("Two", columns, rows[:2]))


def test_a_cell_leads_to_a_figure_of_the_document():
    rows = [(Link("Fig. 3.8", "fig_3_08"),), (Link("Fig. 9.9", "not there"),)]
    blocks = [
        TableBlock("claims", Table("Claims", [Quantity("Figure")], rows)),
        FigureBlock("other", ReportFigure("first", image=b"<svg/>")),
        FigureBlock("fig_3_08", ReportFigure("second", image=b"<svg/>")),
    ]
    page = html_page(Document("A test", {}, None, blocks, {}))
    assert '<a href="#figure-2">Fig. 3.8</a>' in page
    assert 'id="figure-2"' in page
    assert ">Fig. 9.9</th>" in page


def test_broad_tables_are_turned_on_paper():
    def look(count):
        columns = [Quantity(f"Quantity {place}") for place in range(count)]
        return table_text(Table("x", columns, [[1234.5] * count] * 20))

    assert 'class="table"' in look(5)
    assert 'class="table broad"' in look(15)


def test_long_tables_open_with_the_rows_that_govern():
    rows = [(f"run {k}", float(k)) for k in range(MOST_ROWS + 60)]
    columns, marked = [Quantity("Run"), Quantity("Force", "kN", "g")], frozenset({(3, 1)})
    text = table_text(Table("x", columns, rows, marked=marked, governing="Force"))
    shown, folded = (re.findall(r">(run \d+)<", part) for part in text.split("<details"))
    assert shown[:3] == ["run 3", f"run {MOST_ROWS + 59}", f"run {MOST_ROWS + 58}"]
    assert (len(shown), len(folded)) == (MOST_ROWS, 60)
    assert folded[:4] == ["run 0", "run 1", "run 2", "run 4"]
    plain = table_text(Table("x", columns, rows))
    assert re.findall(r">(run \d+)<", plain) == [row[0] for row in rows]


def test_verdicts_are_words_and_signs():
    checks = [
        Check("strain", 2.81, 2.5, "", "Table 1", "exceeded"),
        Check("force", 312.0, 400.0, "kN", "sheet", "within"),
        Check("gap", 12.0, 10.0, "mm", "sheet", "within", lower=True),
        Check("lead", 80.0, float("nan"), "°C", "", "not assessed"),
    ]
    words = re.sub(r"<.+?>", "|", body(TableBlock("checks", checks_table(checks))))
    for reported in ("✕ exceeded", "✓ within", "≤ 400", "≥ 10", "|none|", "– not assessed"):
        assert reported in words


def test_small_figures_are_vectors_and_large_ones_points(monkeypatch):
    def draw():
        figure = Figure()
        figure.subplots().plot([0.0, 1.0], [0.0, 1.0], label="<b>")
        return figure

    figure = ReportFigure("A <line>", draw=draw)
    small = body(FigureBlock("line", figure))
    assert 'src="data:image/svg+xml,' in small
    assert 'alt="A &lt;line&gt;"' in small
    assert [tag for tag, _ in Parts(small).tags].count("img") == 1
    monkeypatch.setattr(figures, "LARGEST_VECTORS", 1000)
    assert 'src="data:image/png;base64,' in body(FigureBlock("line", figure))
    logo = html_page(Document("x", {}, b"<svg onload='hurt()'/>", [], {}))
    # A separate picture, in which no script runs.
    assert not [attributes for _, attributes in Parts(logo).tags if "onload" in attributes]


def test_histories_keep_their_extremes_and_gaps():
    x = np.linspace(0.0, 100.0, 50_001)
    y = np.sin(x)
    y[12_345], y[40_000], y[30_000:30_010] = 5.0, -7.0, np.nan
    found_x, found_y = figures._thinned(x, y, 1000)
    assert len(found_x) <= 1150
    assert np.nanmax(found_y) == 5.0
    assert np.nanmin(found_y) == -7.0
    assert np.isnan(found_y).sum() == 1
    assert found_x[np.isnan(found_y)][0] == x[30_000]
    assert (found_x[0], found_x[-1]) == (x[0], x[-1])
    for few in ((x[:900], y[:900]), (x, np.full_like(x, np.nan))):
        assert len(figures._thinned(*few, 1000)[0]) <= 1000


def test_paths_keep_their_shape_and_turns():
    angle = np.linspace(0.0, 60.0 * np.pi, 60_001)
    x, y = np.cos(angle), np.sin(angle)
    found_x, found_y = figures._thinned(x, y, 4000)
    assert len(found_x) <= 2 * 4000
    assert np.hypot(found_x, found_y) == pytest.approx(1.0)
    assert found_x.max() > 1.0 - tol.SEEN
    assert np.abs(np.diff(found_x)).max() < 0.1  # evenly along the way


def test_a_page_has_its_own_words_for_plots_bands_and_failed_checks():
    test = Trace("test", np.arange(3.0), np.arange(3.0), look="broad")
    plot = lines(test)
    figure = ReportFigure("Rise.", alt="Rise. 44 K.", plot=plot, plot_caption="Temperature.")
    text = body(FigureBlock("t", figure))
    assert "Temperature." in text
    assert 'aria-label="Temperature. 44 K."' in text
    assert '"look":"broad"' in text
    assert figures.LOOKS["broad"]["linewidth"] > 1.1
    columns = [Quantity("Check"), Quantity("Verdict")]
    marked = frozenset({(0, 1), (1, 0)})
    failed = table_text(Table("x", columns, [("strain", "NG"), ("force", "OK")], marked=marked))
    assert "limit exceeded:</span> NG" in failed
    assert "outside the calibration range:</span> force" in failed


def test_paths_with_noise_keep_the_extremes_of_both_axes():
    """Noise turns the path at every point, so that its turns alone do not say where peaks are."""
    time = np.linspace(0.0, 20.0 * np.pi, 11_001)
    noise = 0.02 * np.where(np.arange(len(time)) % 2, 1.0, -1.0)
    growth = 1.0 + 0.02 * np.arange(len(time)) / len(time)  # one cycle is the largest
    x, y = growth * np.sin(time) + noise, growth * np.cos(time) + 0.1 * noise
    found_x, found_y = figures._thinned(x, y, 741)
    assert len(found_x) <= 741
    assert (found_x.min(), found_x.max()) == (x.min(), x.max())
    assert (found_y.min(), found_y.max()) == (y.min(), y.max())
    # The peaks of every cycle too, not only the largest of all.
    for start in range(0, 11_000, 1100):
        inside = np.isin(y, found_y)[start : start + 1100]
        assert y[start : start + 1100][inside].max() > 0.999


def test_points_are_shared_so_that_the_page_stays_small():
    def lengths(*counts):
        return [lines(*(Trace("", np.zeros(n), np.zeros(n)) for n in counts))]

    assert figures.points_each(lengths(10, 100_000)) == figures.MOST_POINTS
    assert figures.points_each(lengths(*[10_000] * 100)) == figures.ALL_POINTS // 100
    # Short lines leave room for the others.
    shared = (figures.ALL_POINTS - 50 * 100) // 100
    assert figures.points_each(lengths(*[100] * 50, *[10_000] * 100)) == shared
    assert figures.points_each(lengths(*[500] * 5000)) == figures.FEWEST_POINTS


def test_numbers_of_plots_are_typed_floats_written_once():
    x, frames = np.linspace(0.0, 1.0, 5), np.arange(10.0).reshape(2, 5)
    traces = [Trace("a", x, 2.0 * x), Trace("b", x, frames[0], frames=frames)]
    plot = lines(*traces, slider=["0 s", "1 s"], bands=[(-np.inf, 0.2, "x"), (9.0, np.inf, "y")])
    data = json.loads(figures.plot_json(plot, 100))
    first, second = data["choices"][0]
    assert first["x"] == second["x"]
    np.testing.assert_allclose(numbers(data, first["y"]), 2.0 * x, rtol=tol.TYPED_FLOAT)
    assert numbers(data, second["frames_y"]).tolist() == list(range(10))
    assert (first["frames_y"], second["frames_x"]) == (None, None)
    assert data["bands"] == [[None, 0.2], [9.0, None]]


def test_menu_slider_and_what_is_shaded():
    x = np.array([0.0, 1.0])
    choices = {"one <a>": [Trace("t", x, x)], "two": [Trace("t", x, x)]}
    bands = [(0.5, np.inf, "beyond <b>"), (5.0, np.inf, "far away")]
    plot = Plot("x", "y", choices, ["0 s", "1 s"], "time", bands=bands)
    text = body(FigureBlock("loops", ReportFigure("Loops", plot=plot)))
    assert '<label for="plot-1-menu">' in text
    assert "<option>one &lt;a&gt;</option><option>two</option>" in text
    assert '<label for="plot-1-slider">Time</label>' in text
    assert 'max="1"' in text
    assert "Shaded: beyond &lt;b&gt;.</p>" in text  # no line comes to the other
    plain = body(FigureBlock("a", ReportFigure("Loops", plot=lines(Trace(HOSTILE, x, x)))))
    assert "<select" not in plain
    assert "<input" not in plain
    assert plain.count("<script") == 1


def test_boxes_say_what_they_are():
    text = html_page(
        Document("x", {}, None, [Bullets(["a", "b"], "answer"), Paragraph("c", "warning")], {})
    )
    assert (
        '<div class="box answer" role="note"><p class="box-name">Main results</p>\n<p>a</p>' in text
    )
    assert "⚠ Warning</p>\n<p>c</p>" in text


def test_drawn_panels_become_a_plot() -> None:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    x = np.linspace(0.0, 2.0, 5)
    left.plot(x, x**2, color="#cc3311", label="model")
    left.plot(x, x, "--", color="#0077bb")
    left.plot([1.0], [1.0], "o", color="#0077bb")
    left.axhline(0.0)  # across the panel: no data
    left.axvspan(1.5, 3.0, color=drawing.UNTESTED)
    left.axvspan(4.0, 5.0, color=drawing.UNTESTED)  # beyond the lines
    left.set(xlabel="x [mm]", ylabel="force [kN]")
    right.plot(x, x, color="#0077bb")
    right.set(xlabel="time [s]")  # the label of the first panel in its row holds for it
    entries = [("#0077bb", "-", "test"), (drawing.GREY, "--", "slow")]
    legend = [Line2D([], [], color=c, linestyle=line, label=name) for c, line, name in entries]
    empty = figures.blank_panel()
    plot = figures.plot_from_axes({"a": left, "b": right, "c": empty}, legend)
    looks = {
        name: [(t.name, t.colour, t.look) for t in plot.choices[name]] for name in plot.choices
    }
    blue = "#0077bb"
    assert looks == {
        "a": [
            ("model", "#cc3311", "line"),
            ("test, slow", blue, "dashed"),
            ("test", blue, "points"),
        ],
        "b": [("test", blue, "line")],
    }
    assert plot.choices["a"][0].y.tolist() == (x**2).tolist()
    assert [band[:2] for band in plot.bands] == [(1.5, 3.0)]
    assert plot.axis_titles("a") == ("x [mm]", "force [kN]")
    assert plot.axis_titles("b") == ("time [s]", "force [kN]")
    figure.legend(handles=legend)  # entries of the figure count as well
    names = [t.name for t in figures.plot_from_axes({"a": left}).choices["a"]]
    assert names == ["model", "test, slow", "test"]


def test_a_block_draws_every_point() -> None:
    x = np.linspace(0.0, 1.0, 5000)
    with drawing.every_point():
        assert len(drawing.thin(x, 10)) == len(drawing.thin_loops(x, x, 1.0, 1.0)) == 5000
    assert len(drawing.thin(x, 10)) < 100


@pytest.mark.parametrize("count", [1, 3, 9])
def test_a_plot_is_drawn_for_paper(count):
    x = np.linspace(0.0, 1.0, 50)
    traces = [Trace("a", x, x), Trace("b", x, x**2, look="points")]
    figure = figures._draw_plot(Plot("x [mm]", "y", {f"motion {k}": traces for k in range(count)}))
    assert len(figure.axes) == min(count, figures.MOST_PANELS)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["a", "b"]
    assert figure.axes[-1].get_title(loc="left") == ("" if count == 1 else f"motion {count - 1}")


def test_frames_of_a_slider_are_drawn_as_shades_and_equal_axes_stay_equal():
    x, frames = np.linspace(0.0, 1.0, 5), np.arange(100.0).reshape(20, 5)
    trace = Trace("a", x, frames[0], frames=frames)
    plot = Plot("x", "y", {"": [trace]}, [f"{k} s" for k in range(20)], "time", equal=True)
    (ax,) = figures._draw_plot(plot).axes
    shades = [line.get_alpha() for line in ax.get_lines()]
    assert shades == sorted(shades)
    assert len(shades) == figures.MOST_FRAMES
    assert ax.get_aspect() == 1.0


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


def arranged_blocks(text, tmp_path, pieces=PIECES):
    path = tmp_path / "mine.md"
    path.write_text(text)
    return _arranged(pieces, path)


def test_pieces_called_by_name_are_not_reported_again(tmp_path):
    blocks = arranged_blocks(
        "{{ tables }}\n{{ table layers }}\n{{ figure loops }}\n{{ figures }}", tmp_path
    )
    assert [(type(b), b.name) for b in blocks] == [
        (TableBlock, "cycles"),
        (TableBlock, "layers"),
        (FigureBlock, "loops"),
    ]


def test_lines_join_to_paragraphs_and_lists(tmp_path):
    blocks = arranged_blocks("# One\na\nb\n\nc\n- d\n- e\n## Two\nf", tmp_path)
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
        "# Checks\n{{ checks }}\n# Energy\n## All\n{{ energy }}\n"
        "# Validity\n## Of it\n{{ validity }}"
    )
    kept = [block.text for block in arranged_blocks(text, tmp_path) if isinstance(block, Heading)]
    assert kept == ["Checks", "Validity", "Of it"]


def test_warnings_are_marked_and_checks_come_whole(tmp_path):
    blocks = arranged_blocks("{{ warnings }}\n{{ checks }}", tmp_path)
    assert blocks == [
        Bullets(["it melts"], "warning"),
        Paragraph(summarize_checks(PIECES.checks)),
        TableBlock("checks", checks_table(PIECES.checks, "Engineering limits")),
    ]


@pytest.mark.parametrize(
    ("line", "reported"),
    [
        ("{{ table cycle }}", 'did you mean "cycles"'),
        ("{{ figure lead }}", 'write "lead?" where it may be missing'),
        ("{{ tabels }}", 'did you mean "tables"'),
        ("{{ chapter one }}", "table NAME or figure NAME"),
        ("so {{ tables }}", "alone on its line"),
    ],
)
def test_wrong_placeholders_are_reported_with_their_line(line, reported, tmp_path):
    with pytest.raises(InputError, match="line 2: ") as error:
        arranged_blocks(f"# Head\n{line}", tmp_path)
    assert reported in str(error.value)


def test_what_may_be_missing_may_be_missing(tmp_path):
    assert arranged_blocks("# Lead\n{{ figure lead? }}", tmp_path) == []


def test_without_a_verdict_on_validity_the_reason_is_reported(tmp_path):
    unknown = Pieces("cyclic", "A test", "?", [], validity_unknown="no range is given")
    assert arranged_blocks("{{ validity }}", tmp_path, unknown) == [
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
    verdicts = ["within", "not assessed", "exceeded", "within", "exceeded"]
    checks = [Check(str(k), 1.0, 2.0, "kN", "-", verdict) for k, verdict in enumerate(verdicts)]
    blocks = arranged_blocks("{{ checks }}\n", tmp_path, replace(PIECES, checks=checks))
    assert [row[0] for row in blocks[1].table.rows] == ["2", "4", "1", "0", "3"]
    document = _arranged(replace(PIECES, checks=checks))
    (first,) = [b for b in document if isinstance(b, TableBlock) and b.name == "exceeded"]
    assert [row[0] for row in first.table.rows] == ["2", "4"]
    (actions,) = [b for b in document if isinstance(b, Bullets) and len(b.items) == 2]
    assert actions.kind == ""


def test_limits_that_are_not_entered_are_one_sentence(tmp_path):
    """Of two bearings: the larger value of each limit; the first sentence counts both."""
    checks = [
        Check("kept, P1", 1.0, 2.0, "kN", "-", "within"),
        Check("stress, P1", 3.0, np.nan, "MPa", "-", "not assessed", limited="stress"),
        Check("stress, A1", -5.5, np.nan, "MPa", "-", "not assessed", limited="stress"),
        Check("uplift, P1", 8.0, np.nan, "kN", "-", "not assessed", limited="uplift"),
        Check("needs, P1", np.nan, 2.0, "kN", "needs a load", "not assessed"),
        Check("broken, P1", 3.0, 2.0, "kN", "-", "exceeded"),
        Check("strain", 3.0, 2.0, "", "calibration range", "exceeded", of_tests=True),
    ]
    first, table, last = arranged_blocks("{{ checks }}", tmp_path, replace(PIECES, checks=checks))
    assert [int(n) for n in re.findall(r"\d+", first.text)] == [1, 1, 2, 3, 1, 1]
    assert [row[0] for row in table.table.rows] == ["broken, P1", "needs, P1", "kept, P1"]
    assert re.findall(r"[-−.\d]+ \w+", last.text) == ["2 limits", "−5.5 MPa", "8 kN"]
    (alone,) = arranged_blocks("{{ checks }}", tmp_path, replace(PIECES, checks=checks[:1]))[1:]
    assert isinstance(alone, TableBlock)


def test_warnings_say_how_many_stand_under_validity(tmp_path):
    pieces = replace(PIECES, validity=["a", "b"], validity_unknown="c", warnings=["d"])
    last = arranged_blocks("{{ warnings }}", tmp_path, pieces)[-1]
    assert re.findall(r"\d+ more", last.text) == ["3 more"]
    pieces = replace(pieces, validity=[], validity_unknown="", warnings=["d"])
    (bullets,) = arranged_blocks("{{ warnings }}", tmp_path, pieces)
    assert bullets.items == ["d"]


@pytest.mark.parametrize(
    ("value", "limit", "shown"),
    [
        (19.8585, 30.0, (19.9, "≤ 30")),
        (250.4, 250.0, (250.4, "≤ 250")),
        (3, np.nan, (3, "none")),
        (1765.4, 11722.1, (1765.0, "≤ 11722")),
        (-1765.4, 250.0, (-1765.0, "≤ 250")),
    ],
)
def test_checks_have_three_digits_and_more_where_they_decide(value, limit, shown):
    (row,) = checks_table([Check("x", value, limit, "kN", "-", "exceeded")]).rows
    assert row[1:3] == shown
