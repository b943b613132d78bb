"""The pictures of the documents: how each is made, and what it showed when it was made.

Three sources make all files of docs/figures: functions that return figures (`SOURCES`), blocks of
a page, for a picture below `<!-- figure: PATH -->` (docs/builder/outputs.py), and the commands of
the contact sheet (docs/builder/contact.py). What the figures show is kept in
docs/figures/shown.json and compared by tests, which thereby detect a picture that is older than
the program.
"""

import contextlib
import importlib
import json
import operator
import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import numpy as np
import pypdfium2
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from docs.builder import outputs
from tests.documented_numbers import alike
from thermobearing.results import drawing

DOCS = Path(__file__).parents[1]
FIGURES = DOCS / "figures"
SHOWN = FIGURES / "shown.json"
PAGES = sorted((DOCS / "guide").glob("*.md"))
REDRAW = "python -m docs.generate --pictures"
WIDEST = 1000  # pixels of a picture of a page
DIGITS = 4  # of the numbers that are kept
AGREES = 5e-3  # of the range of an axis: numbers of other processors and libraries
CHANGING = re.compile(r"\d{4}-\d\d-\d\d|\d+\.\d+\.\d+\S*|\b[0-9a-f]{8,}\b")  # date, version, digest
LEADERS = re.compile(r"(?: \.){3,} ")  # of a table of contents
Panels = list[dict[str, Any]]
Shown = dict[str, Panels]  # by the path of a picture in docs/figures


class Source(NamedTuple):
    """A function that returns a figure, or figures by name."""

    function: str  # module:function
    pictures: tuple[str, ...]
    dpi: int = 110
    slow: bool = True  # whether only the thorough tests draw it

    def draw(self) -> dict[str, Figure]:
        """Return its figures by the name of their picture."""
        module, name = self.function.split(":")
        drawn = getattr(importlib.import_module(module), name)()
        return drawn if isinstance(drawn, dict) else {self.pictures[0]: drawn}


COLD_TOWN = ("cold_town_weather", "cold_town_fragility", "cold_town_rates")
SOURCES = (
    Source("docs.builder.drawings:draw_loops", ("loops",)),
    Source("docs.builder.drawings:draw_bridge", ("bridge",)),
    Source("docs.builder.drawings:draw_cold", ("cold",), slow=False),
    Source("docs.builder.drawings:draw_bounds", ("bounds",), 80),
    Source("docs.builder.drawings:draw_scale", ("scale",), 80),
    Source("docs.builder.drawings:draw_plan", ("five_span_bridge_plan",), slow=False),
    Source("docs.builder.sketch:draw", ("pier_p1",), slow=False),
    Source("benchmarks.small_loops:draw", ("small_loops",), slow=False),
    Source("benchmarks.takeda_figure:draw", ("takeda",), slow=False),
    Source("benchmarks.alternative_bearings:draw", ("alternative_bearings",)),
    Source("benchmarks.cold_town:draw", COLD_TOWN),
    Source("benchmarks.opensees_lead_figure:draw", ("opensees_lead",), 120),
    Source("benchmarks.opensees_pier_figure:draw", ("opensees_pier",)),
    Source("benchmarks.opensees_girder:draw_all", ("opensees_girder",), 80),
)


def page_pictures(page: Path) -> dict[str, str]:
    """Return the files that the blocks of a page write, by the name of the picture."""
    matches = outputs.PICTURE.finditer(page.read_text(encoding="utf-8"))
    return {Path(match["shown"]).name: match["made"] for match in matches}


def load_shown() -> Shown:
    """Return what the pictures showed when they were made."""
    return dict(json.loads(SHOWN.read_text(encoding="utf-8"))) if SHOWN.exists() else {}


def update_shown(new: Shown) -> None:
    """Keep what new pictures show, and forget pictures that are gone."""
    # Pictures that were deleted go out of the file with the next one that is drawn.
    shown = load_shown() | new
    present = {name: shown[name] for name in sorted(shown) if (FIGURES / name).exists()}
    rows = [
        f"{json.dumps(name)}: {json.dumps(present[name], ensure_ascii=False)}" for name in present
    ]
    SHOWN.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


def draw_sources(sources: Sequence[Source]) -> None:
    """Draw the pictures of functions, and keep what they show."""
    for source in sources:
        for name, figure in source.draw().items():
            drawing.save_figure(figure, FIGURES / f"{name}.png", dpi=source.dpi)
            update_shown({f"{name}.png": describe(figure)})


class Recorder:
    """What the figures show that have been saved; a file is known after its folder was renamed."""

    def __init__(self) -> None:
        self._shown: dict[int, Panels] = {}

    def note(self, path: Any, figure: Figure) -> None:
        """Keep what a figure shows that was just written to a path."""
        if isinstance(path, str | Path):
            self._shown[Path(path).stat().st_ino] = describe(figure)

    def __getitem__(self, path: Path) -> Panels:
        """Return what the figure in a file shows."""
        return self._shown[path.stat().st_ino]


@contextlib.contextmanager
def recorded() -> Iterator[Recorder]:
    """Note meanwhile what each figure shows that is saved as a file."""
    recorder = Recorder()
    original_save, original_savefig = drawing.save_figure, Figure.savefig

    def save_figure(figure: Figure, path: Any, *rest: Any, **words: Any) -> None:
        original_save(figure, path, *rest, **words)
        recorder.note(path, figure)

    def savefig(figure: Figure, path: Any, *rest: Any, **words: Any) -> None:
        original_savefig(figure, path, *rest, **words)
        recorder.note(path, figure)

    with (
        mock.patch.object(drawing, "save_figure", save_figure),
        mock.patch.object(Figure, "savefig", savefig),
    ):
        yield recorder


def draw_page(page: Path) -> None:
    """Run a page in an empty folder, copy the pictures that it shows, and keep what they show."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        with recorded() as shown:
            for _ in outputs.run(page, {"__name__": "page"}, outputs.run_command, draw=True):
                pass
        for name, file in page_pictures(page).items():
            image = _image(Path(file))
            if image.width > WIDEST:
                image = image.resize((WIDEST, round(image.height * WIDEST / image.width)))
            image = image.convert("RGB").quantize(256, dither=Image.Dither.NONE)
            image.save(FIGURES / name, optimize=True)
        update_shown(shown_by_page(page, shown))


def shown_by_page(page: Path, shown: Recorder) -> Shown:
    """Return what the pictures of a page show that has run in the working directory."""
    return {
        name: describe_page(Path(file)) if file.endswith(".pdf") else shown[Path(file)]
        for name, file in page_pictures(page).items()
    }


def _image(path: Path) -> Image.Image:
    """Return a picture, or the first page of a PDF."""
    if path.suffix != ".pdf":
        return Image.open(path)
    return pypdfium2.PdfDocument(path)[0].render(scale=1.6).to_pil()


def describe(figure: Figure) -> Panels:
    """Return texts, colours and the extent of the data of each panel.

    Nothing depends on fonts, places of texts or the choice of ticks.
    """
    figure_texts = [text for text in figure.texts if text.get_text()]
    figure_texts += [text for legend in figure.legends for text in legend.get_texts()]
    panels: Panels = [{"texts": _words(figure_texts)}]
    return panels + [_describe_panel(ax) for ax in figure.axes if ax.get_visible()]


def _describe_panel(ax: Axes) -> dict[str, Any]:
    texts: list[Any] = [child for child in ax.get_children() if isinstance(child, Text)]
    texts += [ax.xaxis.label, ax.yaxis.label]
    texts += [] if (legend := ax.get_legend()) is None else legend.get_texts()
    pieces: dict[str, list[Any]] = {
        "lines": [line.get_xydata() for line in ax.lines],
        "patches": [patch.get_path().vertices for patch in ax.patches],
        "areas": [path.vertices for area in ax.collections for path in area.get_paths()],
        "points": [np.ma.filled(marks.get_offsets(), np.nan) for marks in ax.collections],
        "images": [np.column_stack([np.ravel(image.get_array())] * 2) for image in ax.images],
    }
    panel: dict[str, Any] = {"texts": _words(texts)}
    panel["colours"] = sorted({to_hex(line.get_color()) for line in ax.lines})
    for kind, arrays in pieces.items():
        if not arrays:
            continue
        points = np.concatenate([np.asarray(array, dtype=float).reshape(-1, 2) for array in arrays])
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            ends = [points.min(axis=0), points.max(axis=0), points.mean(axis=0)]
            numbers = [float(f"{value:.{DIGITS}g}") for value in np.ravel(ends)]
            panel[kind] = [len(arrays), *numbers]
    return panel


def _words(texts: Sequence[Text]) -> list[str]:
    return [" ".join(text.get_text().split()) for text in texts if text.get_text().strip()]


def without_extent(panels: Panels) -> Panels:
    """Return what a figure shows without the extent of its data, which may be rounding errors."""
    return [
        {kind: row if kind in SAME else row[:1] for kind, row in panel.items()} for panel in panels
    ]


def describe_page(path: Path) -> Panels:
    """Return the words of the first page of a PDF, without what changes with each run."""
    with pypdfium2.PdfDocument(path) as document:
        text = document[0].get_textpage().get_text_bounded()
    words = CHANGING.sub("*", LEADERS.sub(" ", " ".join(text.split())))
    return [{"texts": [words]}]


def differences(now: Panels, before: Panels) -> list[str]:
    """Return what a figure shows now and did not when its picture was made."""
    if len(now) != len(before):
        return [f"{len(now)} panels, before {len(before)}"]
    sentences = []
    for number, (new, old) in enumerate(zip(now, before, strict=True)):
        for kind in sorted({*new, *old}):
            new_panels, old_panels = new.get(kind, []), old.get(kind, [])
            if not SAME.get(kind, _same_extent)(new_panels, old_panels):
                sentences.append(f"panel {number}: {kind} {new_panels}, before {old_panels}")
    return sentences


def _same_texts(now: list[str], before: list[str]) -> bool:
    return len(now) == len(before) and all(map(alike, now, before))


def _same_extent(now: list[float], before: list[float]) -> bool:
    if len(now) != len(before) or now[:1] != before[:1]:
        return False
    if len(now) < 2:
        return True
    a, b = np.array(now[1:]).reshape(3, 2), np.array(before[1:]).reshape(3, 2)
    room = AGREES * np.maximum(b[1] - b[0], 1e-9) + 10.0**-DIGITS * np.abs(b).max(axis=0)
    return bool((np.abs(a - b) <= room).all())


SAME: dict[str, Callable[[Any, Any], bool]] = {"texts": _same_texts, "colours": operator.eq}


def outdated(shown: Shown) -> str:
    """Return which pictures are older than what they show, and the command that redraws them."""
    stored = load_shown()
    lines = []
    for name, panels in shown.items():
        differing = (
            differences(panels, stored[name]) if name in stored else ["is not in shown.json"]
        )
        lines += [f"docs/figures/{name}: {difference}" for difference in differing]
    names = {line.split(":")[0].removeprefix("docs/figures/") for line in lines}
    return "\n".join([*lines, f"{REDRAW} {' '.join(sorted(names))}"]) if lines else ""


def draw_pictures(names: Sequence[str] = ()) -> None:
    """Draw the named pictures, or all, with those of the same source."""
    from docs.builder import contact  # which uses this module

    def wanted(pictures: Sequence[str]) -> bool:
        return not names or bool({*names} & {*pictures})

    draw_sources([row for row in SOURCES if wanted([f"{name}.png" for name in row.pictures])])
    for page in PAGES:
        pictures = list(page_pictures(page))
        if pictures and wanted(pictures):
            draw_page(page)
    if wanted([f"contact/{path.name}" for path in contact.SHEET.glob("*.png")]):
        contact.draw()
