"""What closing small loops changes on pier P1: `python -m benchmarks.small_loops`.

Prints the table of docs/theory.md, "Small loops": every motion, HDR and LHDR, 23 and -20 degC, the
published law and small loops that close. `--motion NAME/FILE` takes other motions.
"""

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

import thermobearing as tb
from thermobearing.results import drawing

MOTIONS = ("jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2", "jra-ii-i-3")
BEARINGS = ("shen-hdr-bridge", "shen-lhdr-bridge")
AMBIENT = (23.0, -20.0)  # [degC]
CHANGES = {  # column -> title, whether the change is relative, unit
    "bearing_strain_max": ("bearing strain", "%"),
    "bearing_force_max_kN": ("bearing force", "%"),
    "pier_ductility": ("pier ductility", ""),
    "bearing_energy_kN_mm": ("energy of the bearings", "%"),
    "rise": ("rise of the innermost layer", "K"),
}


NESTED = (140.0, 90.0, 120.0, 105.0, 115.0, 110.0, 120.0, 90.0, 140.0, 170.0)  # [mm]


def draw() -> Figure:
    """Draw nested loops of the HDR bridge bearing by both laws."""
    title = "shen-hdr-bridge, 23 degC: nested loops of 140 to 110 mm"
    figure, axes = drawing.panels(1, 2, (9.0, 4.2), title)
    steps = [np.arange(a, b, np.sign(b - a)) for a, b in zip((0.0, *NESTED), NESTED, strict=False)]
    for ax, law in zip(axes, ("published", "closed"), strict=True):
        for path, look in ((np.concatenate([*steps, NESTED[-1:]]), "-"), (np.arange(171.0), ":")):
            model = tb.ModelOptions(small_loops=law)
            element, force = tb.element("shen-hdr-bridge", 23, model=model), []
            for x in path:
                force.append(element.set_trial(float(x), 0.01).force)
                element.commit()
            label = "with reversals" if look == "-" else "without"
            ax.plot(path, force, look, color="C0" if look == "-" else drawing.GREY, label=label)
        ax.legend(loc="upper left", frameon=False)
        drawing.name_axes(ax, "displacement, mm", "force, kN", f'small_loops = "{law}"')
    return figure


def changes(motions: Sequence[str]) -> dict[str, np.ndarray]:
    """Change of each measure by closing small loops, by column; rows are runs."""
    tables = {}
    for law in ("published", "closed"):
        study = tb.bridge(BEARINGS, motions, AMBIENT, model=tb.ModelOptions(small_loops=law))
        warmest = study.dataset["rubber_temperature"].max("step").values[:, -1]
        table = study.table
        tables[law] = table.assign(rise=warmest - table["ambient_degC"])
    published, closed = tables["published"], tables["closed"]
    result = {}
    for name, (_, unit) in CHANGES.items():
        old, new = published[name].to_numpy(float), closed[name].to_numpy(float)
        result[name] = 100.0 * (new / old - 1.0) if unit == "%" else new - old
    runs = published[["bearing", "motion", "ambient_degC"]].astype(str).agg(", ".join, axis=1)
    return {"run": runs.to_numpy(), **result}


def main() -> None:
    """Print the range of each change, with the runs at its ends, and all runs."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.small_loops", description=__doc__)
    parser.add_argument("--motion", action="append", help="name or file; may be repeated")
    arguments = parser.parse_args()
    measured = changes(arguments.motion or MOTIONS)
    print("| by closing small loops | least | most |\n|---|---|---|")
    for name, (title, unit) in CHANGES.items():
        ends = [int(np.argmin(measured[name])), int(np.argmax(measured[name]))]
        cells = [f"{measured[name][k]:+.3g} {unit} ({measured['run'][k]})" for k in ends]
        print(f"| {title} | " + " | ".join(cells) + " |")
    heads = [f"{title} {unit}".strip() for title, unit in CHANGES.values()]
    print("\n| run | " + " | ".join(heads) + " |\n" + "|---" * (len(heads) + 1) + "|")
    for k, run in enumerate(measured["run"]):
        print(f"| {run} | " + " | ".join(f"{measured[name][k]:+.3g}" for name in CHANGES) + " |")


if __name__ == "__main__":
    main()
