"""What happens to a controller under faults of its node and of the bus, and what leaves in place of its answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.bus.codes import Event
from railhil.bus.frame import BRS, FD, REMOTE, Frame
from railhil.bus.ident import CtlIdent
from railhil.bus.injector.controller_side import FaultyController
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, SupCmd, TimeSync
from railhil.dbc import Contract, Port, wire_contract
from railhil.faults.language import parse
from railhil.faults.model import Injection
from railhil.wire.ato import CtlStat, NotchCmd, TrnSpeed

MS = 1_000_000
CONTRACT = wire_contract()
NOTCH, STATUS = NotchCmd.port(), CtlStat.port()
POLL, POLL_STATUS = (master_frame(port.f_code, port.address) for port in (NOTCH, STATUS))
NO_NOTCH, NO_STATUS = Frame(NOTCH.address, b""), Frame(STATUS.can_ids[-1], b"")


def answer(port: Port, number: int, fd: bool = False) -> list[Frame]:
    return TelegramSource(port, fd).frames(bytes([number]) * port.data_bytes)


class Node:
    """A controller that numbers its answers and says which frames it has got."""

    def __init__(self, lockstep: bool, fd: bool, tells: bool) -> None:
        self.lockstep, self.ended, self._fd = lockstep, None, fd
        self.got: list[Frame] = []
        self.stopped_ns: list[int] = []
        self.law = "own"
        if tells:
            self.received = {"ports": {"TRN_SPEED": {"committed": 0}}, "frames": {}, "gaps": []}

    def handle(self, frame: Frame) -> list[Frame]:
        self.got.append(frame)
        if hasattr(self, "received") and frame.can_id == TrnSpeed.port().address:
            self.received["ports"]["TRN_SPEED"]["committed"] += 1
        if frame == POLL:
            return answer(NOTCH, len(self.got))
        if frame == POLL_STATUS:
            return answer(STATUS, len(self.got), self._fd)
        # What it sends without a poll of the run.
        return [frame] if frame.can_id == CONTRACT.poll_id else []

    def was_stopped(self, sim_ns: int) -> None:
        self.stopped_ns.append(sim_ns)


class Bench:
    """The controller under faults, tick by tick."""

    def __init__(
        self, *faults: str, lockstep: bool = True, fd: bool = False, tells: bool = True, folder: Path | None = None,
        kills: bool = False, pauses: bool = False, contract: Contract = CONTRACT,
    ) -> None:  # fmt: skip
        self.nodes: list[Node] = []
        self.killed: list[bool] = []
        self.paused_s: list[float] = []

        def make() -> Node:
            self.nodes.append(Node(lockstep, fd, tells))
            return self.nodes[-1]

        schedule = Schedule.from_contract(10 * MS, {}, CONTRACT)
        injection = Injection(tuple(map(parse, faults)), np.random.default_rng)
        node_faults = NodeFaults(injection, CONTRACT, schedule, "controller", folder)
        self.log = node_faults.activities.log
        self.under = FaultyController(
            make, node_faults, contract,
            (lambda: self.killed.append(bool(folder and list(folder.glob("faults-*"))))) if kills else None,
            self.paused_s.append if pauses else None,
        )  # fmt: skip
        self._tick = -1

    def tick(self, until: int | None = None) -> list[Frame]:
        """The next tick, or all until this one; what the controller sends."""
        found: list[Frame] = []
        until = self._tick + 1 if until is None else until
        while self._tick < until:
            self._tick += 1
            (frame,) = speed_frames(self._tick)
            found += self.under.handle(frame)
        return found

    def poll(self, frame: Frame = POLL) -> list[Frame]:
        return self.under.handle(frame)

    def said(self) -> list[tuple[int, str, str]]:
        return [(hit.time_ns // MS, hit.before, hit.after) for hit in self.log.hits]

    def gaps(self) -> list[tuple[bool, int, int]]:
        """Of each gap: restarted, first TRN_SPEED missed, how many."""
        told = self.under.received
        assert told is not None
        speeds = [(gap["restarted"], gap["ports"]["TRN_SPEED"]) for gap in told["gaps"]]
        return [(restarted, port["first"], port["count"]) for restarted, port in speeds]


def speed_frames(tick: int) -> list[Frame]:
    return TelegramSource(TrnSpeed.port()).frames(TrnSpeed(tick, life=tick % 16).encode())


def test_without_an_active_fault_everything_passes() -> None:
    bench = Bench("NOTCH_CMD loss @1s")
    assert bench.tick() == []
    assert bench.poll() == answer(NOTCH, 2)
    assert bench.poll(POLL_STATUS) == answer(STATUS, 3)
    # What is not asked for by a poll of the run is none of the faults' business.
    ident = master_frame(CtlIdent.port().f_code, CtlIdent.port().address)
    for frame in (ident, POLL._replace(flags=REMOTE), POLL._replace(data=b"\0\0\0")):
        assert bench.poll(frame) == [frame]
    assert (bench.under.law, bench.under.ended, bench.under.is_gone) == ("own", None, False)
    assert bench.said() == []


@pytest.mark.parametrize("lockstep", [True, False])
def test_an_answer_that_is_lost_is_said_to_be_none_in_lockstep(lockstep: bool) -> None:
    bench = Bench("NOTCH_CMD loss @0s", "CTL_STAT loss @0s", lockstep=lockstep)
    bench.tick()
    assert bench.poll() == ([NO_NOTCH] if lockstep else [])
    assert bench.poll(POLL_STATUS) == ([NO_STATUS] if lockstep else [])
    assert [row[2] for row in bench.said()] == ["lost", "lost"]
    # A command of another node is not its own.
    supervisor = SupCmd.port()
    assert bench.poll(master_frame(supervisor.f_code, supervisor.address))[0].can_id == CONTRACT.poll_id


def test_an_answer_that_nobody_can_take_is_followed_by_none() -> None:
    bench = Bench("NOTCH_CMD remote @0s")
    bench.tick()
    left = bench.poll()
    assert [frame.flags for frame in left] == [REMOTE, 0]
    assert left[1] == NO_NOTCH
    bench = Bench("CTL_STAT masquerade TRK_INFO @0s")
    bench.tick()
    assert bench.poll(POLL_STATUS)[-1] == NO_STATUS
    # A wrong check sequence is an answer.
    bench = Bench("CTL_STAT.checksum value 0 @0s")
    bench.tick()
    assert len(bench.poll(POLL_STATUS)) == len(answer(STATUS, 1))


@pytest.mark.parametrize("flags", [FD, FD | BRS])
def test_answers_in_can_fd(flags: int) -> None:
    bench = Bench("CTL_STAT.checksum value 0 @0s", fd=True)
    bench.tick()
    (frame,) = bench.poll(POLL_STATUS)
    assert (frame.can_id, frame.flags & FD) == (STATUS.fd_id, FD)
    assert Bench("CTL_STAT loss @1s", fd=True).poll(POLL_STATUS) == answer(STATUS, 1, fd=True)
    bench = Bench("CTL_STAT loss @0s", fd=True)
    bench.tick()
    assert bench.poll(POLL_STATUS) == [NO_STATUS]


def test_the_instants_of_its_own_answers_are_seen() -> None:
    """An event that the controller itself tells begins a fault."""
    bench = Bench("NOTCH_CMD loss @9s")
    seen = bench.under.faults.see
    told: list[Frame] = []
    bench.under.faults.see = lambda frame: told.append(frame) or seen(frame)  # type: ignore[method-assign, func-returns-value]
    bench.poll()
    assert told == [POLL, *answer(NOTCH, 1)]


def test_killed(tmp_path: Path) -> None:
    bench = Bench("node.controller kill @20ms", kills=True, folder=tmp_path)
    bench.tick(1)
    assert bench.poll() == answer(NOTCH, 3)
    bench.tick(2)
    assert bench.under.is_gone
    # Its log is written before the process ends.
    assert bench.killed == [True]
    assert bench.said() == [(20, "running", "killed")]
    assert bench.poll() == []
    bench.tick(5)
    # Three ticks, and the one of the instant itself.
    assert bench.gaps() == [(False, 2, 4)]
    assert bench.killed == [True]
    assert len(bench.nodes[0].got) == 3
    assert bench.said() == [(20, "running", "killed")]


def test_killed_in_the_process_of_the_others() -> None:
    bench = Bench("node.controller kill @0s", tells=False)
    bench.tick()
    assert bench.under.is_gone
    assert bench.poll() == []
    assert bench.under.received is None


def test_killed_after_another_gap() -> None:
    bench = Bench("node.controller stop @10ms for 10ms", "node.controller kill @40ms")
    bench.tick(6)
    assert bench.gaps() == [(False, 1, 1), (False, 4, 3)]


def test_killed_while_it_is_stopped() -> None:
    """The end of the other fault brings it back no more."""
    for what in ("stop", "restart"):
        bench = Bench(f"node.controller {what} @10ms for 40ms", "node.controller kill @30ms")
        bench.tick(4)
        assert bench.gaps() == [(False, 1, 4)]
        bench.tick(6)
        assert bench.gaps() == [(False, 1, 6)]
        assert len(bench.nodes) == 1
        assert bench.nodes[0].stopped_ns == []


def test_stopped_for_a_time() -> None:
    bench = Bench("node.controller stop @20ms for 30ms")
    bench.tick(1)
    assert bench.tick() == []
    assert bench.poll() == [NO_NOTCH]
    assert bench.gaps() == [(False, 2, 1)]
    bench.tick(4)
    assert bench.nodes[0].stopped_ns == []
    assert bench.said() == [(20, "running", "stopped")]
    bench.tick(5)
    # From 20 to 50 ms its timer ran on.
    assert bench.nodes[0].stopped_ns == [30 * MS]
    assert [frame.can_id for frame in bench.nodes[0].got] == [0x118] * 3
    assert bench.poll() == answer(NOTCH, 4)
    assert bench.gaps() == [(False, 2, 3)]
    assert len(bench.nodes) == 1


def test_stopped_from_the_first_instant_on() -> None:
    bench = Bench("node.controller stop @0s for 10ms")
    bench.tick(1)
    assert bench.nodes[0].stopped_ns == [10 * MS]


def test_what_came_meanwhile_is_delivered() -> None:
    bench = Bench("node.controller stop @20ms for 30ms after deliver")
    bench.tick(2)
    bench.poll()
    bench.tick(5)
    # Late answers go nowhere.
    assert [frame.can_id for frame in bench.nodes[0].got] == [0x118, 0x118, 0x118, 0x80, 0x118, 0x118, 0x118]
    assert bench.nodes[0].stopped_ns == []
    assert bench.gaps() == []


def test_only_polls_of_its_own_ports_are_answered_with_none() -> None:
    ports = (replace(port, mode="publish") if port.name == STATUS.name else port for port in CONTRACT.ports)
    bench = Bench("node.controller stop @0s", contract=replace(CONTRACT, ports=tuple(ports)))
    bench.tick()
    assert (bench.poll(), bench.poll(POLL_STATUS)) == ([NO_NOTCH], [])


def test_two_stops_of_which_one_delivers() -> None:
    """While the delivering one lasts it delivers nothing."""
    bench = Bench(
        "node.controller stop @20ms for 10ms combine", "node.controller stop @50ms for 10ms after deliver combine"
    )
    bench.tick(3)
    assert bench.nodes[0].stopped_ns == [10 * MS]
    bench.tick(6)
    assert bench.nodes[0].stopped_ns == [10 * MS]
    assert bench.gaps() == [(False, 2, 1)]


def test_stopped_in_real_time() -> None:
    bench = Bench("node.controller stop @20ms for 30ms", lockstep=False, pauses=True)
    for frame in TelegramSource(TimeSync.port()).frames(TimeSync(0, 0, 20).encode()):
        bench.under.handle(frame)
    bench.tick(2)
    # 30 ms at twice real time; afterwards it goes on by itself.
    assert bench.paused_s == [pytest.approx(0.015)]
    assert bench.poll() == answer(NOTCH, 6)
    assert bench.nodes[0].stopped_ns == []
    bench.tick(5)
    assert bench.paused_s == [pytest.approx(0.015)]
    for settings in ({"pauses": True}, {"lockstep": False}):
        bench = Bench("node.controller stop @0s for 30ms", **settings)  # type: ignore[arg-type]
        bench.tick()
        assert bench.paused_s == []
        assert bench.nodes[0].got == []
    # Without a duration nobody would continue it.
    bench = Bench("node.controller stop @0s", lockstep=False, pauses=True)
    bench.tick()
    assert bench.paused_s == []


def test_restarted() -> None:
    bench = Bench("node.controller restart @20ms for 30ms")
    bench.tick(2)
    assert bench.poll() == [NO_NOTCH]
    bench.tick(4)
    assert bench.said() == [(20, "running", "ended")]
    assert len(bench.nodes) == 1
    bench.tick(7)
    assert len(bench.nodes) == 2
    assert bench.nodes[0].stopped_ns == bench.nodes[1].stopped_ns == []
    assert len(bench.nodes[1].got) == 3
    assert bench.poll() == answer(NOTCH, 4)
    told: Any = bench.under.received
    # Of both: 0 and 1, then 5, 6 and 7.
    assert told["ports"]["TRN_SPEED"]["committed"] == 5
    assert bench.gaps() == [(True, 2, 3)]
    assert bench.said() == [(20, "running", "ended")]


def test_answers_of_a_slow_controller_are_gone_when_it_is_made_anew() -> None:
    """A hunt found this: a command of before a restart of 6 s was sent after it."""
    bench = Bench("node.controller slow 30ms @0s", "node.controller restart @20ms for 30ms")
    bench.tick(0)
    assert bench.poll() == [NO_NOTCH]
    assert bench.poll(POLL_STATUS) == [NO_STATUS]
    bench.tick(6)
    # Answers of before would be due by now.
    assert len(bench.nodes) == 2
    assert bench.poll() == [NO_NOTCH]
    assert bench.poll(POLL_STATUS) == [NO_STATUS]
    bench.tick(9)
    # The first answer of the new one has number 3 there: ticks 5 and 6 came before.
    assert bench.poll() == answer(NOTCH, 3)
    assert bench.poll(POLL_STATUS) == answer(STATUS, 4)


def test_telegrams_that_a_fault_of_the_bus_delays_outlive_the_controller() -> None:
    bench = Bench("NOTCH_CMD delay 30ms @0s", "node.controller restart @20ms for 10ms")
    bench.tick(0)
    assert bench.poll() == [NO_NOTCH]
    bench.tick(6)
    assert len(bench.nodes) == 2
    assert bench.poll() == answer(NOTCH, 2)


def test_restarted_without_a_document() -> None:
    bench = Bench("node.controller restart @0s for 10ms", tells=False)
    bench.tick(1)
    assert len(bench.nodes) == 2
    assert bench.under.received is None


def test_a_restart_is_over_when_it_is_stopped_again() -> None:
    bench = Bench("node.controller restart @10ms for 10ms", "node.controller stop @40ms for 10ms")
    bench.tick(5)
    assert len(bench.nodes) == 2
    assert bench.nodes[1].stopped_ns == [10 * MS]
    assert bench.gaps() == [(True, 1, 1), (False, 4, 1)]


@pytest.mark.parametrize("what", ["off", "down"])
def test_a_silent_bus(what: str) -> None:
    bench = Bench(f"bus {what} @10ms for 20ms")
    bench.tick(1)
    assert bench.poll() == [NO_NOTCH]
    assert bench.poll(POLL_STATUS) == [NO_STATUS]
    bench.tick(3)
    assert bench.said() == [(10, f"poll of {poll.data.hex()}", "lost") for poll in (POLL, POLL_STATUS)]
    assert bench.nodes[0].stopped_ns == [20 * MS]
    assert bench.poll() == answer(NOTCH, 3)


def test_a_silence_that_is_not_active_counts_no_polls() -> None:
    bench = Bench("bus off @9s", "node.controller stop @0s")
    bench.tick()
    bench.poll()
    assert bench.said() == [(0, "running", "stopped")]


def test_what_ended_the_run() -> None:
    bench = Bench("node.controller stop @0s")
    bench.tick()
    for frame in TelegramSource(RunEvent.port()).frames(RunEvent(Event.ENDED_COMPLETE, number=1).encode()):
        bench.under.handle(frame)
    assert bench.nodes[0].ended is None
    # A stopped controller does not see it.
    assert bench.under.ended is Event.ENDED_COMPLETE
    bench.nodes[0].ended = Event.ENDED_REFUSED  # type: ignore[assignment]
    assert bench.under.ended is Event.ENDED_REFUSED
