"""List what is built in, check files, create bearings, and write reports of results."""

import re
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.bearing.sources import is_assumed
from thermobearing.commands.common import (
    FILES,
    REPORT,
    RESULT,
    Answer,
    app,
    echo_written,
    megabytes,
)
from thermobearing.commands.options import (
    NoLive,
    Overwrite,
    Quiet,
    Template,
    Title,
    Workbook,
    command,
    fields,
    option,
)

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing

MEASURED = re.compile(r"(?<!not )\bmeasured\b")


@command(app, "list", examples="list", panel=FILES, laws=True)
def _list() -> Answer:
    """List the built-in bearings, compounds, structures, rigs, laws and motions."""
    from thermobearing.bearing.bilinear import BILINEAR, load_bilinear
    from thermobearing.bearing.compound import COMPOUNDS, load_compound
    from thermobearing.bearing.library import list_bearings, load_bearing
    from thermobearing.cyclic.case import RIGS, load_rig
    from thermobearing.laws import known_laws
    from thermobearing.motions.library import list_motions
    from thermobearing.structure.model import list_structures, load_structure

    for bearing in map(load_bearing, list_bearings()):
        typer.echo(f"{bearing.name:24}  {bearing.kind:8}  {bearing.description}")
    for backbone in map(load_bilinear, BILINEAR.names()):
        typer.echo(f"{backbone.name:24}  {backbone.kind:8}  {backbone.description}")
    typer.echo("")
    for compound in map(load_compound, COMPOUNDS.names()):
        typer.echo(f"{compound.name:24}  compound  {compound.description}")
    typer.echo("")
    for structure in map(load_structure, list_structures()):
        typer.echo(f"{structure.name:24}  structure  {structure.description}")
    for rig in map(load_rig, RIGS.names()):
        typer.echo(f"{rig.name:24}  rig        {rig.description}")
    typer.echo("")
    for law in known_laws().values():
        numbers = law.shown(law.values(None)) or law.source
        typer.echo(f"{law.name:24}  law of {law.kind:11}  {law.description} ({numbers})")
    motions = list_motions()
    typer.echo(f"\n{len(motions)} ground motions, see `thermobearing motions list`")
    return {
        "bearings": list_bearings(),
        "bilinear_bearings": BILINEAR.names(),
        "compounds": COMPOUNDS.names(),
        "structures": list_structures(),
        "rigs": RIGS.names(),
        "laws": list(known_laws()),
        "motions": motions,
    }


@command(app, "check", examples="check bearing.toml", panel=FILES, laws=True)
def _check(
    file: Annotated[
        Path,
        typer.Argument(
            help="TOML file of a bearing, a compound, a case or any other input, or the name of a "
            "built-in bearing, compound or structure."
        ),
    ],
) -> Answer:
    """Validate a file without running it, and summarize its content.

    Values outside the usual range cause warnings, since their unit or sign may be wrong. For a
    bearing, a short test estimates the error of its heat cells.
    """
    from thermobearing.commands.check import cells_facts, check_file, named_file
    from thermobearing.results.screen import print_facts, print_warnings

    path = named_file(file)
    kind, facts, warnings = check_file(path)
    facts |= cells_facts(path) if kind == "bearing" else {}
    print_facts(f"{file}: a valid {kind}", facts)
    print_warnings(warnings, all_of_them=True)
    return {"outcome": "valid", "kind": kind, "file": str(file), "warnings": warnings}


@command(
    app,
    "new",
    fields(
        "bearing.new:new_bearing",
        "compound layers shim plan diameter hole end_plate sealing_plate lead cores confined "
        "end_spreading",
        compound="|Compound: library name, or TOML file of a compound or of a bearing.",
        plan='|Length in the direction of motion and width, "1000x1000mm"; or give --diameter.',
    ),
    examples="new pier-3 --compound natural-rubber --plan 1000x1000mm --layers 20x8mm --shim 3mm "
    "--lead 180mm",
    panel=FILES,
)
def _new(
    name: Annotated[str, typer.Argument(help="Name of the new bearing, or its file: NAME.toml.")],
    options: dict[str, Any],
    output: Annotated[
        Path | None, option("-o", "--output", help="File to write; NAME.toml by default.")
    ],
    overwrite: Overwrite,
    quiet: Annotated[bool, option("-q", "--quiet", help="Print nothing.")],
) -> Answer:
    """Derive a bearing from a compound and its dimensions, and write it as a TOML file."""
    from thermobearing.bearing.library import save_bearing
    from thermobearing.bearing.new import new_bearing
    from thermobearing.bearing.plausible import implausible
    from thermobearing.commands.check import bearing_facts
    from thermobearing.results.screen import print_facts, print_warnings

    place = Path(name)  # a file in another folder, too
    name = place.name.removesuffix(".toml")
    bearing = new_bearing(name, **options)
    target = output or place.with_name(f"{name}.toml")
    save_bearing(bearing, target, overwrite=overwrite)
    unmeasured = _not_measured(bearing)
    if not quiet:
        facts = bearing_facts(bearing)
        if "end_plate" not in options:
            facts["end plates"] += " (assumed; give --end-plate)"
        if unmeasured:
            facts["not measured"] = _rows(unmeasured)
        print_facts(f"{target}: a new bearing", facts)
        print_warnings(implausible(bearing), all_of_them=True)
        echo_written(target)
    last = {"outcome": "completed", "exit_status": 0, "output": str(target)}
    return last | {"not_measured": unmeasured}


def _not_measured(bearing: "Bearing") -> dict[str, str]:
    """Return the sources of numbers that were not measured on this rubber, by dotted key."""
    return {
        key: text
        for key, text in bearing.sources.items()
        if (key.startswith("materials.") and not MEASURED.search(text)) or is_assumed(text)
    }


def _rows(unmeasured: dict[str, str]) -> str:
    """Return a row for each source, the table of its keys written once: "lead.cores, diameter"."""
    keys_of: dict[str, list[str]] = {}
    for key, text in unmeasured.items():
        keys_of.setdefault(text, []).append(key)
    rows = []
    for text, keys in keys_of.items():
        names, last_table = [], ""
        for key in keys:
            table, _, name = key.rpartition(".")
            names.append(name if table == last_table else key)
            last_table = table
        rows.append(f"{', '.join(names)}: {text}")
    return "\n".join(rows)


@command(app, "live", examples="live shen-hdr-bridge -o bearing.html", panel=FILES, laws=True)
def _live(
    bearing: Annotated[
        str | None,
        typer.Argument(
            help="Bearing that the page opens with: library name or TOML file; "
            "shen-hdr-bridge by default.",
            metavar="NAME/FILE",
        ),
    ],
    output: Annotated[
        Path | None, option("-o", "--output", help="HTML file to write; NAME.html by default.")
    ],
    documents: Annotated[
        str | None,
        option(
            "--documents",
            help="Address of the documentation that the page links to, such as ../index.html; "
            "no link by default.",
            metavar="ADDRESS",
        ),
    ],
    overwrite: Overwrite,
    quiet: Annotated[bool, option("-q", "--quiet", help="Print nothing.")],
) -> Answer:
    """Write a page in which tests and bridges are computed by the reader's browser.

    The page is one file of less than 1 MB that needs neither Python nor a network.
    """
    from thermobearing.bearing.library import as_bearing
    from thermobearing.live.page import START, live_page

    opened = as_bearing(bearing or START)
    file = live_page(
        output or Path(f"{opened.name}.html"),
        bearing or START,
        overwrite=overwrite,
        documents=documents or "",
    )
    size = file.stat().st_size
    if not quiet:
        echo_written(file, f" ({megabytes(size)})")
    return {"outcome": "completed", "exit_status": 0, "output": str(file), "bytes": size}


@command(
    app,
    "report",
    examples="report pier --title number=B12-7 --title revision=B",
    panel=FILES,
    laws=True,
)
def _report(
    directory: Annotated[Path, typer.Argument(help="Result directory of an analysis.")],
    title: Title,
    template: Template,
    no_pdf: Annotated[bool, option("--no-pdf", help="Write the HTML page only.", panel=REPORT)],
    xlsx: Workbook,
    no_live: NoLive,
    certificate: Annotated[
        bool,
        option(
            "--certificate",
            help="Write certificate.html and certificate.pdf of a calibration instead: one page "
            "with a place for signatures.",
            panel=REPORT,
        ),
    ],
    overwrite: Annotated[
        bool,
        option(
            "--overwrite",
            help="Accepted as by other commands: documents of a result are always replaced.",
            panel=RESULT,
        ),
    ],
    quiet: Quiet,
) -> Answer:
    """Write report.html and report.pdf of a saved result into its directory."""
    del overwrite  # nothing but documents, which a report makes again from the result
    from thermobearing.border.title import title_given
    from thermobearing.reporting import make_report

    block = title_given(title or [])
    kinds: dict[str, Any] = {"pdf": not no_pdf, "workbook": xlsx, "live": not no_live}
    kinds["certificate"] = certificate
    files = make_report(directory, title=block, template=template, **kinds)
    if not quiet:
        for file in files:
            echo_written(file, f" ({megabytes(file.stat().st_size)})")
    return {"outcome": "completed", "exit_status": 0, "files": [str(file) for file in files]}


@command(app, "verify", examples="verify\nverify --html verify.html", panel=FILES)
def _verify(
    html: Annotated[
        Path | None,
        option("--html", help="Also write the table as one HTML file.", metavar="FILE"),
    ],
    overwrite: Overwrite,
    quiet: Quiet,
) -> Answer:
    """Verify this installation: closed forms, other solvers and programs, a real test.

    Each row states what is compared, against what, the error and its limit. A red row is explained,
    and the exit status is then 1. Finite elements and OpenSees are computed where scikit-fem and
    openseespy are installed, and otherwise compared with stored numbers.
    """
    from thermobearing.border.text_file import write_file
    from thermobearing.report.markdown import check_packages
    from thermobearing.results.screen import say, screen_width, show_table
    from thermobearing.verify import report
    from thermobearing.verify.rows import verify_rows

    if html is not None:
        check_packages()
    begin = time.perf_counter()
    verified = list(verify_rows())
    seconds = time.perf_counter() - begin
    if not quiet:
        show_table(report.screen_table(verified, screen_width()))
        say(report.headline(verified, seconds))
        for sentence in report.explanations(verified):
            say(sentence, "red")
    if html is not None:
        from thermobearing.verify.page import verified_page

        write_file(html, verified_page(verified, seconds), overwrite=overwrite)
        if not quiet:
            echo_written(html)
    return report.verified_summary(verified, seconds)
