"""A specimen outside in a hybrid test: the same histories, delays, limits, and lost connections."""

import _thread
import math
import re
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.unit.inputs import command, last_line
from thermobearing.bearing.bilinear import BilinearBearing, load_device
from thermobearing.bearing.library import load_bearing
from thermobearing.border.errors import InputError
from thermobearing.earthquake.case import Laboratory, load_earthquake_case, make_earthquake_case
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.model.outcomes import ALL_SENTENCES
from thermobearing.opensees.line import serve
from thermobearing.opensees.specimen import TwinCheck, read_address, refuse_remote
from thermobearing.opensees.wire import (
    Action,
    Request,
    Setup,
    encode_reply,
    prepare,
    receive_exactly,
)
from thermobearing.reported import residual_rows
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import (
    IMPLAUSIBLE_ENERGY,
    IMPLAUSIBLE_FORCE,
    IMPLAUSIBLE_STIFFNESS,
    SENSOR_STUCK,
    StructureHistory,
    _actuators,
    prepare_structure,
)

HDR = "shen-hdr-specimen"
LHDR, HDR_BRIDGE, LHDR_BRIDGE = "shen-lhdr-specimen", "shen-hdr-bridge", "shen-lhdr-bridge"
TWO_PIERS = Path(__file__).parents[1] / "regression" / "inputs" / "two-piers.toml"
LIMIT = 300.0  # of one exchange [s]: kernels may be compiled meanwhile
Answer = Callable[["Server", float], float]


class Server:
    """A bearing of the library behind the wire format, as a thread."""

    def __init__(self, bearing: tb.BearingElement, delay: int = 0, answer: Answer | None = None):
        self.bearing, self.delay, self.answer = bearing, delay, answer
        self.log: list[tuple[Action, float, float]] = []
        self.commands: list[float] = []
        self.connected = False
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"tcp://127.0.0.1:{self.listener.getsockname()[1]}"
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self) -> None:
        connection, _ = self.listener.accept()
        self.connected = True
        with connection:
            prepare(connection)
            setup = Setup.decode(receive_exactly(connection, 44, LIMIT))
            assert setup.dofs == 2
            x = begun = now = 0.0
            while True:
                data = receive_exactly(connection, setup.length, LIMIT)
                request = Request.decode(data, setup)
                self.log.append((request.action, request.displacement[1], request.velocity[1]))
                if request.action == Action.SET_TRIAL:
                    x, now = request.displacement[1], request.time
                elif request.action == Action.FORCE:
                    self.commands.append(x)
                    force = self._force(now - begun)
                    force = force if self.answer is None else self.answer(self, force)
                    if force == math.inf:  # hang up
                        return
                    connection.sendall(encode_reply([-force, force], setup))
                elif request.action == Action.COMMIT and now > begun:
                    self.bearing.commit()
                    begun = now
                elif request.action == Action.END:
                    return

    def _force(self, dt: float) -> float:
        if dt <= 0.0:
            return float(self.bearing.state.response[0].force)
        there = self.commands[max(len(self.commands) - 1 - self.delay, 0)]
        return self.bearing.set_trial(there, dt).force


@contextmanager
def served(bearing: str = LHDR, ambient: float = -20.0, **given: Any) -> Iterator[Server]:
    initial = given.pop("initial", None)
    element = tb.element(bearing, ambient, initial=initial)
    element.set_trial(1.0, dt=0.1)  # compiles the kernels before anybody waits
    server = Server(element, **given)
    try:
        yield server
        assert server.connected, "nobody connected to the specimen"
        server.thread.join(LIMIT)
        assert not server.thread.is_alive()
    finally:
        server.listener.close()


def run_hybrid(duration: float = 3.0, initial: Any = None, **changes: Any) -> StructureHistory:
    table = {"command": "hybrid", "bearings": [LHDR], "ambient": "-20 degC"}
    given = {"duration": duration} | changes
    if initial is not None:
        given["initial_state"] = initial
    (task,) = build_tasks(make_earthquake_case(table, "test", **given))
    return run_task(task)


def assert_same(one: StructureHistory, other: StructureHistory, line: int = 0) -> None:
    """Compare structure, forces, temperatures and energies, relative to their largest values."""
    assert (one.outcome, one.steps) == (other.outcome, other.steps)
    pairs = [(one.rows.q, other.rows.q), (one.layers(line), other.layers(line))]
    names = ("displacement", "force", "work_in", "clock", "heat_stored")
    pairs += [(one.bearing(line)[name], other.bearing(line)[name]) for name in names]
    pairs.append((one.rows.energies["bearings"], other.rows.energies["bearings"]))
    for mine, theirs in pairs:
        assert np.abs(mine - theirs).max() <= tol.SERVED * np.abs(mine).max()


@pytest.mark.parametrize(
    "laboratory",
    quick_cases([{}, {"mode": "pd"}, {"force_noise": "2 kN", "seed": 4}], 2),
    ids=["real time", "slow", "noise"],
)
def test_a_served_bearing_gives_the_histories_of_the_calculated_one(
    laboratory: dict[str, Any],
) -> None:
    calculated = run_hybrid(laboratory=laboratory)
    with served() as server:
        assert_same(calculated, run_hybrid(laboratory={**laboratory, "specimen": server.address}))
    actions = [action for action, _, _ in server.log]
    assert actions[:3] == [Action.SET_TRIAL, Action.FORCE, Action.COMMIT]
    assert actions[-2:] == [Action.SET_TRIAL, Action.END]
    assert actions.count(Action.COMMIT) == 1 + calculated.steps
    assert server.log[-2][1:] == (server.commands[-1], 0.0)


@pytest.mark.parametrize("mode", ["rt", pytest.param("pd", marks=pytest.mark.thorough)])
def test_a_bearing_served_by_another_process(mode: str) -> None:
    """What is served to OpenSees is a specimen too; its own histories are those of the test."""
    calculated = run_hybrid(duration=1.0, laboratory={"mode": mode})
    with serve(LHDR, ambient=-20.0) as line:
        arguments = line.element(1, (1, 2))
        port = arguments[arguments.index("-server") + 1]
        specimen = f"tcp://127.0.0.1:{port}"
        result = run_hybrid(duration=1.0, laboratory={"mode": mode, "specimen": specimen})
    assert_same(calculated, result)
    served_force = line.results()["force"].values[0]
    assert served_force[-1] == pytest.approx(result.bearing()["force"][-1], rel=tol.SERVED)


def test_a_specimen_starts_where_an_earlier_test_left_it() -> None:
    earlier = tb.hybrid(LHDR, ambient=-20, duration=4)
    state = tb.end_state(earlier, LHDR)
    calculated = run_hybrid(initial=state)
    assert abs(calculated.bearing()["force"][0]) > 1.0
    with served(initial=state) as server:
        assert_same(calculated, run_hybrid(initial=state, laboratory={"specimen": server.address}))


@pytest.mark.parametrize(
    "lines", [[], [{"line": "on B", "bearing": LHDR_BRIDGE}]], ids=["one kind", "two kinds"]
)
def test_a_specimen_on_one_of_several_lines(lines: list[dict[str, Any]]) -> None:
    """The other line is calculated; the delay is that of the specimen alone."""
    given = {"structure": str(TWO_PIERS), "bearings": [HDR_BRIDGE], "duration": 1.5}
    given |= {"lines": lines, "laboratory": {"force_noise": "1 kN"}}
    calculated = run_hybrid(**given)
    given["laboratory"] |= {"delay": "1 ms"}
    with served(HDR_BRIDGE) as server:
        result = run_hybrid(
            **given | {"laboratory": {**given["laboratory"], "specimen": server.address}}
        )
    for line in (0, 1):
        assert_same(calculated, result, line)


def test_the_specimen_counts_and_not_the_bearing_calculated_beside_it() -> None:
    calculated = run_hybrid()
    with served() as server:
        result = run_hybrid(bearings=[HDR], laboratory={"specimen": server.address})
    assert (
        np.abs(calculated.rows.q - result.rows.q).max() <= tol.SERVED * np.abs(result.rows.q).max()
    )
    for name in ("force", "work_in"):
        mine, theirs = calculated.bearing()[name], result.bearing()[name]
        assert np.abs(mine - theirs).max() <= tol.SERVED * np.abs(mine).max()
    balance = result.rows.energies["bearings"] - calculated.rows.energies["bearings"]
    assert np.abs(balance).max() <= tol.SERVED * calculated.rows.energies["bearings"].max()


STEPS_LATE = 2


def test_only_the_command_of_the_specimen_is_extrapolated() -> None:
    prepared = prepare_structure(load_structure(str(TWO_PIERS)))
    with_one = _actuators(prepared, np.zeros(3), 2, 1.0, 3, 1)
    assert with_one.weights == pytest.approx(np.array([[1, 0, 0, 0], [4, -6, 4, -1]]))
    assert (with_one.lag, with_one.outside) == (0.0, True)
    simulated = _actuators(prepared, np.zeros(3), 2, 1.5, 1, None)
    assert simulated.weights == pytest.approx(np.array([[1.75, -0.75]] * 2))
    assert (simulated.lag, simulated.ahead, simulated.outside) == (1.5, 2.0, False)


def test_a_late_specimen_whose_command_is_extrapolated_by_its_delay(measured: Recorder) -> None:
    """A delay outside acts as a simulated one, and the extrapolation makes up for most of it."""
    motion = tb.load_motion("jra-ii-ii-1")
    late = STEPS_LATE * min(motion.dt, 0.005)
    ideal, errors = run_hybrid(), []
    for order in (0, 1, 3):
        laboratory = {"delay": late, "compensation": order}
        calculated = run_hybrid(laboratory=laboratory)
        with served(delay=STEPS_LATE) as server:
            result = run_hybrid(laboratory={**laboratory, "specimen": server.address})
        scale = np.abs(ideal.rows.q).max()
        assert np.abs(calculated.rows.q - result.rows.q).max() <= tol.SERVED * scale
        errors.append(np.abs(calculated.rows.q - ideal.rows.q).max() / scale)
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]
    measured(
        "hybrid test with a delay of 10 ms, displacements without compensation, orders 1 and 3",
        ", ".join(f"{error:.1%}" for error in errors),
        "each less than 0.3 of the one before",
    )


AFTER = 100


def _at(count: int, value: float) -> Answer:
    return lambda server, force: value if len(server.commands) > count else force


def _silent(server: Server, force: float) -> float:
    if len(server.commands) > AFTER:
        time.sleep(0.5)
        return math.inf
    return force


@pytest.mark.parametrize(
    ("answer", "limits"),
    [(_at(AFTER, math.inf), {}), (_silent, {"time_out": 0.1}), (_at(AFTER, math.nan), {})],
    ids=["hangs up", "is silent", "is not a number"],
)
def test_a_lost_specimen_ends_the_test_and_what_was_measured_is_kept(
    answer: Answer, limits: dict[str, Any]
) -> None:
    whole = run_hybrid(duration=1.0)
    with served(answer=answer) as server:
        result = run_hybrid(duration=1.0, laboratory={"specimen": server.address, **limits})
    assert result.outcome == "specimen_lost"
    assert result.steps == AFTER - 1  # the first answer is that at rest
    assert len(result.rows.q) == AFTER
    np.testing.assert_allclose(result.rows.q, whole.rows.q[:AFTER], atol=1e-9)


def _always(value: float) -> Answer:
    return lambda server, force: value


@pytest.mark.parametrize(
    ("answer", "outcome"),
    [
        (_at(AFTER, 1e300), IMPLAUSIBLE_FORCE),
        (_always(1e5), IMPLAUSIBLE_FORCE),
        (_always(0.0), SENSOR_STUCK),
        (_at(AFTER, 7.0), SENSOR_STUCK),
        (lambda server, force: -force, IMPLAUSIBLE_STIFFNESS),
        (lambda server, force: 20.0 * server.commands[-1] - force, IMPLAUSIBLE_STIFFNESS),
    ],
    ids=["1e300 kN", "1e5 kN", "zero", "stuck", "negative", "stiff"],
)
def test_a_force_that_the_calculated_bearing_rules_out_ends_the_test(
    answer: Answer, outcome: str
) -> None:
    with served(answer=answer) as server:
        result = run_hybrid(laboratory={"specimen": server.address})
    assert result.outcome == outcome
    assert "last good step" in result.note
    force = result.bearing()["force"]
    assert result.steps < len(server.commands) or len(server.commands) == 1
    assert np.abs(force).max(initial=0.0) < 1e3
    assert server.log[-1][0] == Action.END
    assert ALL_SENTENCES[outcome]


def test_a_force_limit_of_the_laboratory_replaces_that_of_the_twin() -> None:
    with served(answer=_at(AFTER, 9e5)) as server:
        result = run_hybrid(laboratory={"specimen": server.address, "force_limit": 1e6})
    assert result.outcome != IMPLAUSIBLE_FORCE


def outcome_of(damping: float, stiffness: float = 1.0, noise: float = 0.0) -> str:
    """The outcome of ellipses, beside a twin of unit stiffness and 15 % damping."""
    bearing = load_bearing(LHDR)
    check = TwinCheck(bearing, -20.0)
    height, scale = bearing.total_rubber_thickness, check._reference
    phase = np.linspace(0.0, 6.0 * np.pi, 1200)
    growing = np.minimum(phase / np.pi, 1.0)
    errors = noise * np.random.default_rng(1).standard_normal(len(phase))
    for angle, share, error in zip(phase, growing, errors, strict=True):
        x, v = share * math.sin(angle), share * math.cos(angle)
        force = scale * (stiffness * x + 2.0 * damping * v + error)
        outcome, _ = check.problem(height * x, force, scale * (x + 0.3 * v))
        if outcome:
            return outcome
    return "completed"


def test_energy_and_stiffness_have_limits_on_both_sides() -> None:
    assert outcome_of(0.15) == outcome_of(0.05, 0.4, 0.02) == outcome_of(0.4, 3.0) == "completed"
    assert outcome_of(-0.05) == IMPLAUSIBLE_ENERGY
    assert outcome_of(2.5, 5.0) == IMPLAUSIBLE_ENERGY
    assert outcome_of(0.0, -0.5) == outcome_of(0.0, 0.05, 0.001) == IMPLAUSIBLE_STIFFNESS
    assert outcome_of(0.15, 15.0) == IMPLAUSIBLE_STIFFNESS


@pytest.mark.parametrize("bearing", [HDR_BRIDGE, "shen-bilinear-bridge"])
def test_the_reference_is_the_force_at_full_strain(bearing: str) -> None:
    device = load_device(bearing)
    force = TwinCheck(device, 23.0)._reference
    if isinstance(device, BilinearBearing):
        height = device.total_rubber_thickness
        assert force == device.strength + device.post_yield_stiffness * height
    else:
        shear_stress = force / device.area  # GPa
        assert 0.5e-3 < shear_stress < 3e-3


REMOTE = "tcp://10.0.0.7:8090"


def test_a_case_file_alone_reaches_this_machine_only(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(
        f'command = "hybrid"\nbearings = ["{LHDR}"]\nambient = "0 degC"\n'
        f'[laboratory]\nspecimen = "{REMOTE}"\n'
    )
    with pytest.raises(InputError) as refused:
        load_earthquake_case(file)
    assert f"--specimen {REMOTE}" in str(refused.value)
    assert load_earthquake_case(file, laboratory={"specimen": REMOTE}).specimen == REMOTE
    for host in ("localhost", "127.0.0.1", "127.8.0.1", "[::1]"):
        table = {"command": "hybrid", "laboratory": {"specimen": f"tcp://{host}:80"}}
        refuse_remote(table, "test")
    done = command("check", file)
    assert done.exit_code == 2
    assert REMOTE in done.stderr


@pytest.mark.parametrize(
    ("key", "column", "limit", "outcome"),
    quick_cases(
        [
            ("force_limit", "force", 60.0, "force_limit"),
            ("displacement_limit", "displacement", 2.0, "displacement_limit"),
        ],
        0,
    ),
)
def test_a_limit_stops_the_test(
    key: str, column: str, limit: float, outcome: str, tmp_path: Path
) -> None:
    with served() as server:
        words = ["--bearing", LHDR, "--ambient", -20, "--duration", 4, "--no-figures", "--json"]
        words += ["--specimen", server.address, "--laboratory", f"{key}={limit}"]
        done = command("hybrid", *words, "-o", tmp_path / "out")
    assert done.exit_code == 3
    assert last_line(done)["outcome"] == outcome
    saved = tb.load_result(tmp_path / "out")
    values = saved.dataset[f"bearing_{column}"].values
    assert 0.5 * limit < np.nanmax(np.abs(values)) <= limit
    assert saved.dataset.attrs["specimen"] == server.address
    notes = [re.findall(r"-?[\d.]+", text)[:2] for text in saved.warnings if "force_limit" in text]
    assert [abs(float(force)) > float(most) == limit for force, most in notes] == [True] * (
        key == "force_limit"
    )
    if key == "displacement_limit":
        assert max(map(abs, server.commands)) <= limit
    (*_, held, ended) = server.log
    assert (held[0], held[1:], ended[0]) == (
        Action.SET_TRIAL,
        (server.commands[-1], 0.0),
        Action.END,
    )


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Handle SIGINT as in a terminal: jobs that a script starts in the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_the_specimen() -> None:
    def _interrupt(server: Server, force: float) -> float:
        if len(server.commands) == AFTER:
            _thread.interrupt_main()
        return force

    with served(answer=_interrupt) as server:
        result = run_hybrid(laboratory={"specimen": server.address})
    assert result.outcome == "interrupted"
    assert server.log[-1][0] == Action.END
    assert len(result.rows.q) in (AFTER - 1, AFTER, AFTER + 1)


@pytest.mark.parametrize(
    ("address", "result"),
    [
        ("tcp://localhost:8090", ("localhost", 8090)),
        ("tcp://[fe80::1]:65535", ("fe80::1", 65535)),
        ("tcp://10.0.0.7:1/", ("10.0.0.7", 1)),
    ],
)
def test_addresses(address: str, result: tuple[str, int]) -> None:
    assert read_address(address) == result


@pytest.mark.parametrize(
    "address",
    [
        "localhost:80",
        "tcp://a",
        "tcp://a:0",
        "udp://a:1",
        "tcp://:1",
        "tcp://a..b:1",
        f"tcp://{'a' * 64}:1",
        "tcp://a\0b:1",
    ],
)
def test_what_is_no_address(address: str) -> None:
    with pytest.raises(ValueError, match="tcp://"):
        read_address(address)


def test_nothing_answers() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = f"tcp://127.0.0.1:{listener.getsockname()[1]}"
    with pytest.raises(InputError, match=address):
        tb.hybrid(LHDR, ambient=0, duration=1, laboratory={"specimen": address})


SOME = "tcp://127.0.0.1:9"


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"laboratory": {"specimen": SOME}, "ambient": [0.0, 10.0]}, "laboratory.specimen"),
        ({"laboratory": {"specimen": SOME, "mode": ["rt", "pd"]}}, "laboratory.specimen"),
        ({"laboratory": {"specimen": SOME}, "method": "average-acceleration"}, "analysis.method"),
        ({"laboratory": {"specimen": "here"}}, "laboratory.specimen"),
        ({"laboratory": {"force_limit": "3 kN"}}, "force_limit"),
        ({"laboratory": {"displacement_limit": "3 mm"}}, "displacement_limit"),
        ({"laboratory": {"compensation": 3}}, "compensation"),
        ({"laboratory": {"compensation": 5, "delay": "1 ms"}}, "laboratory.compensation"),
    ],
)
def test_what_does_not_go_with_a_specimen(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError) as refused:
        run_hybrid(**changes)
    assert any(key in problem for problem in refused.value.problems)


def test_a_checked_laboratory_reaches_the_case() -> None:
    with served() as server:
        lab = Laboratory(force_limit=500.0, specimen=server.address)
        result = tb.hybrid(LHDR, ambient=-20, duration=0.5, laboratory=lab)
    assert result.outcome == "completed"
    assert server.address in result.dataset.attrs["case"]
    pieces = build_pieces(result)
    assert any(server.address in text for text in pieces.assumptions)
    energy, analysis = result.energy.assign(mechanical_residual=0.5), {"scheme": "conservative"}
    limits = [limit for _, _, limit, _ in residual_rows(energy, analysis, measured=True)]
    assert [math.isnan(limit) for limit in limits] == [False, True, False]
