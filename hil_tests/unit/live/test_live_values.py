"""What the progress line and ``railhil watch`` show of a run: the values of signals.csv, from the newest telegrams."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from rich.console import Console

from hil_tests.support.fault_runs import fast
from railhil.bench import local_run
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.bus.select import no_bus
from railhil.cli import watch
from railhil.cli.progress import Progress
from railhil.cli.run_identity import RunIdentity
from railhil.common.command_line import OneLineParser
from railhil.common.errors import InputError
from railhil.common.output import Output
from railhil.dbc import wire_contract
from railhil.judge.signals import signal_table
from railhil.live.bus_follower import Listener, Milestones
from railhil.live.live_values import Instruments, LogTail, Newest
from railhil.record.framelog import log_line, read_log
from railhil.record.trace import Trace, trace_of
from railhil.run.run import Plan
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec, StartUp

_FAULT = "TRN_SPEED loss @2s for 1s"


class Recorded:
    """A run of some seconds in which the speed is lost for a second."""

    def __init__(self, folder: Path) -> None:
        self.scenario: AnyScenario = fast(folder, _FAULT)
        self.log = folder / "frames.log"
        local_run(self.scenario, folder, RunSpec(self.scenario.name))
        self.frames = list(read_log(self.log))

    def trace(self) -> Trace:
        return trace_of(self.frames, wire_contract())

    def until(self, time_s: float) -> list[tuple[int, Frame]]:
        return [(time_ns, frame) for time_ns, frame in self.frames if time_ns <= time_s * 1e9]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return Recorded(tmp_path_factory.mktemp("now"))


@pytest.mark.slow
def test_values_are_those_of_signals_csv(recorded: Recorded, tmp_path: Path) -> None:
    """From the end of a log that is being written, cut off anywhere."""
    header, rows = signal_table(recorded.scenario, recorded.trace())
    lines = recorded.log.read_bytes().splitlines(keepends=True)
    partial = tmp_path / "frames.log"
    partial.write_bytes(b"".join(lines[: len(lines) * 3 // 4]) + lines[-1][:17])
    instruments = Instruments(recorded.scenario)
    tail = LogTail(partial, recorded.trace().contract)
    found = instruments.values(tail.look())
    row = dict(zip(header, rows[np.searchsorted(rows[:, 0], found["time_s"])], strict=True))
    # The truth opens its tick: what the others send within it is newer.
    assert found["true_speed_mps"] == pytest.approx(row["true_speed_mps"] * 3.6)
    assert found["target_speed_mps"] == pytest.approx(row["target_speed_mps"] * 3.6)
    assert found["true_position_m"] == pytest.approx(row["true_position_m"])
    assert instruments.to_go_m(found) == pytest.approx(
        recorded.scenario.described["distance_m"] - row["true_position_m"]
    )
    speed, target = found["true_speed_mps"], found["target_speed_mps"]
    assert instruments.line(found).startswith(f"{speed:.1f} km/h (target {target:.1f}), notch ")
    partial.write_bytes(recorded.log.read_bytes()[:3000])
    assert instruments.values(LogTail(partial, recorded.trace().contract).look())
    assert instruments.line(instruments.values(LogTail(tmp_path / "none", recorded.trace().contract).look())) == ""


def test_the_table_looks_up_the_instants_of_a_port_once(recorded: Recorded, monkeypatch: pytest.MonkeyPatch) -> None:
    """A panel makes the table 5 times a second; most columns share a port."""
    asked: list[str] = []
    times_s = Trace.times_s
    monkeypatch.setattr(Trace, "times_s", lambda trace, port: (asked.append(port), times_s(trace, port))[1])
    signal_table(recorded.scenario, recorded.trace())
    assert asked.count("CTL_STAT") == 1


def test_the_ladder_is_said_while_the_watch_reacts(recorded: Recorded) -> None:
    instruments = Instruments(recorded.scenario)

    def ladder(time_s: float) -> str:
        newest = Newest(recorded.trace().contract)
        for time_ns, frame in recorded.until(time_s):
            newest.take(time_ns, frame)
        return instruments.ladder(instruments.values(newest))

    assert ladder(1.9) == "normal"
    assert ladder(2.3) == "SERVICE BRAKE"
    assert instruments.ladder({"controller_level": 0.0}) == "normal"
    assert instruments.ladder({}) == ""


@pytest.mark.parametrize(
    ("name", "values", "line"),
    [
        ("emu3", {"true_speed_mps": 100.04, "target_mps": 101.0, "command_mps2": 0.5, "unit2_level": 2.0},
         "100.0 km/h (target 101.0), command 0.50 m/s², unit 2 TRACTION CUT"),
        ("yizhuang_stop", {"true_speed_mps": 36.0, "position_m": 100.0, "command_mps2": -0.8, "train_level": 0.0},
         "36.0 km/h, command -0.80 m/s², normal, "),
    ],
)  # fmt: skip
def test_every_system_shows_what_it_declares(name: str, values: dict[str, float], line: str) -> None:
    instruments = Instruments(load_any(name))
    assert instruments.line(values).startswith(line)
    assert ("to go" in instruments.line(values)) == (name == "yizhuang_stop")


@pytest.mark.parametrize(
    ("position_m", "place"),
    [(0.0, "at A"), (1150.0, "B in 50 m"), (1199.1, "at B"), (1200.9, "at B"), (1201.1, "C in 1099 m"), (3425.0, "")],
)
def test_the_next_named_place_is_shown(position_m: float, place: str) -> None:
    instruments = Instruments(load_any("four_stops"))
    values = {"true_position_m": position_m, "true_speed_mps": 36.0}
    assert instruments.place(values) == place
    assert place in instruments.line(values)


def test_before_the_plant_has_told_what_it_runs_that_is_said_once() -> None:
    for watched in (RunIdentity(None), RunIdentity(load_any("yizhuang_05"))):
        assert "; ".join(filter(None, watched.said)).count("the plant has not told yet") == 1


def test_a_follower_knows_time_milestones_and_the_next_run(recorded: Recorded) -> None:
    contract = recorded.trace().contract
    passed = Milestones(contract, {})
    listener = Listener(recorded.scenario, contract, passed)
    listener.take(frame for _, frame in recorded.frames)
    assert listener.now_s == pytest.approx(recorded.frames[-1][0] / 1e9, abs=0.02)
    assert passed.newest[0].cause == "departed"
    listener.take(frame for _, frame in recorded.until(1.0))
    assert listener.now_s == pytest.approx(1.0, abs=0.02)
    assert len(passed.newest) <= 1


class _Bus:
    """A bus with a record on it, which is then gone."""

    counters: ClassVar[dict[str, int]] = {"rx_lost": 0}

    def __init__(self, frames: Sequence[Frame]) -> None:
        self._parts = [frames[start : start + 500] for start in range(0, len(frames), 500)]

    def receive(self, timeout_s: float) -> list[Frame]:
        if not self._parts:
            raise BusLost("the hub has gone")
        return list(self._parts.pop(0))


def test_watch_writes_a_line_per_second_and_a_picture(recorded: Recorded) -> None:
    view = watch.View(RunIdentity(recorded.scenario), lines=True)
    with pytest.raises(BusLost):
        watch.watch(_Bus([frame for _, frame in recorded.frames]), view, lambda: None)  # type: ignore[arg-type]
    lines = view.new_lines()
    seconds = recorded.frames[-1][0] / 1e9
    assert seconds / 2.5 <= len(lines) <= seconds + 1
    assert "km/h (target" in lines[-1]
    assert view.new_lines() == []
    screen = Console(file=io.StringIO(), width=100, force_terminal=False)
    screen.print(view.picture())
    text = screen.file.getvalue()  # type: ignore[attr-defined]
    for words in ("true speed", "controller mode", "departed", recorded.scenario.title):
        assert words in text
    screen.print(watch.View(RunIdentity(recorded.scenario)).picture())
    assert "no run on the bus yet" in screen.file.getvalue()  # type: ignore[attr-defined]


def test_a_silent_port_has_no_value_in_watch(recorded: Recorded) -> None:
    """The speed is lost from 2 s to 3 s; the truth and its watch go on."""
    view = watch.View(RunIdentity(recorded.scenario))
    view.take([frame for _, frame in recorded.until(2.0)])
    assert view.values()["measured_speed_mps"] >= 0
    speed = set(recorded.trace().contract.port("TRN_SPEED").can_ids)
    screen = Console(file=io.StringIO(), width=100, force_terminal=False)
    screen.print(view.picture())
    view.take([frame for time_ns, frame in recorded.frames if 2e9 < time_ns <= 2.5e9 and frame.can_id not in speed])
    values = view.values()
    assert "measured_speed_mps" not in values
    assert "true_speed_mps" in values
    screen.print(view.picture())
    assert screen.file.getvalue().count("silent") == 1  # type: ignore[attr-defined]


def test_without_the_truth_watch_shows_no_values(recorded: Recorded) -> None:
    truth = set(recorded.trace().contract.port("SIM_TRUTH").can_ids)
    view = watch.View(RunIdentity(recorded.scenario))
    view.take([frame for time_ns, frame in recorded.until(2.0) if time_ns < 1e9 or frame.can_id not in truth])
    assert view.values() == {}
    screen = Console(file=io.StringIO(), width=100, force_terminal=False)
    screen.print(view.picture())
    assert "nothing is told of the train now" in screen.file.getvalue()  # type: ignore[attr-defined]


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Output:
    monkeypatch.setenv("TERM", "xterm")
    console = Output()
    console.file, console._force_terminal, console.width, console.is_interactive = io.StringIO(), True, 140, True
    return console


@contextmanager
def shown_line(
    recorded: Recorded, console: Output, folder: Path, start_up: StartUp | None = None
) -> Iterator[Progress]:
    """The progress line of a run into a folder."""
    spec = RunSpec(recorded.scenario.name, start_up=start_up or StartUp())
    line = Progress(lambda: console)
    with line.beside(Plan(spec, recorded.scenario, no_bus({}, spec.pace), folder)):
        yield line


@pytest.mark.parametrize(
    ("start_up", "law", "shown"),
    [
        (StartUp(foreign=True), "ipfc", "ipfc"),
        (StartUp(foreign=True), "", "unknown"),
        (StartUp(foreign=True, controller_name="ATO 3"), "", "ATO 3"),
        (StartUp(), "", "ipfc"),
    ],
)
def test_the_progress_line_names_no_law_that_nobody_has_confirmed(
    recorded: Recorded, terminal: Output, tmp_path: Path, start_up: StartUp, law: str, shown: str
) -> None:
    """The law that was asked for is not that of somebody else's controller, which may not say what it is."""
    own = set(recorded.trace().contract.port("CTL_IDENT").can_ids)
    said = [(time_ns, frame) for time_ns, frame in recorded.until(3.0) if law or frame.can_id not in own]
    (tmp_path / "frames.log").write_text("".join(log_line(time_ns, frame) for time_ns, frame in said))
    with shown_line(recorded, terminal, tmp_path, start_up) as line:
        line.on_progress(3.0)
        text = terminal.file.getvalue()  # type: ignore[attr-defined]
    assert [name for name in ("ipfc", "unknown", "ATO 3") if name in text] == [shown]


def test_the_progress_line_shows_the_run(recorded: Recorded, terminal: Output) -> None:
    with shown_line(recorded, terminal, recorded.log.parent) as line:
        line.on_progress(3.0)
        text = terminal.file.getvalue()  # type: ignore[attr-defined]
    assert "ipfc" in text
    assert "km/h (target" in text
    assert "m to go" in text


def test_the_progress_line_is_not_shown_where_there_is_no_terminal(recorded: Recorded) -> None:
    console = Output()
    console.file = io.StringIO()
    with shown_line(recorded, console, recorded.log.parent) as line:
        line.on_progress(3.0)
        line.on_progress(4.0)
    assert console.file.getvalue() == ""


def test_watch_names_the_notes_of_the_law(recorded: Recorded, monkeypatch: pytest.MonkeyPatch) -> None:
    """The notes have the names that the law of the handshake declares, or that of ``--controller``; else numbers."""
    own = set(recorded.trace().contract.port("CTL_IDENT").can_ids)
    whole = [frame for _, frame in recorded.frames]
    # Before PLT_IDENT is repeated.
    untold = [frame for _, frame in recorded.until(1.2) if frame.can_id not in own]
    bus = _Bus(whole)
    bus.close = lambda: None  # type: ignore[attr-defined]
    views: list[watch.View] = []
    monkeypatch.setattr(watch, "named_scenario", lambda *asked: recorded.scenario)
    monkeypatch.setattr(watch, "listening", lambda config: bus)
    monkeypatch.setattr(watch, "watch", lambda link, view, show: views.append(view))
    parser = OneLineParser()
    watch.add_parser(parser.add_subparsers())
    texts = []
    for frames, arguments in ((untold, ["--controller", "ipfc"]), (untold, []), (whole, [])):
        namespace = parser.parse_args(["watch", "-i", "railhil", "-c", "x", *arguments])
        assert watch.work(namespace) == 0
        views[-1].take(frames)
        screen = Console(file=io.StringIO(), width=100, force_terminal=False)
        screen.print(views[-1].picture())
        texts.append(screen.file.getvalue())  # type: ignore[attr-defined]
    assert ["note 2" in text for text in texts] == [False, True, False]
    assert ["softening factor" in text for text in texts] == [True, False, True]
    namespace = parser.parse_args(["watch", "-i", "railhil", "-c", "x", "--controller", "no_such_law"])
    with pytest.raises(InputError, match="no_such_law"):
        watch.work(namespace)
    monkeypatch.undo()
    with pytest.raises(InputError, match="no_such_law"):
        watch.work(namespace)
    with pytest.raises(InputError, match="--set: used only after a SCENARIO"):
        watch.work(parser.parse_args(["watch", "-i", "railhil", "-c", "x", "--set", "plan.distance_m=1"]))
