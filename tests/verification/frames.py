"""Frames of the tests: tables, and a model of OpenSees."""

from pathlib import Path

# Two piers, one on a footing with springs, one on a rotational spring, a deck and two abutments.
TWO_PIERS = """nodes
node;x [m];z [m];mass [t];inertia [t m^2]
A1;0;9;;
A2;80;9;;
F1;25;-2;200;700
B1;25;0;;
C1;25;4;80;
T1;25;9;120;
F2;55;0;150;
C2;55;3;60;
T2;55;9;120;
D0;0;9;100;
D1;25;9;300;
D2;55;9;300;
D3;80;9;100;
members
from;to;E [GPa];A [m^2];I [m^4]
F1;B1;;;
B1;C1;25;8;1,2
C1;T1;25;8;1,2
F2;C2;25;8;1,2
C2;T2;25;8;1,2
D0;D1;25;6;4
D1;D2;25;6;4
D2;D3;25;6;4
supports
node;x [kN/m];z [kN/m];rotation [kN m/rad]
F1;1,2e6;fixed;2e6
F2;fixed;fixed;1e8
A1;fixed;fixed;fixed
A2;fixed;fixed;fixed
bearings
bearing;lower;upper;count;stiffness [kN/mm]
A1;A1;D0;2;1,5
P1;T1;D1;4;2,0
P2;T2;D2;4;2,0
A2;ground;D3;2;1,5
"""
PIER_PYTHON = '''"""A pier: its nodes (in m), and no more."""
import openseespy.opensees as ops

ops.wipe()
ops.model("basic", "-ndm", 2, "-ndf", 3)
E, other = 2.5e7, 1
E = 2.5e7  # kN/m2
I = 1.503
for tag, *at in []:
    print(tag)
ops.node(7, 0.0, -2.0)
ops.node(70, 0, -2)
ops.node(6, 0, -1, "-mass", 227.5, 227.5, 876.8)
ops.node(5, 0, 0)
ops.node(4, 0, 3.75)
ops.node(3, 0, 8.9)
ops.node(2, 0, 10)
ops.node(1, 0, 10)
ops.fix(70, *[1, 1, 1])
ops.fix(7, 0, 1, 0)
ops.fix(1, 0, 0, 1)
ops.mass(4, 206.3, 206.3, 0.0)
ops.mass(3, 140, 140, 0)
ops.mass(1, 400.0, 400.0, 0)
ops.geomTransf("Linear", 1)
ops.uniaxialMaterial("Elastic", 1, 1.397e6)
ops.uniaxialMaterial("Elastic", 2, 1.725e6)
ops.uniaxialMaterial("Elastic", 3, 13076.5)
ops.element("zeroLength", 10, 70, 7, "-mat", 1, "-dir", 1)
ops.element("zeroLength", 11, 70, 7, "-mat", 2, "-dir", 3)
ops.rigidLink("beam", 7, 6)
ops.rigidLink("beam", 7, 5)
ops.element("elasticBeamColumn", 1, 5, 4, 12.0, E, I, 1, "-mass", 2.0)
ops.element("elasticBeamColumn", 2, 4, 3, 12.0, E, I, 1)
ops.element(
    "elasticBeamColumn", 3, 3, 2, 12.0, E, I, 1
)
ops.element("zeroLength", 20, 2, 1, "-mat", 3, "-dir", 1)
ops.equalDOF(2, 1, 2)
values = ops.eigen("-fullGenLapack", 4)
'''


def rocking_pier_table(force: str = "kN", length: str = "m", scale: float = 1.0) -> str:
    """Return the table of a pier on a footing that slides and rocks.

    `scale`: of these units, kN or m in each, which must be the same for both (as 1000 N and mm).
    """
    squared, fourth = scale**2, scale**4
    lines = [
        *("nodes", f"node,x [{length}],z [{length}],mass [t],inertia [t {length}^2]"),
        f"1,0,0,124,{9000 * squared!r}",
        f"2,0,{6 * scale!r},174,",
        f"3,0,{6 * scale!r},600,",
        *("members", f"from,to,E [{force}/{length}^2],A [{length}^2],I [{length}^4]"),
        f"1,2,{25e6 * scale / squared!r},{8 * squared!r},{1.2 * fourth!r}",
        *(
            "supports",
            f"node,x [{force}/{length}],z [{force}/{length}],rotation [{force} {length}/rad]",
        ),
        f"1,{8e5!r},fixed,{1.5e6 * squared!r}",
        "3,,fixed,fixed",
        *("bearings", f"bearing,lower,upper,count,stiffness [{force}/{length}]"),
        f"G,2,3,1,{2e4!r}",
    ]
    return "\n".join(lines) + "\n"


def pier_table(heights: list[float], masses: list[float], bearing: float = 15.0) -> str:
    """Return a table of a fixed pier with E = 25 GPa and I = 1.2 m4, and a deck of 500 t."""
    nodes = [f"{k},0,{z!r},{m!r}" for k, (z, m) in enumerate(zip(heights, masses, strict=True))]
    members = [f"{k},{k + 1},25,8,1.2" for k in range(len(heights) - 1)]
    lines = [
        *("nodes", "node,x [m],z [m],mass [t]", *nodes, f"deck,0,{heights[-1]!r},500"),
        *("members", "from,to,E [GPa],A [m^2],I [m^4]", *members),
        *("supports", "node,x [kN/m],z [kN/m],rotation [kN m/rad]", "0,fixed,fixed,fixed"),
        *("bearings", "bearing,lower,upper,count,stiffness [kN/mm]"),
        f"G,{len(heights) - 1},deck,3,{bearing / 3!r}",
    ]
    return "\n".join(lines) + "\n"


def written(folder: Path, name: str, text: str) -> Path:
    """Write a file, and return its path."""
    path = folder / name
    path.write_text(text)
    return path
