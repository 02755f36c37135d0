"""Time, motion, events and orders of a run as the injectors read them from its frames."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.bus.codes import Event, FaultOrder
from railhil.bus.frame import Frame
from railhil.bus.injector.follower import Follower, raw_of
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, SupCmd, TimeSync
from railhil.dbc import Signal, wire_contract
from railhil.faults.model import Injection, Truth
from railhil.wire.ato import CtlMode, NotchCmd, SimTruth, TrnPos, TrnSpeed, TrnWatch

MS = 1_000_000
TICK_NS = 10 * MS
CONTRACT = wire_contract()
TRUTH = Truth(
    "SIM_TRUTH", "TruePos", "TrueSpeed", "TrueAccel", "TractionForce",
    {"TRN_WATCH": "WatchLevel", "NOTCH_CMD": "CtlMode"}, ("TRN_WATCH",),
)  # fmt: skip


def made(
    at_plant: bool = True, truth: Truth | None = TRUTH, tick_ns: int = TICK_NS, overrides: dict[str, int] | None = None
) -> Follower:
    injection = Injection((), np.random.default_rng, truth, events={40: "own_event"})
    schedule = Schedule.from_contract(tick_ns, overrides or {}, CONTRACT)
    return Follower(injection, CONTRACT, schedule, at_plant=at_plant)


def frames(telegram: Telegram) -> list[Frame]:
    return TelegramSource(type(telegram).port()).frames(telegram.encode())


def see(follower: Follower, telegram: Telegram) -> bool:
    """Whether one of its frames begins an instant; before the last one none does."""
    *first, last = frames(telegram)
    assert not any(follower.see(frame) for frame in first)
    return follower.see(last)


def test_a_raw_value() -> None:
    signal = Signal("X", byte=1, msb=5, length=3)
    assert [raw_of(bytes((0xFF, octet, 0xFF)), signal) for octet in (0xC7, 0xFF, 0xD7, 0xE7)] == [0, 7, 2, 4]
    signed = Signal("X", byte=1, msb=5, length=3, signed=True)
    assert [raw_of(bytes((0, octet, 0)), signed) for octet in (0x18, 0x20, 0x60, 0x38, 0x00)] == [3, -4, -4, -1, 0]


def test_what_it_knows_at_first() -> None:
    follower = made()
    assert (follower.now_ns, follower.position_m, follower.speed_mps, follower.rate) == (-1, 0.0, 0.0, 0.0)
    assert (follower.ended, follower.take_events(), follower.take_orders()) == (None, [], [])
    assert follower.wall_s(2.0) == 2.0


@pytest.mark.parametrize("begins", [0, 14, 15])
def test_ticks_by_the_port_that_opens_them(begins: int) -> None:
    follower = made()
    assert follower.clock_ids == {TrnSpeed.port().address, TrnSpeed.port().fd_id}
    assert see(follower, TrnSpeed(0, life=begins))
    assert not see(follower, TrnSpeed(9, life=begins))
    assert follower.now_ns == 0
    assert see(follower, TrnSpeed(0, life=(begins + 1) % 16))
    assert follower.now_ns == TICK_NS
    # A repeated one is not a new instant; lost ones are bridged.
    assert not see(follower, TrnSpeed(9, life=(begins + 1) % 16))
    assert follower.now_ns == TICK_NS
    assert see(follower, TrnSpeed(0, life=(begins + 5) % 16))
    assert follower.now_ns == 5 * TICK_NS
    assert see(follower, TrnSpeed(0, life=(begins + 4) % 16))
    assert follower.now_ns == 20 * TICK_NS
    # Nothing else is a tick here.
    assert not see(follower, SimTruth(0, 0, life=3))
    assert not follower.see(Frame(0x7E0, b"\0"))
    assert not follower.see(Frame(TrnSpeed.port().address, b""))
    assert follower.now_ns == 20 * TICK_NS


def test_ticks_by_the_truth_elsewhere() -> None:
    follower = made(at_plant=False)
    port = SimTruth.port()
    assert follower.clock_ids == {*port.can_ids, port.fd_id}
    assert not see(follower, TrnSpeed(0, life=1))
    assert see(follower, SimTruth(0, 0, life=1))
    assert see(follower, SimTruth(0, 0, life=2))
    assert follower.now_ns == 20 * MS
    # Without a truth by the clock port at every node.
    assert see(made(at_plant=False, truth=None), TrnSpeed(0))
    slow = made(at_plant=False, overrides={"SIM_TRUTH": 50 * MS})
    see(slow, SimTruth(0, 0, life=1))
    see(slow, SimTruth(0, 0, life=2))
    assert slow.now_ns == 50 * MS


def test_a_clock_port_without_a_life_sign_ticks_with_each_telegram() -> None:
    follower = made()
    follower._life_signal = None
    assert [see(follower, TrnSpeed(0, life=3)) for _ in range(3)] == [True] * 3
    assert follower.now_ns == 2 * TICK_NS


def test_motion_in_its_units() -> None:
    follower = made()
    see(follower, SimTruth(123_456, -20_000))
    assert (follower.position_m, follower.speed_mps) == (pytest.approx(12.3456), pytest.approx(-2.0))
    # Other positions and speeds are not the truth.
    see(follower, TrnPos(5000))
    see(follower, TrnSpeed(7000))
    assert follower.position_m == pytest.approx(12.3456)
    # A telegram in pieces, more than a tick apart, is none.
    first, *rest = frames(SimTruth(1, 1))
    follower.see(first)
    see(follower, TrnSpeed(7000, life=1))
    assert not any(follower.see(frame) for frame in rest)
    assert follower.speed_mps == pytest.approx(-2.0)
    partial = made(truth=Truth("SIM_TRUTH", speed="TrueSpeed"))
    see(partial, SimTruth(123_456, 20_000, accel_01mmps2=-5000, traction_20n=7))
    assert (partial.position_m, partial.speed_mps, partial.take_events()) == (0.0, 2.0, [])
    see(made(truth=None), SimTruth(123_456, 20_000))


def events(follower: Follower, *telegrams: Telegram) -> list[list[str]]:
    found = []
    for telegram in telegrams:
        see(follower, telegram)
        found.append(follower.take_events())
    assert follower.take_events() == []
    return found


def test_events_of_the_motion() -> None:
    follower = made()
    assert events(follower, SimTruth(0, 0), SimTruth(0, 1), SimTruth(0, 0), SimTruth(0, 0), SimTruth(0, -1)) == [
        [], [], ["standstill"], [], [],
    ]  # fmt: skip
    # 0.3 m/s2 is braking.
    accels = [SimTruth(0, 0, accel_01mmps2=accel) for accel in (-2999, -3000, -5000, -2999, -3001)]
    assert events(made(), *accels) == [[], ["braking"], [], [], ["braking"]]
    forces = [SimTruth(0, 0, traction_20n=force) for force in (0, 1, 2, 0, 3)]
    assert events(made(), *forces) == [[], ["traction"], [], [], ["traction"]]
    # However small its unit is.
    assert events(made(truth=Truth("SIM_TRUTH", traction="TrueAccel")), SimTruth(0, 0, accel_01mmps2=1)) == [
        ["traction"]
    ]
    assert events(made(), SimTruth(0, 9), SimTruth(0, 0, accel_01mmps2=-9999, traction_20n=1)) == [
        [], ["standstill", "braking", "traction"],
    ]  # fmt: skip


def test_levels_of_the_watches() -> None:
    follower = made()
    assert events(follower, TrnWatch(0), TrnWatch(2), TrnWatch(2), TrnWatch(0), TrnWatch(7)) == [
        [], ["traction_cut"], [], ["normal"], [""],
    ]  # fmt: skip
    modes = [NotchCmd(0, mode=mode) for mode in (CtlMode.INITIALISING, CtlMode.RUNNING, CtlMode.HOLD, CtlMode.HOLD)]
    assert events(follower, *modes) == [[], ["running"], ["hold"], []]


def test_milestones() -> None:
    follower = made()
    found = events(
        follower, RunEvent(Event.DEPARTED, number=1), RunEvent(Event.DEPARTED, number=1),
        RunEvent(Event.STOPPED, number=2), RunEvent(40, number=3), RunEvent(41, number=4),
    )  # fmt: skip
    assert found == [["departed"], [], ["stopped"], ["own_event"], [""]]
    assert follower.ended is None
    # Number 0 is none.
    assert events(follower, RunEvent(Event.ENDED_COMPLETE, number=4)) == [[]]
    assert events(made(), RunEvent(Event.STOPPED, number=0)) == [[]]
    assert follower.ended is None
    assert events(follower, RunEvent(Event.ENDED_NOT_STOPPED, number=5)) == [["ended_not_stopped"]]
    assert follower.ended is Event.ENDED_NOT_STOPPED


def test_orders_by_hand() -> None:
    follower = made()
    for order in (
        SupCmd(0, 3, FaultOrder.INJECT, life=1), SupCmd(0, 4, FaultOrder.CLEAR, life=2), SupCmd(0, 5, FaultOrder.NONE),
    ):  # fmt: skip
        assert not see(follower, order)
    assert follower.take_orders() == [(3, FaultOrder.INJECT), (4, FaultOrder.CLEAR)]
    assert follower.take_orders() == []


def test_the_rate_of_the_simulation() -> None:
    follower = made()
    see(follower, TimeSync(1, 0, 25))
    assert follower.rate == 2.5
    assert follower.wall_s(5.0) == 2.0
    see(follower, TimeSync(1, 0, 0))
    assert follower.wall_s(5.0) == 5.0
