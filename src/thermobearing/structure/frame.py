"""Plane frames of piers and decks, condensed to structures of rigid bodies, with their periods.

What members join is a part. A part with an upright elastic member is a pier, a cantilever on one
support; any other is a deck. Zero-length elements below decks are bearing lines.

* A pier becomes a body that rotates about the top of its footing, on a rotational spring
  F h²/u: F is a force at its highest seat, u the displacement and h the height there. Its mass is
  (s·M·1)²/(s·M·s) at the height h (s·M·s)/(s·M·1), so that the shape s under F (with the
  rotation of the foundation, 1 at the seat) has the mass and the participation that it has in
  the frame. The remainder is at its base.
* Nodes that rigid members join to a support that is not fixed become a footing on the springs of
  the support. Without rotary inertia its rotation is part of the displacement u of the pier.
* A deck becomes a body that moves sideways. Bearing lines keep their places and stiffnesses.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy

from thermobearing.border.errors import InputError, nearest, printable, shortened
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.quantities.governing import largest_by, order_from_largest, place_of_largest
from thermobearing.quantities.tables import Table
from thermobearing.quantities.warned import EXCEEDED, Warned
from thermobearing.results.directory import FRAME_PERIODS, RESOLVED
from thermobearing.results.screen import say, show_table
from thermobearing.results.writing import write_csv
from thermobearing.structure.fields import GROUND
from thermobearing.structure.matrices import Modes, displacement_row
from thermobearing.structure.model import (
    BearingLine,
    Body,
    Mass,
    Reported,
    Spring,
    Structure,
)
from thermobearing.structure.report import frame_table
from thermobearing.structure.result import StructureResult
from thermobearing.structure.run import prepare_structure

METRE = 1e3  # mm; frames are in kN, m, s and t, structures in kN, mm and s
MOST_NODES = 300
LIMIT = 0.05  # relative difference of a period that is warned of
ALIKE = 0.7  # square of the cosine of two shapes from which they are one mode
LOST = 0.02  # share in the mass from which a mode that the structure lacks is warned of
NO_STIFFNESS = 1e-12  # of a motion, relative to that of its coordinates
NO_MASS = 1e-12  # of the longest period squared, likewise
SMALLEST = 1e-3  # mass [t] and height [m]
TINY = 1e-30  # instead of zero in a divisor
FREE = (False, False, False)
WAYS = ("x", "z", "rotation")


class Node(NamedTuple):
    """A node: place [m], masses in x and z [t], rotary inertia [t m²], and its line in the file."""

    x: float
    z: float
    mass: tuple[float, float, float]
    line: str


class Element(NamedTuple):
    """What joins two nodes, or a node and the ground, and its line in the file.

    `stiffness`: EA [kN] and EI [kN m²] of a member; in x and z [kN/m] and against rotation
    [kN m/rad] of a zero-length element; None of a rigid member. `bearings`: their number.
    """

    name: str
    ends: tuple[str, str]
    stiffness: tuple[float, ...] | None
    line: str
    bearings: int = 1

    @property
    def is_elastic(self) -> bool:
        """Whether it is a member that is not rigid."""
        return self.stiffness is not None and len(self.stiffness) < len(WAYS)

    @property
    def is_member(self) -> bool:
        """Whether it is a member, elastic or rigid."""
        return self.stiffness is None or self.is_elastic


@dataclass(frozen=True)
class Frame:
    """A plane frame: `held` has the fixed motions of nodes, `ties` pairs of equal motions."""

    file: str
    nodes: dict[str, Node]
    elements: list[Element]
    held: dict[str, tuple[bool, ...]] = field(default_factory=dict)
    ties: list[tuple[str, str, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Refuse what cannot be a frame."""
        names = [*self.nodes, GROUND]
        used = {name: "equal displacements" for tie in self.ties for name in tie[:2]}
        used |= dict.fromkeys(self.held, "a support")
        used |= {name: element.line for element in self.elements for name in element.ends}
        faults = [
            f'{line}: no node is called "{shortened(name)}"{nearest(name, names)}'
            for name, line in used.items()
            if name not in names
        ]
        for element in [] if faults else self.elements:
            if element.is_member and GROUND in element.ends:
                faults.append(
                    f"{element.line}: {element.name} is on the ground; give it a fixed node"
                )
            elif element.ends[0] == element.ends[1] or (
                element.is_elastic and not np.any(self.span(element))
            ):
                faults.append(f"{element.line}: {element.name} has no length")
        sizes = {element.line: min(element.stiffness or [0.0]) for element in self.elements}
        sizes |= {node.line: min(node.mass) for node in self.nodes.values()}
        faults += [f"{line}: a negative number" for line, size in sizes.items() if size < 0.0]
        if not 2 <= len(self.nodes) <= MOST_NODES:
            faults.append(f"has {len(self.nodes)} nodes; 2 to {MOST_NODES} can be imported")
        if faults:
            raise InputError(faults, self.file)

    def span(self, element: Element) -> Floats:
        """Return the distance of the second node of an element from the first in x and z [m]."""
        first, second = (self.nodes[name] for name in element.ends)
        return np.array([second.x - first.x, second.z - first.z])

    def motions(self, name: str) -> Floats:
        """Return the rows of displacement in x and z and rotation of a node, or of the ground."""
        rows = np.zeros((len(WAYS), len(WAYS) * len(self.nodes)))
        if name != GROUND:
            first = len(WAYS) * list(self.nodes).index(name)
            rows[:, first : first + len(WAYS)] = np.eye(len(WAYS))
        return rows

    def _strains(self, element: Element) -> Floats:
        """Return the rows of extension and rotations of the ends relative to the chord."""
        first, second = (self.motions(name) for name in element.ends)
        relative = second - first
        # Springs, and rigid members between two nodes at one point, have relative motions only.
        if not element.is_member or not (length := np.hypot(*self.span(element))):
            return np.asarray(relative)
        x, z = self.span(element) / length
        chord = (x * relative[1] - z * relative[0]) / length
        return np.array([x * relative[0] + z * relative[1], first[2] - chord, second[2] - chord])

    def only(self, names: Iterable[str], held: Iterable[str] = ()) -> "Frame":
        """Return these nodes and what joins them to each other and the ground; fix `held`."""
        kept = {*names, GROUND}
        fixed = {name: directions for name, directions in self.held.items() if name in kept}
        return replace(
            self,
            nodes={name: node for name, node in self.nodes.items() if name in kept},
            elements=[element for element in self.elements if kept.issuperset(element.ends)],
            held=fixed | dict.fromkeys(held, (True, True, True)),
            ties=[tie for tie in self.ties if kept.issuperset(tie[:2])],
        )

    @cached_property
    def mass(self) -> Floats:
        """Return the mass of each coordinate."""
        return np.array([node.mass for node in self.nodes.values()]).ravel()

    @cached_property
    def _stiffness(self) -> tuple[Floats, Floats]:
        """Return the stiffness of the motions that supports and rigid members allow, and these.

        A coordinate that nothing resists, as the rotation of a node on bearings, is at rest.
        """
        count = len(self.mass)
        stiffness, bound = np.zeros((count, count)), [np.zeros(count)]
        for element in self.elements:
            rows = self._strains(element)
            if element.stiffness is None:
                bound += [*rows]
            elif element.is_member:
                axial, bending = np.array(element.stiffness) / np.hypot(*self.span(element))
                law = [[axial, 0, 0], [0, 4 * bending, 2 * bending], [0, 2 * bending, 4 * bending]]
                stiffness += rows.T @ np.array(law) @ rows
            else:
                stiffness += rows.T @ (np.array(element.stiffness)[:, None] * rows)
        for name, directions in self.held.items():
            bound += [*self.motions(name)[list(directions)]]
        bound += [(self.motions(a) - self.motions(b))[k] for a, b, k in self.ties]
        # A coordinate that nothing stiffens and nothing binds would look like a mechanism.
        loose = ~(np.any(bound, axis=0) | stiffness.any(axis=0))
        allowed = scipy.linalg.null_space(np.array([*bound, *np.eye(count)[loose]]))
        # Of unit stiffness each, so that an eigenvalue near zero is a mechanism in any unit.
        allowed /= np.sqrt(np.diag(allowed.T @ stiffness @ allowed).clip(TINY))
        reduced = allowed.T @ stiffness @ allowed
        values, shapes = scipy.linalg.eigh(reduced) if len(reduced) else ([1.0], reduced)
        if values[0] <= NO_STIFFNESS:
            node, direction = divmod(place_of_largest(np.abs(allowed @ shapes[:, 0])), len(WAYS))
            raise InputError(
                f"is a mechanism: nothing resists a motion of node {list(self.nodes)[node]} "
                f"({WAYS[direction]}); add the support, spring or member that does",
                self.file,
            )
        return reduced, allowed

    def displacement(self, name: str) -> Floats:
        """Return the displacements under a horizontal force of 1 kN at a node."""
        reduced, allowed = self._stiffness
        return np.asarray(allowed @ np.linalg.solve(reduced, allowed.T @ self.motions(name)[0]))

    def modes(self) -> Modes:
        """Return the natural modes with unit modal mass."""
        reduced, allowed = self._stiffness
        # Mass by stiffness, not the inverse: a motion without mass has the square of a period,
        # zero.
        squares, shapes = scipy.linalg.eigh(allowed.T @ (self.mass[:, None] * allowed), reduced)
        kept = np.flatnonzero(squares > NO_MASS * squares.max(initial=0.0))[::-1]
        roots = np.sqrt(squares[kept])
        return Modes(1.0 / roots, allowed @ shapes[:, kept] / roots)


def _label(frame: Frame, members: Iterable[Element]) -> dict[str, int]:
    """Return a number for each node, the same for nodes that members join."""
    numbers = {name: k for k, name in enumerate(frame.nodes)}
    graph = np.zeros((len(numbers), len(numbers)))
    for member in members:
        graph[numbers[member.ends[0]], numbers[member.ends[1]]] = 1.0
    return dict(
        zip(
            numbers,
            scipy.sparse.csgraph.connected_components(graph, directed=False)[1].tolist(),
            strict=True,
        )
    )


def _find_parts(frame: Frame) -> dict[str, list[str]]:
    """Return the nodes of the ground, of each pier and of each deck, by name."""
    members = [member for member in frame.elements if member.is_member]
    labels = _label(frame, members)
    elastic = [member for member in members if member.is_elastic]
    upright = {
        labels[member.ends[0]] for member in elastic if np.diff(np.abs(frame.span(member))) > 0.0
    }
    joined = {name for member in members for name in member.ends}
    fixed = [
        name for name, directions in frame.held.items() if all(directions) and name not in joined
    ]
    parts = {GROUND: [GROUND, *fixed]}
    for kind in ("pier", "deck"):
        part_labels = [
            k for k in dict.fromkeys(labels.values()) if (k in upright) == (kind == "pier")
        ]
        groups = [[name for name in labels if labels[name] == k] for k in part_labels]
        groups = [part for part in groups if part[0] not in fixed]
        groups.sort(key=lambda part: min(frame.nodes[name].x for name in part))
        for k, part in enumerate(groups, 1):
            parts[kind if len(groups) == 1 else f"{kind} {k}"] = part
    return parts


def _find_lines(frame: Frame, bodies: dict[str, str]) -> list[tuple[Element, str, str]]:
    """Return the bearing lines with their lower and upper nodes."""
    lines = []
    for element in frame.elements:
        lower, upper = sorted(element.ends, key=lambda name: bodies[name].startswith("deck"))
        below, above = bodies[lower], bodies[upper]
        if element.is_member or (GROUND in (below, above) and not above.startswith("deck")):
            continue
        if below.startswith("deck") or not above.startswith("deck"):
            raise InputError(
                f"{element.line}: {element.name} joins {below} and {above}; a zero-length "
                "element is between a deck and a pier, or between one of these and the ground",
                frame.file,
            )
        if element.stiffness and element.stiffness[0] > 0.0:
            lines.append((element, lower, upper))
    for a, b, k in frame.ties:
        if WAYS[k] == "x" and bodies[a] != bodies[b]:
            raise InputError(f"nodes {a} and {b} move equally in x: no bearing acts", frame.file)
    if not lines:
        raise InputError("has no zero-length element below a deck, a bearing line", frame.file)
    return lines


class _Pier(NamedTuple):
    """A pier of a frame in numbers: nodes, flexibility [rad/(kN m)], mass and its height."""

    foot: str  # the supported node
    base: str  # the top of the footing
    block: list[str]  # nodes of the footing
    rocks: bool  # whether the footing has a rotation of its own
    soil: Floats  # stiffness of the support in x, z and against rotation
    flexibility: float
    mass: float  # effective
    height: float  # of this mass above the base
    base_mass: float


def _examine_pier(
    frame: Frame, name: str, part: list[str], ground: list[str], seats: list[str]
) -> _Pier:
    """Return a pier in numbers; see the docstring of the module."""
    alone, nodes = frame.only([*part, *ground]), frame.nodes
    springs = [element for element in alone.elements if not element.is_member]
    feet = {node for node in part if any(frame.held.get(node, FREE))}
    feet |= {end for spring in springs for end in spring.ends if end in part}
    if len(feet) != 1 or not seats:
        raise InputError(
            f"{name} (nodes {shortened(', '.join(part))}) has {len(feet)} supported nodes and "
            f"{len(seats)} bearing lines; a pier is a cantilever on one supported node, with a "
            "bearing line, joined to decks by zero-length elements only",
            frame.file,
        )
    (foot,) = feet
    # The footing is what rigid members join to the supported node; columns begin on it.
    rigid = _label(alone, [element for element in alone.elements if element.stiffness is None])
    block = [node for node in part if rigid[node] == rigid[foot]]
    elastic = [element for element in alone.elements if element.is_elastic]
    starts = [end for element in elastic for end in element.ends if end in block]
    base = max(starts, key=lambda node: nodes[node].z)
    seat = max(seats, key=lambda node: nodes[node].z)
    height = nodes[seat].z - nodes[base].z
    rocks = not frame.held.get(foot, FREE)[2] and any(nodes[node].mass[2] for node in block)
    shape, along = alone.displacement(seat), np.tile([1.0, 0.0, 0.0], len(alone.nodes))
    # Relative to what carries the pier, whose motion is another coordinate.
    shape = shape - (alone.motions(base if rocks else foot)[0] @ shape) * along
    bent = reach = alone.motions(seat)[0] @ shape
    if rocks:  # the rotation of the footing is one of its own
        fixed = frame.only(part, block)
        bent = fixed.motions(seat)[0] @ fixed.displacement(seat)
    if not (height > SMALLEST and bent > 0.0 and reach > 0.0):
        fault = f"{name} has no bearing line that moves above its base, node {base}"
        raise InputError(fault, frame.file)
    shape = shape / reach
    mass = alone.mass * np.repeat(
        [node in part and node not in block for node in alone.nodes], len(WAYS)
    )
    # The effective mass and its height give the pier the mass and the moment that its first shape
    # has.
    modal, share = mass @ np.square(shape), mass @ (along * shape)
    if not share > 0.0:
        raise InputError(f"{name} has no mass above its base, node {base}", frame.file)
    soil = np.sum([np.zeros(3), *(np.array(spring.stiffness) for spring in springs)], axis=0)
    effective = share**2 / modal
    return _Pier(
        foot=foot,
        base=base,
        block=block,
        rocks=rocks,
        soil=soil,
        flexibility=bent / height**2,
        mass=effective,
        height=height * modal / share,
        base_mass=mass @ along - effective,
    )


def _place_pier(
    frame: Frame, name: str, pier: _Pier
) -> tuple[list[Body], list[Mass], list[Spring]]:
    """Return a pier as bodies with masses and springs, with a footing if the support moves."""
    nodes, side, rocks = frame.nodes, frame.held.get(pier.foot, FREE)[0], pier.rocks
    foot, base = METRE * nodes[pier.foot].z, METRE * nodes[pier.base].z
    block = [nodes[node_name] for node_name in pier.block]
    below = GROUND if side and not rocks else name.replace("pier", "footing")
    at = {"x": METRE * nodes[pier.base].x}
    masses = _mass(name, pier.mass, base + METRE * pier.height) + _mass(name, pier.base_mass, base)
    for node in block:
        at_foot = below, node.mass[0], METRE * node.z, node.mass[2]
        masses += _mass(name, node.mass[0], base) if below == GROUND else _mass(*at_foot)
    bodies, springs = [], []
    if below != GROUND:
        on = GROUND if side else None
        bodies = [Body(name=below, base_height=foot, on=on, moves=not side, rotates=rocks, **at)]
    if not side:
        stiffness, spring_name = pier.soil[0] / METRE, f"{below}, sideways"
        springs.append(Spring(name=spring_name, body=below, height=foot, stiffness=stiffness))
    if rocks:
        stiffness, spring_name = METRE * pier.soil[2], f"{below}, rocking"
        springs.append(Spring(name=spring_name, body=below, rotational_stiffness=stiffness))
    stiffness, spring_name = METRE / pier.flexibility, f"{name}, bending"
    springs.append(Spring(name=spring_name, body=name, base=below, rotational_stiffness=stiffness))
    bodies.append(Body(name=name, base_height=base, on=below, rotates=True, **at))
    return bodies, masses, springs


def _mass(body: str, mass: float, height: float, inertia: float = 0.0) -> list[Mass]:
    """Return a mass [t, t m²] of a body at a height [mm]; nothing if it is zero."""
    values = {"mass": mass / METRE, "rotary_inertia": METRE * inertia}
    return [Mass(body=body, height=height, **values)] if mass > SMALLEST else []


def _place_deck(
    frame: Frame, name: str, part: list[str]
) -> tuple[list[Body], list[Mass], list[Spring]]:
    """Return a deck as a body with its mass."""
    nodes = [frame.nodes[node_name] for node_name in part]
    masses = [node.mass[0] for node in nodes]
    stuck = [node_name for node_name in part if frame.held.get(node_name, FREE)[0]]
    if stuck or sum(masses) < SMALLEST:
        fault = f"is fixed in x at node {stuck[0]}" if stuck else "has no mass"
        raise InputError(
            f"{name} (nodes {shortened(', '.join(part))}) {fault}; nodes without an upright member "
            "are a deck, which moves on bearing lines",
            frame.file,
        )
    x, z = (METRE * float(np.average([node[k] for node in nodes], weights=masses)) for k in (0, 1))
    return [Body(name=name, moves=True, x=x)], _mass(name, sum(masses), z), []


def _condense(frame: Frame) -> tuple[Structure, dict[str, str]]:
    """Return the structure that a frame becomes, and the body of each node."""
    parts = _find_parts(frame)
    body_of_node = {node: name for name, part in parts.items() for node in part}
    lines, ground, nodes = _find_lines(frame, body_of_node), parts.pop(GROUND), frame.nodes
    placed = []
    for name, part in parts.items():
        if name.startswith("deck"):
            placed.append(_place_deck(frame, name, part))
        else:
            seats = [lower for _, lower, _ in lines if lower in part]
            pier = _examine_pier(frame, name, part, ground, seats)
            placed.append(_place_pier(frame, name, pier))
            # Nodes of a footing belong to it, or to the ground where it does not move.
            body_of_node |= dict.fromkeys(pier.block, placed[-1][0][-1].on or GROUND)
    bodies, masses, springs = (list(chain(*column)) for column in zip(*placed, strict=True))
    bearings = []
    for element, lower, upper in lines:
        node = nodes[upper if body_of_node[lower] == GROUND else lower]
        fields: dict[str, Any] = {"height": METRE * node.z, "x": METRE * node.x}
        fields |= {
            "body": body_of_node[upper],
            "base": body_of_node[lower],
            "count": element.bearings,
        }
        size = element.stiffness[0] / element.bearings / METRE if element.stiffness else 0.0
        bearings.append(BearingLine(name=element.name, equivalent_stiffness=size, **fields))
    deck = largest_by(
        [mass for mass in masses if mass.body.startswith("deck")], lambda mass: mass.mass
    )
    report = {"deck": deck.body}
    if on_piers := [line for line in bearings if line.base != GROUND]:
        name = min(on_piers, key=lambda line: line.body != deck.body).base
        (base,) = (body.on for body in bodies if body.name == name)
        top = max(line.height for line in on_piers if line.base == name)
        report |= {"pier": name, "pier_base": base, "pier_top": top}
    path = Path(frame.file)
    structure = Structure(
        name=printable(path.stem)[:60],
        description=f"Imported from the frame in {printable(path.name)}",
        bodies=bodies,
        masses=masses,
        springs=springs,
        bearings=bearings,
        report=Reported(**report),
    )
    return structure, body_of_node


class ImportedFrame(StructureResult):
    """A structure that a frame was condensed to, and its periods compared with those of the frame.

    Attributes
    ----------
    frame : Frame
        Nodes and elements of the file, in kN, m, s and t.
    bodies : dict
        Body of each node of the frame.
    periods : DataFrame
        One row per mode of the structure, with the mode of the frame whose shape is closest, and
        per other mode of the frame with more than 2 % of the mass: both periods [s], the relative
        difference, and the shares in the mass.
    """

    title = "Imported frame"
    _figures = "FrameFigures"

    def __init__(self, frame: Frame) -> None:
        try:
            structure, self.bodies = _condense(frame)
            super().__init__(prepare_structure(structure), "consistent")
        except InputError as error:  # of a part of the structure
            raise InputError(error.problems, frame.file) from None
        self.frame = frame
        self.periods = self._compare()

    def _compare(self) -> "pd.DataFrame":
        """Return the modes of the structure and the frame, paired by their shapes."""
        frame, modes, motions = self.frame, self.frame.modes(), []
        for name, node in frame.nodes.items():
            body, z = self.bodies[name], METRE * node.z
            at, above = (displacement_row(self.structure, body, z + h) for h in (0, 1))
            motions += [at / METRE, 0.0 * at, at - above]  # rotations have the other sign
        structure_shapes = np.array(motions) @ self.prepared.modes.shapes
        frame_shapes, mass = modes.shapes, frame.mass
        sizes = [mass @ np.square(shapes) for shapes in (structure_shapes, frame_shapes)]
        # Modal assurance criterion with the mass of the frame: squares of cosines.
        inner_products = structure_shapes.T @ (mass[:, None] * frame_shapes)
        similarity = np.square(inner_products) / np.outer(*sizes).clip(TINY)
        # Modes of the frame that those of the structure describe together.
        described = similarity.sum(axis=0) > ALIKE
        matches: dict[int, int] = {}  # modes of the frame, by those of the structure
        for k, period in enumerate(self.prepared.modes.periods):
            is_close = np.abs(modes.periods / period - 1.0) < LIMIT
            fits = (similarity[k] > ALIKE) | (described & is_close)  # equal piers mix their shapes
            fits[list(matches.values())] = False
            if fits.any():
                matches[k] = place_of_largest(np.where(fits, similarity[k], -1.0))
        mass, frame_shapes = (values[:: len(WAYS)] for values in (mass, frame_shapes))
        shares = np.square(mass @ frame_shapes) / mass.sum()
        frame_modes = pd.DataFrame(
            {"frame_period_s": modes.periods, "frame_effective_mass": shares}
        )
        frame_modes = frame_modes[frame_modes.index.isin(matches.values()) | (shares > LOST)]
        table = self.table[["mode", "period_s", "effective_mass"]]
        # Modes without a counterpart get negative numbers, which join nothing.
        table = table.set_index(pd.Index([matches.get(k, -1 - k) for k in range(len(table))]))
        periods = table.join(frame_modes, how="outer").sort_values("mode", kind="stable")
        periods["period_difference"] = periods["period_s"] / periods["frame_period_s"] - 1.0
        order = order_from_largest(periods["period_s"].fillna(periods["frame_period_s"]))
        return periods.iloc[order].reset_index(drop=True)

    @property
    def warnings(self) -> list[str]:
        """Implausible numbers, and what the structure does not have of the frame."""
        messages = list(super().warnings)
        for row in self.periods.to_dict("records"):
            period, frame_period = row["period_s"], row["frame_period_s"]
            difference = row["period_difference"]
            share, frame_share = row["effective_mass"], row["frame_effective_mass"]
            if abs(difference) > LIMIT:
                text = (
                    f"The period of {period:.3g} s is {frame_period:.3g} s in the frame "
                    f"({difference:+.0%}; limit {LIMIT:.0%}): this mode bends the piers, which are "
                    "rigid here"
                )
                messages.append(Warned(text, "other_period", EXCEEDED))
            elif np.isnan(period):
                text = (
                    f"The mode of the frame at {frame_period:.3g} s, with {frame_share:.0%} of the "
                    "mass, is not in the model: it bends piers or decks, which are rigid here"
                )
                messages.append(Warned(text, "lost_mode", EXCEEDED))
            elif np.isnan(frame_period) and share > LOST:
                words = f"with {share:.1%} of the mass, has no counterpart in the frame"
                messages.append(Warned(f"The mode at {period:.4g} s, {words}", "added_mode"))
        return messages

    def tables(self) -> dict[str, Table]:
        """Return the parts, the modes, and the comparison of periods."""
        return super().tables() | {"frame": frame_table(self.periods)}

    def show(self) -> None:
        """Print the structure, its modes, and the comparison of periods."""
        super().show()
        show_table(self.tables()["frame"])
        say(f"Damping ratios are zero and piers elastic: complete {RESOLVED} where needed.")

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        periods = self.periods.to_dict("records")
        return super().summary() | {"command": "structures import", "frame": periods}

    def _write(self, folder: Path) -> None:
        super()._write(folder)
        write_csv(folder / FRAME_PERIODS, self.periods)
