"""Table of a sequence on the terminal."""

from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.sequences.result import SequenceResult

SHOWN = {  # column of the table: head, digits
    "displacement_end_mm": ("to mm", "{:.1f}"),
    "displacement_max_mm": ("max mm", "{:.1f}"),
    "force_start_kN": ("from kN", "{:.0f}"),
    "force_max_kN": ("max kN", "{:.0f}"),
    "energy_kN_mm": ("kN mm", "{:.0f}"),
}


def print_sequence(result: SequenceResult) -> None:
    """One row a part; inner layer and lead at its start and end."""
    case, rows = result.case, result.table
    say(f"{case.name}: {case.bearing.name}", "bold")
    print_warnings(result.warnings)
    stems = [name.removesuffix("_start_degC") for name in map(str, rows) if "_start_degC" in name]
    rubber = [stem for stem in stems if stem.startswith("rubber")][-1:]
    warm = rubber + [stem for stem in stems if stem == "lead"]
    heads = ["part", *(head for head, _ in SHOWN.values())]
    heads += [f"{stem.replace('rubber', 'layer ')} degC" for stem in warm]
    untested = rows["beyond_tested"].any() if "beyond_tested" in rows else False
    heads += ["not tested"] if untested else []
    cells = [
        (
            str(row["part"]),
            *(form.format(row[name]) for name, (_, form) in SHOWN.items()),
            *(f"{row[f'{s}_start_degC']:.1f} > {row[f'{s}_end_degC']:.1f}" for s in warm),
            *([str(row["beyond_tested"])] if untested else []),
        )
        for row in rows.to_dict("records")
    ]
    styles = ["" if outcome == "completed" else "red" for outcome in rows.get("outcome", [])]
    print_table(heads, cells, styles=styles)
