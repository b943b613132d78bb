"""Write the plane frame that OpenSees holds as a table for `structures import`."""

import json
import math
import tempfile
from pathlib import Path


def write_frame(ops, path, force="kN", length="m", mass="t"):
    """Write the plane frame that OpenSees holds as a table for `structures import`."""
    with tempfile.TemporaryDirectory() as folder:
        ops.printModel("-JSON", "-file", f"{folder}/model.json")
        model = json.loads(Path(folder, "model.json").read_text())["StructuralAnalysisModel"]
    springs = {m["name"]: m["Epos"] for m in model["properties"]["uniaxialMaterials"]}
    places = {tag: ops.nodeCoord(tag) for tag in ops.getNodeTags()}
    masses = {tag: [ops.nodeMass(tag, d) for d in (1, 2, 3)] for tag in places}
    fixed = {tag: set(ops.getFixedDOFs(tag)) for tag in ops.getFixedNodes()}
    supports = {
        tag: ["fixed" if d in dofs else 0.0 for d in (1, 2, 3)] for tag, dofs in fixed.items()
    }
    ties = {
        frozenset((retained, node)): ops.getConstrainedDOFs(node, retained)
        for node in ops.getConstrainedNodes()
        for retained in ops.getRetainedNodes(node)
    }
    members = [(*pair, "", "", "") for pair, dofs in ties.items() if len(dofs) == 3]
    bearings = []
    for element in model["geometry"]["elements"]:
        first, second = element["nodes"]
        if element["type"].startswith("ElasticBeam"):
            members.append((first, second, element["E"], element["A"], element["Iz"]))
            half = 0.5 * element["massperlength"] * math.dist(places[first], places[second])
            for tag, d in ((first, 0), (first, 1), (second, 0), (second, 1)):
                masses[tag][d] += half
            continue
        values = dict(zip(element["dof"], map(springs.get, element["materials"]), strict=True))
        if frozenset((first, second)) in ties:
            bearings.append((f"line {element['name']}", first, second, 1, values["P"]))
            continue
        node = second if fixed.get(first) == {1, 2, 3} else first  # the other one is the ground
        row = supports.setdefault(node, [0.0, 0.0, 0.0])
        for d, name in enumerate(("P", "Vy", "Mz")):
            if name in values:
                row[d] += values[name]
    used = {tag for row in members for tag in row[:2]} | {t for row in bearings for t in row[1:3]}
    rows = [
        ("nodes",),
        (
            "node",
            f"x [{length}]",
            f"z [{length}]",
            f"mass [{mass}]",
            f"inertia [{mass} {length}^2]",
        ),
        *((tag, *places[tag], masses[tag][0], masses[tag][2]) for tag in sorted(used)),
        ("members",),
        ("from", "to", f"E [{force}/{length}^2]", f"A [{length}^2]", f"I [{length}^4]"),
        *members,
        ("supports",),
        ("node", *(f"{n} [{force}/{length}]" for n in "xz"), f"rotation [{force} {length}/rad]"),
        *((tag, *row) for tag, row in supports.items() if tag in used),
        ("bearings",),
        ("bearing", "lower", "upper", "count", f"stiffness [{force}/{length}]"),
        *bearings,
    ]
    Path(path).write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
