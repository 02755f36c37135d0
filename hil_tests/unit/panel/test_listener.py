"""What the panel makes of frames: the same rows as signals.csv, also when frames are missing; bounded memory."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hil_tests.support.panel import Recorded, ScriptedLink
from railhil.bus.codes import SupCommand
from railhil.bus.errors import BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.telegrams import SupCmd
from railhil.cli.run_identity import RunIdentity
from railhil.live.bus_follower import Listener
from railhil.panel import live as live_module
from railhil.panel.bus_statistics import BusStatistics
from railhil.panel.history import HISTORY_ROWS_MAX, History
from railhil.panel.layout import ERROR, make_layout
from railhil.panel.live import LiveRun
from railhil.panel.live_orders import LiveOrders
from railhil.panel.operator import Operator
from railhil.panel.receiver import LOOK_FRAMES, Receiver
from railhil.panel.recorded import thin_rows
from railhil.panel.server import RATE_HZ
from railhil.record.trace import Trace
from railhil.scenarios.load import load_any
from railhil.scenarios.scenario_documents import nominal_sha256
from railhil.scenarios.system import names, system_named


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return Recorded(tmp_path_factory.mktemp("run"))


@pytest.mark.parametrize("look", [1, 50, 100_000])
def test_rows_are_those_of_the_whole_record_however_the_frames_come(run, look):
    frames = run.frames[:300] if look == 1 else run.frames
    found = run.heard(frames, look)
    np.testing.assert_allclose(found, run.rows[: len(found)], rtol=0, atol=1e-9)
    assert len(found) >= 0.8 * len(frames) / len(run.frames) * len(run.rows)


def test_the_tracking_error_is_target_less_speed(run):
    names_ = [column.name for column in run.layout.columns]
    error = run.rows[:, 1 + names_.index(ERROR)]
    target, speed = run.rows[:, 1 + run.layout.target], run.rows[:, 1 + run.layout.speed]
    np.testing.assert_array_equal(error, target - speed)
    assert run.layout.columns[run.layout.speed].unit == "km/h"


def test_frames_that_were_left_out_do_not_move_the_time(run):
    """As after a look that dropped the oldest: 50 ms are missing, the rest has its instants."""
    beside = run.frames[:2000] + run.frames[2030:]
    found = run.heard(beside, 100)
    assert found[-1, 0] == pytest.approx(run.rows[-1, 0], abs=0.03)
    np.testing.assert_allclose(found[-5:, 1:], run.rows[-5:, 1:], rtol=0, atol=0.2)


def test_the_time_goes_on_without_the_clock_port(run):
    speed = set(run.contract.clock_port.can_ids)
    without = run.frames[:1000] + [frame for frame in run.frames[1000:] if frame.can_id not in speed]
    assert run.heard(without, 100)[-1, 0] == pytest.approx(run.rows[-1, 0], abs=0.05)


def test_polls_and_load_are_counted(run):
    heard = BusStatistics(run.contract)
    listener = Listener(run.scenario, run.contract, heard)
    notch = set(run.contract.port("NOTCH_CMD").can_ids)
    listener.take(frame for number, frame in enumerate(run.frames) if frame.can_id not in notch or number < 2000)
    assert heard.missed["NOTCH_CMD"] > 10
    assert sum(heard.missed.values()) == heard.missed["NOTCH_CMD"]
    assert heard.load is not None
    assert 0.05 < heard.load < 0.4


def test_another_run_begins_with_its_handshake(run):
    listener = Listener(run.scenario, run.contract)
    listener.take(run.frames)
    before = listener.run
    listener.take(run.frames[:200])
    assert listener.run == before + 1
    assert listener.now_s < 1.0


def test_too_many_frames_cost_the_oldest_and_are_counted():
    frames = [Frame(0x100 + number % 8, b"", 0) for number in range(LOOK_FRAMES + 10)]
    receiver = Receiver({}, lambda config, name: ScriptedLink(frames, []))
    assert receiver.look() == frames[10:]
    assert receiver.dropped == 10


def test_a_bus_that_goes_is_opened_again():
    links = [ScriptedLink([Frame(1, b"")], []), ScriptedLink([])]
    opened: list[ScriptedLink] = []

    def open_bus(config: object, name: str) -> ScriptedLink:
        if not links:
            raise BusUnavailable("not there")
        opened.append(links.pop(0))
        return opened[-1]

    receiver = Receiver({}, open_bus)
    receiver._retry_s = 0.0
    assert len(receiver.look()) == 1
    assert receiver.look() == []
    assert receiver.trouble == "gone"
    assert opened[0].closed
    receiver._retry_s = 0.0
    receiver.look()
    assert receiver.is_open


def test_a_hub_is_joined_as_soon_as_its_socket_is_there(tmp_path):
    """Not half a second later: by then a run in lockstep is half over."""
    attempts: list[bool] = []

    def open_bus(config: object, name: str) -> ScriptedLink:
        attempts.append(channel.exists())
        if len(attempts) < 3:
            raise BusUnavailable("not there")
        return ScriptedLink([])

    channel = tmp_path / "hub.sock"
    receiver = Receiver({"interface": "railhil", "channel": str(channel)}, open_bus)
    for _ in range(5):
        receiver.look()
    assert attempts == [False]
    channel.touch()
    # It does not answer yet at the first look.
    receiver.look()
    receiver.look()
    assert attempts == [False, True, True]
    assert receiver.is_open


def test_a_socket_without_a_hub_is_tried_now_and_then(tmp_path):
    attempts: list[float] = []

    def open_bus(config: object, name: str) -> ScriptedLink:
        attempts.append(0.0)
        raise BusUnavailable("nobody answers")

    (tmp_path / "hub.sock").touch()
    receiver = Receiver({"interface": "railhil", "channel": str(tmp_path / "hub.sock")}, open_bus)
    for _ in range(20):
        receiver.look()
    assert len(attempts) == 2


def test_memory_is_bounded():
    history = History(3)
    for start in range(0, 10 * HISTORY_ROWS_MAX, 1000):
        rows = np.arange(start, start + 1000, dtype=float)[:, None].repeat(3, axis=1)
        history.add(rows)
    kept = history.rows[:, 0]
    assert len(kept) <= HISTORY_ROWS_MAX
    assert kept[0] == 0
    assert kept[-1] > 9.9 * HISTORY_ROWS_MAX
    assert (np.diff(kept) > 0).all()


def test_a_long_record_keeps_its_extremes():
    rows = np.zeros((200_000, 2))
    rows[:, 0] = np.arange(len(rows))
    rows[123_457, 1], rows[77_777, 1] = 9.0, -9.0
    found = thin_rows(rows)
    assert len(found) <= 40_000
    assert (found[:, 1].min(), found[:, 1].max()) == (-9.0, 9.0)
    assert (np.diff(found[:, 0]) >= 0).all()


def test_every_system_has_a_layout_from_what_it_declares():
    scenarios = {"ato": "lvshun_tieshan", "hst1": "jinan_xuzhou", "emu3": "jinan_xuzhou_emu3", "stop": "yizhuang_stop"}
    for name in set(names()) & scenarios.keys():
        scenario, system = load_any(scenarios[name]), system_named(name)
        layout = make_layout(scenario, system.contract, None)
        assert layout.speed >= 0
        assert layout.position >= 0
        assert layout.command >= 0
        assert layout.tracks
        assert layout.charts[0].title == "speed"
    contract = system_named("emu3").contract
    emu3 = [column.name for column in make_layout(load_any("jinan_xuzhou_emu3"), contract, None).columns]
    assert {"true_speed1_mps", "true_speed3_mps", "coupler1_kn", "coupler2_kn"} <= set(emu3)


def test_the_list_of_frames_does_not_come_at_every_look_where_nobody_sees_it(run, monkeypatch):
    now_s = [100.0]
    monkeypatch.setattr(live_module.time, "monotonic", lambda: now_s[0])
    live = LiveRun(RunIdentity(run.scenario), Receiver({}, lambda config, name: ScriptedLink(*[[]] * 30)))
    told, lists = [], 0
    for _ in range(20):
        told += [next(iter(json.loads(message))) for message in live.look()]
        lists += bool(live.list_frames())
        now_s[0] += 1.0 / RATE_HZ
    assert (told.count("state"), told.count("frames"), lists) == (20, 4, 20)


def test_pages_are_told_events_and_frames(run):
    live = LiveRun(RunIdentity(run.scenario), Receiver({}, lambda config, name: ScriptedLink(run.frames[:4000], [])))
    live.look()
    events = [event["text"] for event in live._events.all]
    assert "departed" in events
    rows = {row[1]: row for row in live._list.list_rows(live.listener, live.heard)}
    assert rows["TRN_SPEED"][2] > 100
    assert rows["TRN_SPEED"][3] == 10.0
    assert "TrainSpeed" in rows["TRN_SPEED"][6]
    assert "SupCommand start" in rows["SUP_CMD"][6]


def test_a_run_with_faults_of_the_operator_is_no_other_scenario(run: Recorded) -> None:
    """As in containers, whose panel is not given the faults of the nodes, and after a fault was added with --wait."""
    other = replace(run.scenario, sha256="0" * 64)
    found = []
    for faults in ([], ["safety_loop off @manual"]):
        operator = Operator("nowhere")
        operator.report = {"phase": "running", "faults": faults}
        receiver = Receiver({}, lambda config, name: ScriptedLink(run.frames[:4000], []))
        live = LiveRun(RunIdentity(other), receiver, operator)
        live.look()
        operator.report = {"phase": "running", "faults": faults}
        told = [json.loads(message) for message in live.read_past() if isinstance(message, str)]
        found += [bool(one["state"]["notices"]) for one in told if "state" in one]
        assert live.layout.target >= 0 if faults else live.layout.target == -1
    assert found == [True, False]


def test_the_verdict_of_a_run_is_not_that_of_the_next_one(run: Recorded) -> None:
    """As when the next run is started without --operator: nobody tells of its end."""
    operator = Operator("nowhere")
    links = ScriptedLink(run.frames[:2000], [], [], run.frames[:2000])
    live = LiveRun(RunIdentity(run.scenario), Receiver({}, lambda config, name: links), operator)
    live.look()
    operator.report = {"phase": "ended", "verdict": "PASS"}
    live.look()
    assert operator.report["verdict"] == "PASS"
    live.look()
    assert operator.report == {}


@pytest.mark.parametrize("settings", [[], ["plan.overtime_max_s=2"]])
def test_another_scenario_with_faults_of_the_operator_is_not_shown_as_the_named_one(
    run: Recorded, settings: list[str]
) -> None:
    """Its target and its line would be values that the run does not have, also under the name of the run."""
    named = load_any(run.path, settings) if settings else load_any("yizhuang_05")
    operator = Operator("nowhere")
    report = {"phase": "ended", "scenario": nominal_sha256(run.scenario), "faults": ["safety_loop off @manual"]}
    operator.report = report
    receiver = Receiver({}, lambda config, name: ScriptedLink(run.frames[:4000], []))
    live = LiveRun(RunIdentity(named), receiver, operator)
    live.look()
    assert live.layout.target == -1
    assert "no scenario here has the hash" in live._list_notices()[0]


def test_a_command_that_is_none_does_not_end_the_panel(run: Recorded) -> None:
    trace = Trace(run.contract)
    for life, command in enumerate((SupCommand.START, 7)):
        trace.add(SupCmd.PORT, life * 160_000_000, SupCmd(command=command, life=life).encode())

    def add(time_s: float, kind: str, source: str, text: str) -> dict[str, Any]:
        return {"text": text}

    assert LiveOrders(list, add, run.scenario.installed_system).find(trace) == [{"text": "command 7"}]
