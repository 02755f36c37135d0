"""The record loop under faults: foreign frames, an outage, a node that was ended."""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from hil_tests.support.cli import wait_for
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.codes import Event
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.select import BusChoice
from railhil.live.processes import Node, Nodes
from railhil.live.recorder import StopSignals, open_recorder
from railhil.plant_sim import command as plant_program
from railhil.run.bus_run import BusRun
from railhil.run.run import Plan
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec

#: Longest that a loop of a test may take: it then fails instead of hanging.
BOUND_S = 20.0


class Bus:
    """A link on which there are frames of somebody else all the time, or none; it ends after ``BOUND_S``."""

    def __init__(self, frames: list[Frame], while_receiving: Callable[[], None] = lambda: None) -> None:
        self.counters: Counter[str] = Counter()
        self.is_down = False
        self.packed = None
        self._frames = frames
        self._while_receiving = while_receiving
        self._end_s = time.monotonic() + BOUND_S

    def receive(self, _timeout_s: float | None) -> list[Frame]:
        if time.monotonic() > self._end_s:
            raise AssertionError("the loop does not end")
        self._while_receiving()
        time.sleep(0.002)
        return self._frames

    def take_gap_ns(self) -> int:
        return 0

    def may_deliver(self, _role: str) -> bool:
        return False


FOREIGN = [Frame(0x7FF, b"\0")]


def made(folder: Path, silence_s: float, faults: tuple[str, ...] = ()) -> BusRun:
    """A realtime run that gives up after so long."""
    choice = BusChoice({"interface": "socketcan", "channel": "can0"}, "test")
    plan = Plan(RunSpec(pace="realtime"), load("lvshun_tieshan", (), faults), choice, folder)
    return BusRun(plan, silence_s=silence_s, after_loss_s=0.05)


@pytest.fixture
def run(tmp_path: Path) -> BusRun:
    """One that waits for a moment only."""
    return made(tmp_path, 0.1)


def test_frames_of_somebody_else_do_not_keep_the_end_open(run: BusRun) -> None:
    bus = Bus(FOREIGN)
    assert run.recorder.drain(bus, StopSignals(), []) is False
    assert run.recorder.drain(Bus([]), StopSignals(), []) is False


@pytest.mark.parametrize(("delivered", "looks"), [(True, 1), (False, 3)])
def test_what_a_hub_still_holds_is_waited_for(run: BusRun, tmp_path: Path, delivered: bool, looks: int) -> None:
    """A hub that stands still across the end of the plant delivers the last second afterwards."""
    seen: list[str] = []

    def looked() -> None:
        seen.append("")
        if len(seen) == 3:
            run.session.ended = Event.ENDED_COMPLETE

    bus = Bus([], looked)
    bus.may_deliver = lambda role: not delivered and role == "plant"  # type: ignore[method-assign]
    assert run.recorder.drain(bus, StopSignals(), [node_that(0, "", tmp_path, "plant")]) is not delivered
    assert len(seen) == looks


def test_the_end_of_a_run_can_be_stopped(run: BusRun) -> None:
    with StopSignals() as stop, pytest.raises(KeyboardInterrupt):
        run.recorder.drain(Bus(FOREIGN, lambda: signal.raise_signal(signal.SIGINT)), stop, [])


@pytest.mark.parametrize("is_down", [False, True])
def test_an_outage_of_the_recorder_is_no_deadlock(run: BusRun, is_down: bool) -> None:
    """The link waits for its interface longer than the bench may be silent, and then says so itself."""
    looks = [0]

    def lost_at_last() -> None:
        looks[0] += 1
        if looks[0] == 200:
            raise BusLost("can0: not back")

    bus = Bus([], lost_at_last)
    bus.is_down = is_down
    run.session.recording = True
    run.session.first_frame_ns = time.monotonic_ns()
    with Nodes(run.folder) as nodes:
        if is_down:
            with pytest.raises(BusLost):
                run.recorder.record(bus, nodes, StopSignals())
            assert run.recorder.lost == ""
        else:
            run.recorder.record(bus, nodes, StopSignals())
            assert run.recorder.lost == "no tick for 0.1 s of wall time: bench is deadlocked"


def test_the_log_is_handed_to_the_kernel_while_the_run_goes_on(tmp_path: Path) -> None:
    """At 1x the buffer holds seconds of it; a recorder that is killed loses a fifth of one."""
    run = made(tmp_path, 5.0)
    line = "(0.000000) mvb0 7FF#00 R\n"

    def killed_when_it_is_there() -> None:
        if run.log.path.stat().st_size:
            raise BusLost("killed")

    run.log.write(line)
    run.session.recording = True
    run.session.first_frame_ns = time.monotonic_ns()
    with Nodes(run.folder) as nodes, pytest.raises(BusLost):
        run.recorder.record(Bus(FOREIGN, killed_when_it_is_there), nodes, StopSignals())
    assert run.log.path.read_text().startswith(line)


@pytest.mark.parametrize("ticks", [True, False])
def test_without_a_controller_the_record_goes_on_while_the_plant_ticks(tmp_path: Path, ticks: bool) -> None:
    """At 1x a train takes longer to stop than nodes have time to end."""
    run = made(tmp_path, 5.0)
    session = run.session
    session.recording, session.first_frame_ns = True, time.monotonic_ns()
    begun_s = time.monotonic()

    def tick() -> None:
        if ticks:
            session.wall_ns.append(time.monotonic_ns())
            if time.monotonic() - begun_s > 0.4:
                session.ended = Event.ENDED_CONTROLLER_LOST

    nodes = Nodes(tmp_path)
    nodes.nodes = [node_that(None, "", tmp_path, "plant"), node_that(-9, "", tmp_path)]
    nodes.nodes[0].process.pid = 0
    run.recorder.record(Bus([], tick), nodes, StopSignals())
    assert run.recorder.lost == "controller lost at simulation time 0.00 s: killed by SIGKILL"
    assert session.ended is (Event.ENDED_CONTROLLER_LOST if ticks else None)


# -- why a node has ended ---------------------------------------------------------------------------------------------

CHATTER = (
    "controller: socketcan:can0 (given on the command line)\n"
    "controller: scheduling: not permitted (no CAP_SYS_NICE, rtprio limit 0); normal scheduling\n"
    "controller: socketcan channel 'can0' is down (Network is down); nothing is sent, waiting up to 30 s\n"
)
TROUBLE = "controller: socketcan channel 'can0': outages 1, send_dropped 12\n"
BACK = "controller: socketcan channel 'can0' is back after 2.03 s\n"


def node_that(code: int | None, said: str, folder: Path, role: str = "controller") -> Node:
    """A node that has said this and ended with this exit code."""
    output = folder / f"{role}.txt"
    output.write_text(said)
    process: Any = SimpleNamespace(poll=lambda: code)
    return Node(role, process, output)


@pytest.mark.parametrize(
    ("code", "said", "words"),
    [
        (-9, CHATTER + TROUBLE, "killed by SIGKILL"),
        (143, CHATTER + TROUBLE, "ended by SIGTERM"),
        (129, CHATTER + TROUBLE, "ended by SIGHUP"),
        (130, CHATTER, "ended by SIGINT"),
        (3, CHATTER + BACK + "controller: no frame for 3 s\n" + TROUBLE, "controller: no frame for 3 s"),
        (3, CHATTER + "controller: can0: not back\n" + BACK + TROUBLE, "controller: can0: not back"),
        (3, "controller: scheduling: SCHED_FIFO 40, memory locked\n" + BACK + TROUBLE, "exit code 3"),
        (4, "", "exit code 4"),
    ],
)  # fmt: skip
def test_last_words(tmp_path: Path, code: int, said: str, words: str) -> None:
    assert node_that(code, said, tmp_path).last_words() == words


def test_the_one_that_was_ended_is_blamed_and_the_hub_before_all(tmp_path: Path) -> None:
    nodes = Nodes(tmp_path)
    assert nodes.failed_node() is None
    nodes.nodes = [
        node_that(3, "", tmp_path, "plant"),
        node_that(143, "", tmp_path),
        node_that(None, "", tmp_path, "hub"),
    ]
    assert nodes.failed_node() is nodes.nodes[1]
    nodes.nodes.append(node_that(-9, "", tmp_path, "hub"))
    assert nodes.failed_node() is nodes.nodes[3]


@pytest.mark.parametrize(
    ("code", "said", "line"),
    [
        (-9, CHATTER, "plant lost before the run: killed by SIGKILL"),
        (3, "plant: bus administrator waits for controller: no answer within 120 s\n",
         "plant gave up before the run: plant: bus administrator waits for controller: no answer within 120 s"),
        (0, CHATTER, "plant lost before the run: it has ended, but the end of the run has not arrived here"),
    ],
)  # fmt: skip
def test_a_node_that_gives_up_is_not_the_one_that_is_missing(
    run: BusRun, tmp_path: Path, code: int, said: str, line: str
) -> None:
    nodes = Nodes(tmp_path)
    nodes.nodes = [node_that(code, said, tmp_path, "plant")]
    assert run.recorder.describe_loss(nodes) == line


def test_a_suspended_node_is_blamed_unless_one_was_killed(run: BusRun, tmp_path: Path) -> None:
    """It cannot end by itself, so the others give up in front of it."""
    with Nodes(tmp_path) as nodes:
        hangs = nodes.start("controller", "timeit", ["-n", "1", "import time; time.sleep(600)"])
        hangs.process.send_signal(signal.SIGSTOP)
        wait_for(lambda: hangs.is_suspended)
        line = "controller lost before the run: suspended by a signal (SIGSTOP) or a debugger"
        assert run.recorder.describe_loss(nodes) == line
        nodes.nodes.append(node_that(3, "plant: gave up\n", tmp_path, "plant"))
        assert run.recorder.describe_loss(nodes) == line
        assert nodes.wait(("controller",), BOUND_S) is False, "nobody waits for its end"
        nodes.nodes[1] = node_that(-9, "", tmp_path, "plant")
        assert run.recorder.describe_loss(nodes) == "plant lost before the run: killed by SIGKILL"
    assert hangs.exit_code() is not None
    assert not hangs.is_suspended


def test_a_railhil_folder_in_the_current_directory_is_no_node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkout of another version, for example: the nodes are those of the command that starts them."""
    other = tmp_path / "railhil"
    other.mkdir()
    (other / "__init__.py").write_text("raise SystemExit('another railhil')")
    monkeypatch.chdir(tmp_path)
    with Nodes(tmp_path) as nodes:
        node = nodes.start("hub", "railhil.bus.hub", ["--help"])
        assert nodes.wait(("hub",), BOUND_S)
        assert (node.exit_code(), "another railhil" in node.output.read_text()) == (0, False)


@pytest.mark.parametrize("is_suspended", [True, False])
def test_in_real_time_a_suspended_controller_is_not_waited_for_forever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_suspended: bool
) -> None:
    monkeypatch.setattr("railhil.live.recorder.SUSPENDED_S", 0.1)
    run = made(tmp_path, 0.5)
    run.session.recording = True
    run.session.first_frame_ns = time.monotonic_ns()
    nodes = Nodes(tmp_path)
    monkeypatch.setattr(nodes, "find_suspended", lambda: "controller" if is_suspended else "")
    run.recorder.record(Bus(FOREIGN), nodes, StopSignals())
    blame = "controller lost at simulation time 0.00 s: suspended by a signal (SIGSTOP) or a debugger"
    assert run.recorder.lost == (blame if is_suspended else "no tick for 0.5 s of wall time: bench is deadlocked")


@pytest.mark.parametrize("faults", [(), ("controller stop @1s for 30s", "plant stop @2s for 40s")])
def test_a_controller_that_a_fault_has_stopped_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, faults: tuple[str, ...]
) -> None:
    monkeypatch.setattr("railhil.live.recorder.SUSPENDED_S", 0.1)
    run = made(tmp_path, BOUND_S, faults)
    assert run.recorder.stopped_s == (30 if faults else 0)
    run.session.recording = True
    run.session.first_frame_ns = time.monotonic_ns()
    nodes = Nodes(tmp_path)
    looks: list[str] = []

    def find_suspended() -> str:
        looks.append("controller")
        if len(looks) == 10:
            run.session.ended = Event.ENDED_CONTROLLER_LOST
        return "controller" if len(looks) < 15 else ""

    monkeypatch.setattr(nodes, "find_suspended", find_suspended)
    run.recorder.record(Bus(FOREIGN), nodes, StopSignals())
    assert bool(run.recorder.lost) is not bool(faults)
    if faults:
        assert len(looks) == 10
        run.recorder.await_controller(nodes, StopSignals())
        assert len(looks) == 15


def test_a_controller_that_refuses_its_input_ends_a_run_that_has_not_begun(tmp_path: Path) -> None:
    """At once: there is no train whose reaction would have to be recorded."""
    run = made(tmp_path, 0.1)
    run._after_loss_s = 2 * BOUND_S
    nodes = Nodes(tmp_path)
    nodes.nodes = [
        node_that(None, "", tmp_path, "plant"),
        node_that(2, "controller: parameters: no such file\n", tmp_path),
    ]
    nodes.nodes[0].process.pid = 0
    run.recorder.record(Bus([]), nodes, StopSignals())
    assert run._verdict_line(nodes, {}) == ("controller: parameters: no such file", True)


@pytest.mark.parametrize("killed", [-9, None])
def test_who_ends_because_the_hub_was_killed_has_refused_nothing(
    run: BusRun, tmp_path: Path, killed: int | None
) -> None:
    nodes = Nodes(tmp_path)
    nodes.nodes = [
        node_that(killed, "", tmp_path, "hub"),
        node_that(2, "plant: no hub at hub.sock\n", tmp_path, "plant"),
    ]
    nodes.nodes[0].process.pid = 0
    run.recorder.lost = run.recorder.describe_loss(nodes)
    line = "hub lost before the run: killed by SIGKILL" if killed else "plant: no hub at hub.sock"
    assert run._verdict_line(nodes, {}) == (line, not killed)
    if killed:
        with pytest.raises(BusLost, match=rf"^{line}$"):
            open_recorder(BusChoice({"interface": "railhil"}, "test", needs_hub=True), nodes, False, unavailable)


def unavailable(_config: dict[str, Any], _name: str) -> Any:
    raise BusUnavailable("no hub")


def test_the_plant_says_what_went_wrong_on_its_connection(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The last line, after the link is closed."""
    done: list[str] = []
    link = SimpleNamespace(
        lossless=True,
        is_down=False,
        disturber=None,
        ahead=None,
        packed=None,
        close=lambda: done.append("close"),
        tell_trouble=lambda: done.append("tell"),
    )
    monkeypatch.setattr(plant_program, "open_link", lambda _config, _name: link)
    monkeypatch.setattr(plant_program, "run_plant", lambda *_: done.append("run"))
    (tmp_path / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    assert plant_program.main([str(tmp_path / "short.toml"), "-i", "socketcan", "-c", "can0"]) == 0
    assert done == ["run", "close", "tell"]
