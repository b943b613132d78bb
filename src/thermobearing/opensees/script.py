"""Structures as scripts of OpenSees, in Tcl or Python, on linear or bilinear bearings.

A body is a node with rigid links to the points where masses and connections act; one that stands
on another is held at its foot by stiff springs. Units are kN, m, s, t: in mm, rounding of
the stiff springs would change the periods.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import scipy

from thermobearing.bearing.bilinear import BilinearBearing, load_device
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, printable
from thermobearing.border.text_file import write_file
from thermobearing.core.types import Floats
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.model.earlier import BilinearParameters
from thermobearing.motions.library import load_motion
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.quantities.words import joined
from thermobearing.structure.fields import GROUND
from thermobearing.structure.matrices import build_matrices, hinge_stiffness
from thermobearing.structure.model import (
    DIRECTIONS,
    SOURCE_KINDS,
    BearingLine,
    Body,
    Hinge,
    Spring,
    Structure,
    load_structure,
)
from thermobearing.structure.run import Prepared, prepare_structure

Word = str | int | float
Point = tuple[float, float, float]
Lines = Bearing | BilinearBearing | str | Path
STIFF = 1e6  # of the springs that hold carried bodies, times the stiffest part of the structure
SOFT = 1e-9  # kN/m, kN m: what a bearing has in directions in which it does not shear
RIGID, RIGID_TURNING, LOOSE = 1, 2, 3  # tags of these materials
METRE = 1e3  # mm
FAR = 1e3  # yield rotations to the second point of the envelope of a hinge
SAME, TINY = 1e-6, 1e-30  # of the largest damping: what rounding leaves
TOLERANCE, ITERATIONS = 1e-10, 50  # of Newton's method [m]
LEVEL = ("-orient", 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)  # xara needs it where nodes are apart
UPRIGHT = ("-orient", 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
SIDEWAYS, ROCKING, TWIST = {"x": 1, "y": 2}, {"x": 5, "y": 4}, 6  # degrees of freedom


@dataclass
class _Script:
    """Commands of OpenSees, and the nodes of a structure."""

    structure: Structure
    commands: list[tuple[Word, ...]] = field(default_factory=list)
    nodes: dict[tuple[str, Point], int] = field(default_factory=dict)
    masters: dict[str, int] = field(default_factory=dict)
    mass_damping: float = 0.0  # 1/s
    tag: int = 10

    def add(self, *words: Word) -> None:
        """Add a command."""
        self.commands.append(words)

    def new(self) -> int:
        """Return a tag that nothing has."""
        self.tag += 1
        return self.tag

    def add_node(self, at: Point) -> int:
        """Add a node at a point [mm]; return its tag."""
        tag = self.new()
        self.add("node", tag, *[value / METRE for value in at])
        return tag

    @property
    def directions(self) -> Sequence[str]:
        """Directions in which the structure moves."""
        return DIRECTIONS if self.structure.plan else DIRECTIONS[:1]

    def free_dofs(self, body: Body) -> set[int]:
        """Return the degrees of freedom of the coordinates of a body."""
        dofs = {SIDEWAYS[direction] for direction in self.directions if body.moves}
        dofs |= {ROCKING[direction] for direction in self.directions if body.rotates}
        return dofs | ({TWIST} if body.twists else set())

    def rocks(self, name: str) -> bool:
        """Return whether a body or what carries it rotates."""
        if name == GROUND:
            return False
        body = self.structure.body(name)
        return body.rotates or self.rocks(body.on or GROUND)

    def point(self, name: str, at: Point) -> int:
        """Return the node of a body at a point; a new one is linked to that of the body."""
        while name not in self.masters and name != GROUND:
            name = self.structure.body(name).on or GROUND
        if (name, at) not in self.nodes:
            tag = self.nodes[name, at] = self.add_node(at)
            if name == GROUND:
                self.add("fix", tag, *[1] * 6)
            else:
                self.add("rigidLink", "beam", self.masters[name], tag)
        return self.nodes[name, at]

    def link(self, lower: int, upper: int, materials: dict[int, int], damping: float = 0.0) -> None:
        """Add springs between two nodes, by degree of freedom; dashpots are [s] times them."""
        tag = self.new()
        words: tuple[Word, ...] = ("-mat", *materials.values(), "-dir", *materials)
        rayleigh: tuple[Word, ...] = ("-doRayleigh", 1) if damping else ()
        self.add("element", "zeroLength", tag, lower, upper, *words, *rayleigh, *LEVEL)
        if damping:
            self.add("region", tag, "-ele", tag, "-rayleigh", self.mass_damping, 0.0, damping, 0.0)

    def foot(self, body: Body) -> Point:
        """Return the reference point of a body."""
        return (*self.structure.place(body.name), body.base_height)

    def add_body(self, body: Body) -> None:
        """Add the node of a body that has coordinates.

        Stiff springs to what carries it stand for what it cannot do itself: OpenSees loses the
        motion of nodes that are linked to a node with fixed degrees of freedom.
        """
        if not (free_dofs := self.free_dofs(body)):
            return
        at = self.foot(body)
        lower, tag = self.point(body.on or GROUND, at), self.add_node(at)
        self.masters[body.name] = self.nodes[body.name, at] = tag
        stiff_springs = {}
        for dof in range(1, 7):
            if dof not in free_dofs:
                stiff_springs[dof] = RIGID if dof < 4 else RIGID_TURNING
        self.link(lower, tag, stiff_springs)

    def add_masses(self) -> None:
        """Add the masses at their points."""
        sums: dict[int, Floats] = {}
        for mass in self.structure.masses:
            node = self.point(mass.body, (*self.structure.point(mass), mass.height))
            values = np.zeros(6)
            for direction in self.directions:
                values[SIDEWAYS[direction] - 1] = METRE * mass.mass
                values[ROCKING[direction] - 1] = mass.rotary_inertia / METRE
            values[TWIST - 1] = (mass.twist_inertia or 0.0) / METRE
            sums[node] = sums.get(node, np.zeros(6)) + values
        for node, values in sums.items():
            self.add("mass", node, *values.tolist())

    def add_spring(self, spring: Spring, damping: float) -> None:
        """Add a linear spring, in each of its directions; its dashpot is `damping` [s] times it."""
        structure, tag = self.structure, self.new()
        if spring.stiffness is None:
            size = (spring.rotational_stiffness or 0.0) / METRE
        else:
            size = METRE * spring.stiffness
        self.add("uniaxialMaterial", "Elastic", tag, size)
        if spring.direction == "twist":
            dofs = [TWIST]
        else:
            kind = ROCKING if spring.stiffness is None else SIDEWAYS
            dofs = [kind[axis] for axis in self.directions if spring.direction in (None, axis)]
        at = (*structure.point(spring), spring.height)
        ends = self.point(spring.base, at), self.point(spring.body, at)
        self.link(*ends, dict.fromkeys(dofs, tag), damping)

    def add_hinge(self, hinge: Hinge, damping: float) -> None:
        """Add a hinge that degrades towards its peaks, with the envelope of that of Takeda."""
        tag, moment_ratio = self.new(), 1.0 + hinge.hardening_ratio * (FAR - 1.0)
        moment = hinge.yield_moment / METRE
        envelope = [moment, hinge.yield_rotation, moment_ratio * moment, FAR * hinge.yield_rotation]
        law = (*envelope, *[-value for value in envelope], 1.0, 1.0, 0.0, 0.0)
        self.add("uniaxialMaterial", "Hysteretic", tag, *law, hinge.unloading_exponent)
        at = self.foot(self.structure.body(hinge.body))
        ends = self.point(hinge.base, at), self.point(hinge.body, at)
        dofs = [ROCKING[axis] for axis in self.directions if hinge.direction in (None, axis)]
        self.link(*ends, dict.fromkeys(dofs, tag), damping)

    def end(self, name: str, line: BearingLine) -> int:
        """Return the node of a body where a line acts, on stiff springs if at two heights."""
        x, y = self.structure.point(line)
        along = self.point(name, (x, y, line.height))
        height = line.height if line.height_across is None else line.height_across
        if height == line.height or not self.rocks(name):
            return along
        across, tag = self.point(name, (x, y, height)), self.add_node((x, y, line.height))
        self.add("fix", tag, 0, 0, 1, 1, 1, 1)
        self.link(along, tag, {1: RIGID})
        self.link(across, tag, {2: RIGID})
        return tag

    def add_line(self, line: BearingLine, law: BilinearParameters | None) -> int:
        """Add the bearings of a line as one element, by default springs; return its tag."""
        self.add("#", f"bearing line {printable(line.name)}, {line.count} bearings")
        ends = self.end(line.base, line), self.end(line.body, line)
        if law is None:
            tag = self.new()
            self.add(
                "uniaxialMaterial", "Elastic", tag, METRE * line.count * line.equivalent_stiffness
            )
            self.link(*ends, {SIDEWAYS[direction]: tag for direction in self.directions})
            return self.tag
        # A line of scale s stands for forces of 1 / s^2 and stiffnesses of 1 / s of the bearing.
        force = line.count / line.scale**2
        stiffness = METRE * force * line.scale
        tag = self.new()
        backbone = (stiffness * law.initial, force * law.strength, law.post_yield / law.initial)
        soft: list[Word] = []
        for name in ("-P", "-T", "-My", "-Mz"):
            soft += [name, LOOSE]
        words = ("elastomericBearingPlasticity", tag, *ends, *backbone, 0.0, 1.0, *soft, *UPRIGHT)
        self.add("element", *words)
        return tag

    def add_rigid(self, stiffness: Floats, coordinates: Sequence[str]) -> None:
        """Add the materials of stiff and soft springs."""
        heights = [abs(mass.height) for mass in self.structure.masses]
        heights += [abs(line.height) for line in self.structure.bearings]
        # A stiff spring against rotation must resist a force at the height of the structure.
        arm = max(1.0, *heights)
        turning = np.array([" rotation" in name or " twist" in name for name in coordinates])
        sizes = np.diag(stiffness) / np.where(turning, arm**2, 1.0)
        rigid = METRE * STIFF * float(sizes.max())
        springs = (RIGID, rigid), (RIGID_TURNING, rigid * (arm / METRE) ** 2), (LOOSE, SOFT)
        for tag, size in springs:
            self.add("uniaxialMaterial", "Elastic", tag, size)


def _element_stiffness(structure: Structure) -> list[Floats]:
    """Return the stiffness [n, n] of each spring and of each hinge."""
    none: dict[str, object] = {"springs": (), "hinges": ()}
    elements: list[dict[str, object]] = [{"springs": (spring,)} for spring in structure.springs]
    elements += [{"hinges": (hinge,)} for hinge in structure.hinges]
    stiffness_matrices = []
    for element in elements:
        part = structure.model_copy(update=none | element)
        matrices = build_matrices(part)
        stiffness_matrices.append(matrices.springs + hinge_stiffness(part, matrices))
    return stiffness_matrices


def _damping(prepared: Prepared) -> tuple[float, list[float], float]:
    """Return damping in terms of OpenSees: a [1/s], b of springs and hinges [s], and the error.

    C = a M + sum of b K of springs and hinges, all >= 0, closest to that of the structure in its
    modes; a only for the damping of Shen (2023). The error is relative to the largest damping.
    """
    # Modal damping divided by the frequencies is proportional to the damping ratios, so that the
    # fit gives all modes the same weight.
    shapes = prepared.modes.shapes / np.sqrt(prepared.modes.frequencies)
    source = prepared.structure.damping.kind in SOURCE_KINDS
    matrices = [prepared.matrices.mass * source, *_element_stiffness(prepared.structure)]
    parts = np.column_stack([(shapes.T @ matrix @ shapes).ravel() for matrix in matrices])
    damping = (shapes.T @ prepared.damping @ shapes).ravel()
    factors, _ = scipy.optimize.nnls(parts, damping)
    error = np.abs(parts @ factors - damping).max()
    relative_error = float(error / max(np.abs(damping).max(), TINY))
    return float(factors[0]), factors[1:].tolist(), relative_error


def _laws(
    structure: Structure, bearing: Lines | Sequence[Lines] | None, ambient: float | None
) -> list[BilinearParameters | None]:
    """Return the bilinear law of one bearing of each line; None for the equivalent stiffness."""
    count = len(structure.bearings)
    if bearing is None:
        return [None] * count
    single = isinstance(bearing, Bearing | BilinearBearing | str | Path)
    line_bearings: list[Lines] = [bearing] if single else list(bearing)  # type: ignore[arg-type, list-item]
    if len(line_bearings) == 1:
        line_bearings *= count
    if len(line_bearings) != count:
        raise InputError(
            f"bearings: {len(line_bearings)} for {count} bearing lines; give one, or one for each "
            "line",
            structure.name,
        )
    # Lines usually share a bearing, and its bilinear model takes a cyclic test to find.
    laws: dict[int, BilinearParameters] = {}
    for line_bearing in line_bearings:
        if id(line_bearing) in laws:
            continue
        device = load_device(line_bearing) if isinstance(line_bearing, str | Path) else line_bearing
        if isinstance(device, BilinearBearing):
            laws[id(line_bearing)] = BilinearParameters(
                device.strength, device.post_yield_stiffness, device.initial_stiffness
            )
        else:
            laws[id(line_bearing)] = bilinear_parameters(device, temperature=ambient)
    return [laws[id(line_bearing)] for line_bearing in line_bearings]


def _build(
    prepared: Prepared, laws: Sequence[BilinearParameters | None]
) -> tuple[_Script, list[int], list[str]]:
    """Return a model, the tags of the elements of its lines, and remarks."""
    structure = prepared.structure
    script = _Script(structure)
    script.add("wipe")
    script.add("model", "basic", "-ndm", 3, "-ndf", 6)
    script.add_rigid(prepared.predictor, prepared.matrices.coordinates)
    for body in structure.bodies:
        script.add("#", f"body {printable(body.name)}")
        script.add_body(body)
    script.add("#", "masses, springs and hinges")
    script.add_masses()
    a, dashpots, error = _damping(prepared)
    # Damping that these terms cannot express is replaced by dashpots parallel to springs and
    # hinges; a remark tells the reader.
    if error > SAME:
        a, dashpots, _ = _damping(prepare_structure(structure, damping="element"))
    script.mass_damping = a
    if a:
        script.add("rayleigh", a, 0.0, 0.0, 0.0)
    springs = len(structure.springs)
    for spring, b in zip(structure.springs, dashpots[:springs], strict=True):
        script.add_spring(spring, b)
    for hinge, b in zip(structure.hinges, dashpots[springs:], strict=True):
        script.add_hinge(hinge, b)
    pairs = zip(structure.bearings, laws, strict=True)
    tags = [script.add_line(line, law) for line, law in pairs]
    remarks = []
    if error > SAME:
        remarks.append(
            f'Damping is that of kind = "element", dashpots parallel to springs and hinges, not '
            f'"{structure.damping.kind}" as here'
        )
    if structure.hinges:
        remarks.append(
            "Hinges are of the material Hysteretic, whose inner loops differ from those of Takeda"
        )
    return script, tags, remarks


def _ground_motion_commands(
    motion: GroundMotion | MotionPair | str | Path, file: Path, tags: Sequence[int], components: int
) -> tuple[dict[Path, str], list[tuple[Word, ...]]]:
    """Return files with the ground acceleration, and the commands of a transient analysis."""
    record = load_motion(motion) if isinstance(motion, str | Path) else motion
    if isinstance(record, MotionPair):
        ground = record.rotated()[:, :components]
    else:
        ground = record.acceleration[:, None]
    files: dict[Path, str] = {}
    commands: list[tuple[Word, ...]] = []
    for axis, direction in enumerate(DIRECTIONS[: ground.shape[1]], 1):
        path = file.with_name(f"{file.stem}-{direction}.txt")
        values = [*(ground[:, axis - 1] / METRE).tolist(), 0.0]
        files[path] = "".join(f"{value!r}\n" for value in values)
        series = ("-dt", record.dt, "-filePath", path.name)
        commands.append(("timeSeries", "Path", axis, *series))
        commands.append(("pattern", "UniformExcitation", axis, axis, "-accel", axis))
    for kind, name in (("force", "forces"), ("basicDeformation", "deformations")):
        output = f"{file.stem}-{name}.txt"
        commands.append(("recorder", "Element", "-file", output, "-time", "-ele", *tags, kind))
    commands += [
        ("wipeAnalysis",),
        ("constraints", "Transformation"),
        ("numberer", "RCM"),
        ("system", "UmfPack"),
        ("test", "NormDispIncr", TOLERANCE, ITERATIONS),
        ("algorithm", "Newton"),
        ("integrator", "Newmark", 0.5, 0.25),
        ("analysis", "Transient"),
        ("analyze", len(ground) - 1, record.dt),
    ]
    return files, commands


def _word(word: Word, language: str) -> str:
    """Return a word of a command in a language."""
    if isinstance(word, str) and language == "python":
        return f'"{word}"'
    return word if isinstance(word, str) else repr(float(word) if word % 1 else word)


def _render(commands: Sequence[tuple[Word, ...]], language: str) -> list[str]:
    """Return commands as lines of a language."""
    lines = []
    for name, *words in commands:
        if name == "#":
            lines.append(f"# {words[0]}")
        elif language == "python":
            lines.append(f"ops.{name}({', '.join(_word(word, language) for word in words)})")
        else:
            lines.append(" ".join([str(name), *(_word(word, language) for word in words)]))
    return lines


PERIODS = {
    "python": """values = ops.eigen("-fullGenLapack", {0})
periods = [2.0 * math.pi / value**0.5 for value in values]
print("periods [s]:", *[f"{{one:.6g}}" for one in periods])""",
    "tcl": """set periods {{}}
foreach value [eigen -fullGenLapack {0}] {{
    lappend periods [expr {{2.0 * acos(-1.0) / sqrt($value)}}]
}}
puts "periods \\[s\\]: $periods\"""",
}
ENDS = {
    "python": """if ops.{0} != 0:
    raise SystemExit("OpenSees did not converge")""",
    "tcl": """if {{[{0}] != 0}} {{
    error "OpenSees did not converge"
}}""",
}


def _refuse_devices(structure: Structure) -> None:
    """Raise InputError for what a script does not have, with the numbers to enter it by hand."""
    faults = [
        f"{key}: a script of OpenSees has none; omit {key} of the structure, and add it to the "
        "script"
        for key in ("devices", "p_delta")
        if getattr(structure, key)
    ]
    faults += [
        f"devices: {device.title()}, each with {joined(map(str, device.constants()))}"
        for device in structure.devices or ()
    ]
    if faults:
        raise InputError(faults, structure.name)


@checked
def write_structure(
    structure: Structure | str | Path,
    file: str | Path,
    *,
    bearing: Lines | Sequence[Lines] | None = None,
    ambient: float | None = None,
    motion: GroundMotion | MotionPair | str | Path | None = None,
    overwrite: bool = False,
) -> list[str]:
    """Write a structure as a script of OpenSees, which prints its periods; return remarks.

    Parameters
    ----------
    structure : Structure, str or Path
        A structure, a name of the library, or a TOML file; in one direction or in plan.
    file : str or Path
        Script in Python (`.py`, with openseespy) or Tcl (`.tcl`). Units are kN, m, s.
    bearing : Bearing, BilinearBearing, str, Path or sequence
        One bearing for all lines, or one for each. A bilinear bearing is taken as it is, a layered
        one as the bilinear model of its third cycle at the design strain, without heating. By
        default lines are springs of their equivalent stiffness.
    ambient : float
        Temperature at which layered bearings become bilinear [degC], in [-100, 100]: the coldest
        of a site gives the upper bound, the warmest the lower. By default that of their law.
    motion : GroundMotion, MotionPair, str or Path
        Ground motion, written into text files next to the script, which then analyses it and
        records forces and deformations of the bearing lines. A single record acts along x.
    overwrite : bool
        Replace existing files.

    Returns
    -------
    list of str : what the script does differently from this package (damping, hinges).

    Raises
    ------
    InputError
        Not a script of Python or Tcl, another number of bearings, faults in a file, or a structure
        with devices or P-delta.
    OutputError
        The file exists, or cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     remarks = write_structure("five-span-girder", f"{folder}/girder.tcl")
    >>> remarks
    []
    """
    if not isinstance(structure, Structure):
        structure = load_structure(structure)
    _refuse_devices(structure)
    target = Path(file)
    if target.suffix not in (".py", ".tcl"):
        raise InputError(f"{target}: give a script of Python, .py, or of Tcl, .tcl")
    language = "python" if target.suffix == ".py" else "tcl"
    prepared = prepare_structure(structure)
    script, tags, remarks = _build(prepared, _laws(structure, bearing, ambient))
    about = printable(structure.description)
    title = [f"{printable(structure.name)}: {about}", "Units: kN, m, s, t"]
    lines = [f"# {' '.join(text.split())}." for text in (*title, *remarks)]
    if language == "python":
        lines += ["import math", "", "import openseespy.opensees as ops", ""]
    lines += _render(script.commands, language)
    lines.append(PERIODS[language].format(len(prepared.matrices.coordinates)))
    files: dict[Path, str] = {}
    if motion is not None:
        components = 2 if structure.plan else 1
        files, analysis = _ground_motion_commands(motion, target, tags, components)
        *before, last = _render(analysis, language)
        lines += [*before, ENDS[language].format(last.removeprefix("ops."))]
        lines += _render([("wipe",)], language)
    for path, text in {target: "\n".join(lines) + "\n", **files}.items():
        write_file(path, text, overwrite=overwrite)
    return remarks
