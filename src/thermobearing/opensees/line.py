"""`thermobearing.opensees.serve`: bearings as elements of an OpenSees model in the same script."""

import json
import math
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn, Self, Unpack

from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, ThermobearingError, short_repr
from thermobearing.model.axial import Joint
from thermobearing.model.element import DEFAULT_AMBIENT
from thermobearing.model.handover import SpecimenState
from thermobearing.model.options import ModelKeywords, ModelOptions, model_table
from thermobearing.opensees.case import Axial, Layout, ServedCase, UnitNames, make_served_case
from thermobearing.opensees.recording import JOURNAL, Journal, Served
from thermobearing.opensees.result import ServedResult
from thermobearing.opensees.wire import Setup

ANSWER = 60.0  # longest time for an answer of the server [s]
READY = 300.0  # for its start, and for an element: kernels may be compiled [s]
# Elastomeric bearings of OpenSees in space, as `eleType` names them.
REPLACEABLE = (
    "ElastomericBearingPlasticity3d",
    "ElastomericBearingBoucWen3d",
    "ElastomericX",
    "LeadRubberX",
    "HDR",
)
Pair = tuple[int, int]


class ServingError(ThermobearingError):
    """An element could not be served to the end; the result holds what was served."""


@checked
class Line:
    """Served bearings: elements for OpenSees, and their result.

    Made by `serve`; a context manager, at whose end the server ends. Elements that OpenSees still
    has then receive NaN.

    Parameters
    ----------
    case : what is served, with its units.

    Examples
    --------
    >>> with serve("shen-hdr-bridge", ambient=-20) as line:
    ...     line.case.ambient
    -20.0
    """

    def __init__(self, case: ServedCase) -> None:
        self.case = case
        self._layouts: dict[int, tuple[Layout, int]] = {}
        self._histories: list[Served] | None = None  # histories, once the server has sent them
        self._problems_and_notes: tuple[list[str], list[str]] = ([], [])
        self._interrupted = False
        self._lock = threading.Lock()
        self._folder = tempfile.TemporaryDirectory(prefix="thermobearing-")  # of the journal
        self._process = _start_server()
        self._answers: queue.SimpleQueue[Any] = queue.SimpleQueue()
        threading.Thread(target=self._read_answers, daemon=True).start()
        try:
            self._send((case, self._folder.name))
            self._take(READY)
        except BaseException:
            self._end_server()
            raise
        _RUNNING.add(self)
        _set_call_restart(True)

    def __repr__(self) -> str:
        name, state = self.case.bearing.name, "ended" if self._closed else "running"
        return f"<Line of {name}, {len(self._layouts)} elements, {state}>"

    def element(
        self,
        tag: int,
        nodes: Pair | Sequence[Pair],
        directions: int | Sequence[int] = (1,),
        *,
        vertical: int | None = None,
        size: int = 0,
    ) -> tuple[Any, ...]:
        """Return the arguments of `ops.element` for a bearing between two nodes.

        Parameters
        ----------
        tag : of the element, a positive integer. A tag that is used again after `wipe` or `remove`
            begins a new history.
        nodes : lower and upper node, at the same place; or several such pairs, whose bearings form
            one element, which is quicker than an element for each.
        directions : degrees of freedom in which the bearing shears, one or two of 1, 2 and 3; with
            two, hysteresis and heat are those of the plane.
        vertical : the vertical one of the degrees of freedom 1, 2 and 3 of nodes with six. The
            element then has vertical, rotational and torsional springs (`linear_stiffness`) and,
            with one of `directions`, a linear spring in the other horizontal direction. By default
            it has the springs of `directions` only. With `axial = "node"` it is needed, its
            positive side is up, and the vertical spring follows the axial force.
        size : least length of a message [doubles], OpenSees' dataSize.

        Returns
        -------
        tuple : pass it on at once, ``ops.element(*line.element(...))``.

        Raises
        ------
        InputError : tag, nodes or directions that cannot be used.
        ServingError : the server has ended.

        Examples
        --------
        >>> with serve("shen-hdr-bridge", ambient=-20, count=5) as line:
        ...     arguments = line.element(tag=101, nodes=(11, 21))
        >>> arguments[:9]
        ('genericClient', 101, '-node', 11, 21, '-dof', 1, '-dof', 1)
        """
        pairs = _pairs(nodes)
        if not isinstance(tag, int) or isinstance(tag, bool) or not 0 < tag < 2**31:
            raise InputError(f"element(): tag = {tag!r}: must be a positive integer")
        layout = Layout.of(len(pairs), directions, vertical, "element()")
        registered_layout, port = self._layouts.get(tag, (layout, 0))
        if registered_layout != layout:
            raise InputError(
                f"element(): tag = {tag}: had other nodes or directions in this line; use another "
                "tag"
            )
        self.case.check_layout(layout, "element()")
        if not port:
            port = self._ask("listen", layout, tag, limit=READY)
            self._layouts[tag] = layout, port
        ends = [node for pair in pairs for node in pair]
        dofs = [word for _ in ends for word in ("-dof", *layout.dofs)]
        length = Setup.smallest(layout.size, size).size
        return (
            *("genericClient", tag, "-node", *ends, *dofs, "-server", port, "127.0.0.1"),
            *("-dataSize", length, "-noRayleigh"),
        )

    def reset(self) -> None:
        """Put all bearings at the start, as after `ops.reset()`, which does so by itself."""
        self._ask("reset")

    def check(self) -> None:
        """Raise an error if an element could not be served.

        Raises
        ------
        ServingError : all problems since the start, in one message.
        """
        if not self._closed:
            self._problems_and_notes = self._ask("problems")
        if self._problems_and_notes[0]:
            raise ServingError("\n".join(self._problems_and_notes[0]))

    def results(self) -> ServedResult:
        """Return the histories of all elements so far, also after the end of the line.

        Raises
        ------
        InputError : no element has been connected.
        ServingError : the server was killed, or no element could be served.
        """
        if not self._closed:
            self._fetch()
        if not self._histories:
            self.check()
        if self._histories is None:
            raise ServingError("the server of the bearings ended before it sent its histories")
        problems, notes = self._problems_and_notes
        result = ServedResult.of(self.case, self._histories, problems, notes)
        result.dataset.attrs["interrupted"] = int(self._interrupted)
        return result

    def close(self) -> None:
        """End the server; the result remains."""
        if self._closed:
            return
        try:
            self._fetch()
        finally:
            self._end_server()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._interrupted = kind is KeyboardInterrupt
        try:
            self.close()
            self.check()
        except ServingError as problem:
            if error is None:
                raise
            error.add_note(str(problem))

    @property
    def _closed(self) -> bool:
        return self._process.stdin is None or self._process.stdin.closed

    def _send(self, message: Any) -> None:
        assert self._process.stdin is not None
        # A server that has ended is reported by `_take`, with its exit status.
        with suppress(BrokenPipeError):
            pickle.dump(message, self._process.stdin)
            self._process.stdin.flush()

    def _read_answers(self) -> None:
        """Pass answers of the server on; None at its end."""
        answers = self._process.stdout
        assert answers is not None
        with answers, suppress(EOFError, OSError, ValueError, pickle.UnpicklingError):
            while True:
                self._answers.put((pickle.load(answers),))
        self._answers.put(None)

    def _take(self, limit: float) -> Any:
        try:
            reply = self._answers.get(timeout=limit)
        except queue.Empty:
            self._fail(f"does not answer within {limit:g} s; it was ended")
        if reply is None:
            self._fail("has ended (exit status {0})")
        (answer,) = reply
        if isinstance(answer, Exception):
            raise answer
        return answer

    def _fail(self, reason: str) -> NoReturn:
        """End the server, and take the histories that it has left in its journal."""
        self._end_server(self._read_journal)
        text = (
            f"the server of the bearings {reason.format(self._process.returncode)}; results() has "
            "the steps that it had written. Elements that it served receive NaN: start a new line "
            "and a new model"
        )
        self._problems_and_notes = [text], []
        raise ServingError(text) from None

    def _read_journal(self) -> None:
        """Take the histories of a server that has ended."""
        with suppress(OSError), Path(self._folder.name, JOURNAL).open("rb") as file:
            self._histories = Journal(file).histories()

    def _fetch(self) -> None:
        """Take histories, problems and notes from the server."""
        self._histories, self._problems_and_notes = self._ask("histories"), self._ask("problems")

    def _ask(self, *command: Any, limit: float = ANSWER) -> Any:
        if self._closed:
            raise ServingError("the server of the bearings has ended")
        with self._lock:
            self._send(command)
            return self._take(limit)

    def _end_server(self, read_journal: Callable[[], None] = lambda: None) -> None:
        """End the server, if need be by force, and remove its journal."""
        _RUNNING.discard(self)
        if not _RUNNING:
            _set_call_restart(False)
        if not self._closed:
            assert self._process.stdin is not None
            with suppress(OSError):
                self._process.stdin.close()
        try:
            self._process.wait(5.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        read_journal()
        self._folder.cleanup()


def _pairs(nodes: Any) -> list[Pair]:
    """Return the pairs of nodes of an element."""
    try:
        node_pairs = [nodes] if isinstance(nodes[0], int) else list(nodes)
        pairs = [(int(lower), int(upper)) for lower, upper in node_pairs]
    except (TypeError, ValueError, IndexError):
        raise InputError(
            f"element(): nodes = {nodes!r}: must be a pair of node tags, or several pairs"
        ) from None
    ends = [node for pair in pairs for node in pair]
    if len(set(ends)) < len(ends):
        raise InputError(f"element(): nodes = {nodes!r}: a node occurs twice")
    return pairs


_RUNNING: set[Line] = set()


def _set_call_restart(restart: bool) -> None:
    """Choose whether system calls go on after Ctrl-C; OpenSees loses bytes of those that do not."""
    if hasattr(signal, "siginterrupt"):  # not on Windows
        signal.siginterrupt(signal.SIGINT, not restart)


def _start_server() -> "subprocess.Popen[bytes]":
    """Start the server as a process that does not receive the Ctrl-C of this one."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    detached: dict[str, Any] = {"start_new_session": True}
    if sys.platform == "win32":
        detached = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    return subprocess.Popen(
        [sys.executable, "-m", "thermobearing.opensees.server"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment,
        **detached,
    )


@checked
def serve(
    bearing: Bearing | str | Path,
    ambient: float = DEFAULT_AMBIENT,
    *,
    count: int = 1,
    units: UnitNames = "kN-mm",
    axial: Axial | None = None,
    joint: Joint | None = None,
    dowel_length: float | None = None,
    rate: float | None = None,
    initial: float | SpecimenState | None = None,
    model: ModelOptions | str | None = None,
    **options: Unpack[ModelKeywords],
) -> Line:
    """Serve a bearing to OpenSees models of this script, as elements.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    ambient : ambient temperature [degC], in [-100, 100].
    count : number of equal bearings that an element stands for, in [1, 1000].
    units : force and length of the model, "kN-mm" (default), "kN-m", "N-mm", "N-m", "MN-m",
        "kip-in" or "lbf-in"; the time of the model must be in s.
    axial : whether the axial force of the nodes acts on the shear force: "off" (default) or "node",
        for elements with `vertical`.
    joint : of bearings in tension with `axial = "node"`: "bolted" (default) or "dowelled".
    dowel_length : uplift at which dowels come out [mm], in (0, 1e5]; by default no uplift is a
        failure.
    rate : speed of static analyses [mm/s], in [1e-6, 1e6]; needed for displacement control, where
        the time of the model is a load factor. By default the time of the model is the clock.
    initial : temperature at the start [degC], by default the ambient temperature; or the state at
        the end of an earlier analysis, from `tb.end_state`.
    model : `ModelOptions`, or the name of an earlier model (model/earlier.py) but "bilinear".
    exposure, state : fields of `ModelOptions`, in place of those of `model`.

    Returns
    -------
    Line : a context manager. Its server is ready, and ends with the context or with this process.

    Raises
    ------
    InputError : no such bearing or option, or values that do not fit.
    ServingError : the server cannot be started.

    Examples
    --------
    >>> with serve("shen-hdr-bridge", ambient=-20, units="kN-m") as line:
    ...     line  # ops.element(*line.element(tag=101, nodes=(11, 21)))
    <Line of shen-hdr-bridge, 0 elements, running>
    """
    state = isinstance(initial, SpecimenState)
    case = make_served_case(
        {},
        "serve()",
        bearing=bearing,
        ambient=ambient,
        count=count,
        units=units,
        axial=axial,
        joint=joint,
        dowel_length=dowel_length,
        rate=rate,
        initial=None if state else initial,
        initial_state=initial if state else None,
        **model_table(model, options),
    )
    return Line(case)


@checked
def replace_elements(
    program: Any,
    tags: int | Sequence[int],
    bearing: Line,
    *,
    directions: int | Sequence[int] = (1, 2),
    vertical: int | None = 3,
) -> dict[int, str]:
    """Replace elastomeric bearings of a model in space by served ones, between the same nodes.

    All elements are checked before the first is removed. Shear, heat and the linear vertical,
    rotational and torsional springs are those of the served bearing, whatever the element had;
    P-delta moments and Rayleigh damping of the bearings are omitted. Call this before the first
    step of the model, and add recorders of the elements afterwards.

    Parameters
    ----------
    program : the module `openseespy.opensees`, whose model is open.
    tags : of elements `elastomericBearingPlasticity`, `elastomericBearingBoucWen`, `ElastomericX`,
        `LeadRubberX` or `HDR`. The served ones have the same tags.
    bearing : from `serve`, with the units of the model, and with the number of bearings that one
        of these elements stands for.
    directions : degrees of freedom in which the bearings shear, one or two of 1, 2 and 3.
    vertical : degree of freedom along the axis of the bearings. OpenSees does not state the
        orientation of an element, so that this is not checked. With None, as for the structures of
        `write_structure`, the bearings have no springs but those of `directions`.

    Returns
    -------
    dict : the former type of each element, by its tag.

    Raises
    ------
    InputError : an element that does not exist, is of another type, has a length or a mass, or
        whose nodes have moved.
    ServingError : the server has ended.

    Examples
    --------
    >>> from thermobearing.opensees import replace_elements, serve
    >>> import openseespy.opensees as ops  # doctest: +SKIP
    >>> with serve("shen-lhdr-bridge", ambient=-20, units="kN-m") as line:  # doctest: +SKIP
    ...     replace_elements(ops, [101, 102], line)  # then analyse the model
    {101: 'LeadRubberX', 102: 'LeadRubberX'}
    """
    if not callable(getattr(program, "eleType", None)):
        message = "must be the module openseespy.opensees, of version 3.5 or later"
        raise InputError(f"program = {short_repr(program)}: {message}", "replace_elements()")
    tag_list = [tags] if isinstance(tags, int) else list(tags)
    layout = Layout.of(1, directions, vertical, "replace_elements()")
    faults = [] if tag_list else ["tags: give one at least"]
    if len(set(tag_list)) < len(tag_list):
        faults.append(f"tags = {short_repr(tag_list)}: a tag occurs twice")
    existing = set(program.getEleTags() or ())
    masses = _element_masses(program)
    for tag in tag_list:
        if tag not in existing:
            faults.append(f"tags: there is no element {short_repr(tag)} in the model")
        else:
            fault = _irreplaceable(program, tag, masses.get(tag, 0.0))
            faults += [f"element {tag}: {fault}"] if fault else []
    if faults:
        raise InputError(faults, "replace_elements()")
    types = {tag: str(program.eleType(tag)) for tag in tag_list}
    ends = {tag: tuple(program.eleNodes(tag)) for tag in tag_list}
    served = {
        tag: bearing.element(tag, nodes, layout.directions, vertical=vertical)
        for tag, nodes in ends.items()
    }
    for tag, arguments in served.items():
        program.remove("element", tag)
        program.element(*arguments)
    return types


def _irreplaceable(program: Any, tag: int, mass: float) -> str:
    """Return why an element of OpenSees cannot be replaced by a served bearing; empty if it can."""
    kind = str(program.eleType(tag))
    if kind not in REPLACEABLE:
        return f"is a {kind}; only {', '.join(REPLACEABLE)} can be replaced"
    lower, upper = program.eleNodes(tag)
    coordinates = zip(program.nodeCoord(lower), program.nodeCoord(upper), strict=True)
    length = math.dist(*zip(*coordinates, strict=True))
    if length > 0.0:
        return (
            f"its nodes {lower} and {upper} are {length:g} apart, a served bearing needs them at "
            "one place; put them there, and the height into a rigid link"
        )
    if mass > 0.0:
        return (
            f"has a mass of {mass:g}, a served bearing has none; give it to nodes {lower}, {upper}"
        )
    if any(program.nodeDisp(lower)) or any(program.nodeDisp(upper)):
        return f"its nodes {lower} and {upper} have moved; replace it before the first analysis"
    return ""


def _element_masses(program: Any) -> dict[int, float]:
    """Return the masses of the elements of a model that have one, in its units."""
    with tempfile.TemporaryDirectory(prefix="thermobearing-") as folder:
        file = Path(folder, "model.json")
        program.printModel("-JSON", "-file", str(file))
        elements = json.loads(file.read_text(encoding="utf-8"))
    rows = elements["StructuralAnalysisModel"]["geometry"]["elements"]
    return {int(row["name"]): float(row.get("mass", 0.0)) for row in rows}
