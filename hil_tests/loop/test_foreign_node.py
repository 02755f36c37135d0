"""The exported controller in C instead of the Python node: the same answers, frame by frame, on any kind of bus."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.driven import driven, short, told
from hil_tests.support.faulty_bus import Faulty, SafeFaulty
from hil_tests.support.foreign import (
    CNode,
    TwinRun,
    export_node,
    twin_run,
)
from hil_tests.support.replay import TIME_ATTACKS, Choice, TimeAttack
from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent, Role
from railhil.bus.mvb import F_DEVICE_STATUS, check_sequence, master_frame
from railhil.dbc import wire_contract
from railhil.systems.ato.scenario.canonical import scenario_sha256
from railhil.systems.ato.scenario.model import Safety
from railhil.wire.ato import BalisePassed, TrkInfo, TrnPos, TrnSpeed, WatchLevel

pytestmark = pytest.mark.needs_compiler

LAWS = ("ipfc", "ipfc_plus", "ipfc_plus_stop", "tpfc1", "tpfc2", "tdmc", "fuzzy_pid")
POLL = wire_contract().poll_id


# -- the same answers ---------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_every_law_answers_as_our_node(exported, law: str, tmp_path: Path) -> None:
    """Short runs in one process, drawn parameters; by distance as well where the law has it."""
    for indexing in ("time", "distance") if not law.startswith("ipfc_plus") else ("time",):
        scenario = short("lvshun_tieshan_worn_wheels")
        c = CNode(exported(scenario, law, indexing), law)
        run = twin_run(scenario, c, tmp_path, seed=5, drawn=True, law=law, indexing=indexing)
        assert run.answers > 1000
        assert (run.levels, run.c) == ({WatchLevel.NORMAL}, {})
        assert run.ended[0] == run.ended[1] >= Event.ENDED_COMPLETE


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "indexing"),
    [("ipfc_plus", "time"), pytest.param("ipfc", "distance", marks=pytest.mark.long)],
)
def test_a_law_in_single_precision_answers_as_our_node(law: str, indexing: str, tmp_path: Path) -> None:
    """Set-points by time and by distance, and balises, with drawn parameters."""
    scenario = short("lvshun_tieshan_worn_wheels")
    export_node(scenario, tmp_path / "export", indexing, law, "float32")
    c = CNode(tmp_path / "export", law)
    run = twin_run(scenario, c, tmp_path, seed=5, drawn=True, law=law, indexing=indexing, arithmetic="float32")
    assert run.answers > 1000
    assert (run.levels, run.c) == ({WatchLevel.NORMAL}, {})


# -- one run after another ------------------------------------------------------------------------------------------


class Pulled(Exception):
    """The run is gone from the bus, and nobody says that it has ended."""


def torn_off(at_poll: int, silent: range) -> Callable[[Frame], list[Frame]]:
    """A bus that is gone at some poll; TRN_SPEED is missing before."""
    bus = Faulty(1, 0.0, {TrnSpeed.port().address: silent})

    def wire(frame: Frame) -> list[Frame]:
        if bus.polls >= at_poll:
            raise Pulled
        return bus(frame)

    return wire


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ipfc", "ipfc_plus"])
def test_a_run_after_another_in_one_control_is_as_the_first(exported, law: str, tmp_path: Path) -> None:
    """Whatever is left of the run before: a run that has ended, one that was torn off in motion, in emergency, before
    the first period, or in a handshake."""
    scenario = short("lvshun_tieshan_worn_wheels")
    c = CNode(exported(scenario, law), law)
    for at_poll, level in (
        (5, WatchLevel.NORMAL),
        (9, WatchLevel.NORMAL),
        (300, WatchLevel.NORMAL),
        (400, WatchLevel.EMERGENCY),
        (0, 0),
    ):
        if at_poll:
            silent = range(at_poll - 100, at_poll) if level else range(0)
            with pytest.raises(Pulled):
                twin_run(scenario, c, tmp_path, seed=9, law=law, wire=torn_off(at_poll, silent))
            assert (c.ended, c.level) == (0, level)
        run = twin_run(scenario, c, tmp_path, seed=5, drawn=True, law=law)
        assert run.answers > 1000
        assert (run.levels, run.c) == ({WatchLevel.NORMAL}, {})
        assert run.ended[0] == run.ended[1] >= Event.ENDED_COMPLETE


@pytest.mark.slow
def test_no_single_poll_of_a_handshake_begins_afresh_in_motion(exported, tmp_path: Path) -> None:
    """Both of them, in this order, but with the run going on between."""
    port = wire_contract().port(CtlIdent.PORT)
    own, scan = master_frame(port.f_code, port.address), master_frame(F_DEVICE_STATUS, Role.CONTROLLER)
    polls = 0
    added = {300: own, 400: scan, 401: own}

    def wire(frame: Frame) -> list[Frame]:
        nonlocal polls
        polls += frame.can_id == POLL
        return [*([added.pop(polls)] if polls in added else []), frame]

    scenario = short()
    run = twin_run(scenario, CNode(exported(scenario), "ipfc"), tmp_path, wire=wire)
    assert (added, run.levels, run.c) == ({}, {WatchLevel.NORMAL}, {})


# -- a bus that is not healthy --------------------------------------------------------------------------------------


def faulty_run(
    exported,
    law: str,
    wire: Callable[[Frame], list[Frame]],
    indexing: str = "time",
    name: str = "lvshun_tieshan",
) -> TwinRun:
    """A short run of both controllers on a faulty bus; what each refused must be the same too."""
    scenario = short(name)
    folder = exported(scenario, law, indexing)
    run = twin_run(scenario, CNode(folder, law), folder, seed=3, law=law, indexing=indexing, wire=wire)
    assert {cause: run.python.get(cause, 0) for cause in run.c} == run.c
    known = {"no_mailbox", "unknown_id", "remote_frame", "extended_id", "error_frame"}
    assert run.python.keys() - known == run.c.keys()
    assert run.ended[0] == run.ended[1]
    return run


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize("often", [0.003, 0.03, 0.3])
@pytest.mark.parametrize(("law", "indexing"), [("ipfc", "distance"), ("ipfc_plus", "time")])
def test_what_is_wrong_is_used_as_little_as_by_our_node(exported, law: str, indexing: str, often: float) -> None:
    """Damaged, cut, doubled, swapped, late and lost frames: equal answers, levels and counts of what was refused."""
    refused: set[str] = set()
    # Only many faults together make every cause.
    for seed in range(3 if often == 0.3 else 1):
        wire = Faulty(seed, often)
        run = faulty_run(exported, law, wire, indexing, "lvshun_tieshan_worn_wheels")
        refused |= run.c.keys()
        if often == 0.3:
            assert len(wire.happened) == 9
            assert max(run.levels) >= WatchLevel.TRACTION_CUT
    if often == 0.3:
        assert refused >= {
            "wrong_length", "wrong_check_sequence", "wrong_master_word", "missing_block", "duplicate", "gap",
            "out_of_order", "check_variable", "out_of_range",
        }  # fmt: skip


@pytest.mark.long_after(3)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("silent", "polls"),
    [
        *((TrnSpeed, polls) for polls in (3, 8, 25, 80)),
        *((port, 80) for port in (TrnPos, BalisePassed)),
        *(pytest.param(port, polls, marks=pytest.mark.long) for port in (TrnPos, BalisePassed) for polls in (3, 8, 25)),
    ],
)
def test_a_silent_port_is_answered_as_by_our_node(exported, silent, polls: int) -> None:
    """One port falls silent in motion and comes back: the ladder by age, the reckoned position, the way back."""
    quiet = {can_id: range(250, 250 + polls) for can_id in silent.port().can_ids}
    run = faulty_run(exported, "ipfc_plus", Faulty(1, 0.0, quiet), name="lvshun_tieshan_worn_wheels")
    if silent is TrnSpeed:
        reached = {
            3: WatchLevel.HOLD,
            8: WatchLevel.TRACTION_CUT,
            25: WatchLevel.SERVICE_BRAKE,
            80: WatchLevel.EMERGENCY,
        }
        assert max(run.levels) == reached[polls]
    if silent is TrnPos:
        assert max(run.levels) == (WatchLevel.SERVICE_BRAKE if polls == 80 else WatchLevel.NORMAL)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("late_ticks", "level"), [((1, 2), WatchLevel.NORMAL), ((50, 50), WatchLevel.SERVICE_BRAKE)], ids=["8 ms", "500 ms"]
)
def test_late_speeds_cost_neither_the_position_nor_the_ramp(
    exported, late_ticks: tuple[int, int], level: WatchLevel
) -> None:
    """The clock is behind by as much: the position is not lost for it, and the ramp goes on from poll to poll."""
    draw, held, tick = random.Random(5), list[tuple[int, Frame]](), 0

    def wire(frame: Frame) -> list[Frame]:
        nonlocal held, tick
        if frame.can_id != TrnSpeed.port().address or frame.flags:
            return [frame]
        tick += 1
        if tick < 500:
            return [frame]
        held.append((tick + draw.choice(late_ticks), frame))
        due = [late for at, late in held if at <= tick]
        held = [(at, late) for at, late in held if at > tick]
        draw.shuffle(due)
        return due

    run = faulty_run(exported, "ipfc_plus", wire)
    assert max(run.levels) == level
    if level is WatchLevel.NORMAL:
        assert run.c["out_of_order"] > 50


@pytest.mark.slow
def test_speed_is_missing_at_standstill_and_while_braking(exported) -> None:
    """Long before the train moves, when an old speed of 0 is no emergency; shortly and again and again later on, when
    HOLD keeps traction down and braking up."""
    missing = {*range(12, 68), *(poll for start in range(300, 1400, 40) for poll in range(start, start + 4))}
    run = faulty_run(exported, "ipfc", Faulty(1, 0.0, {TrnSpeed.port().address: missing}))
    assert WatchLevel.HOLD in run.levels
    assert WatchLevel.EMERGENCY not in run.levels


@pytest.mark.parametrize(
    "how",
    [{}, {"life": 1}, {"limit_check": 0}, {"grade_check": 3}],
    ids=["silent", "stuck", "limit not correct", "grade not correct"],
)
def test_a_limit_that_is_no_longer_told_is_no_limit(exported, how: dict[str, int]) -> None:
    """Three missing periods cut the traction, the age of an emergency brakes; the telegram's return ends it."""

    def track(tick: int) -> TrkInfo | None:
        info = told(tick)
        if info is None or not 32 <= tick < 192:
            return info
        return dataclasses.replace(info, **how) if how else None

    levels, _ = driven(exported, [100_000 + 30 * (tick % 3) for tick in range(260)], track=track)
    cut, brake = levels.index(WatchLevel.TRACTION_CUT), levels.index(WatchLevel.SERVICE_BRAKE)
    # The last one is of tick 16.
    assert (cut, brake) == (16 + 48 + 1, 16 + short().watch.emergency_ms // 10 + 1)
    assert levels[:cut] == [WatchLevel.NORMAL] * cut
    assert (levels[191], levels[259]) == (WatchLevel.SERVICE_BRAKE, WatchLevel.NORMAL)


def test_control_periods_left_out_are_counted(exported) -> None:
    """Polls fail for 3 s, as they can in realtime."""
    _, status = driven(exported, [50 * tick for tick in range(600)], range(101, 400))
    assert status[6] == 1, "OverrunCount"


def test_standing_train_leaves_the_service_brake_at_once(exported) -> None:
    """A standing train is no emergency, however long its speed is missing, and the first speed ends the brake; a moving
    one needs ten good in a row, which a silence ends, and stays in emergency."""
    standing, _ = driven(exported, [0] * 50 + [None] * 100 + [0] * 4)
    assert max(standing) == standing[149] == WatchLevel.SERVICE_BRAKE
    assert standing[150] == WatchLevel.NORMAL
    braked, _ = driven(exported, [20_000] * 50 + [None] * 35 + [20_000] * 20)
    assert (braked.index(WatchLevel.SERVICE_BRAKE), braked.index(WatchLevel.NORMAL, 70)) == (70, 94)
    # No poll sees the age of 40 ms.
    paused, _ = driven(exported, [20_000] * 50 + [None] * 35 + [20_000] * 6 + [None] * 3 + [20_000] * 12)
    assert paused.index(WatchLevel.NORMAL, 80) == 103
    moving, _ = driven(exported, [20_000] * 50 + [None] * 100 + [20_000] * 50)
    assert moving[-1] == WatchLevel.EMERGENCY


@pytest.mark.parametrize(
    ("bad", "level"), [((300, 304, 309), WatchLevel.TRACTION_CUT), ((300, 304, 310), WatchLevel.HOLD)]
)
def test_three_bad_speeds_count_within_ten(exported, bad: tuple[int, ...], level: WatchLevel) -> None:
    """The third bad one in the last ten cuts traction, the third in eleven does not."""
    speeds = 0

    def wire(frame: Frame) -> list[Frame]:
        nonlocal speeds
        speeds += frame.can_id == TrnSpeed.port().address
        if frame.can_id != TrnSpeed.port().address or speeds not in bad:
            return [frame]
        data = frame.data[:3] + bytes([frame.data[3] & 0xF])
        return [frame._replace(data=data + bytes([check_sequence(data)]) + frame.data[5:])]

    run = faulty_run(exported, "ipfc", wire)
    assert (max(run.levels), run.c["check_variable"]) == (level, 3)


@pytest.mark.parametrize("choice", [choice for choice, _ in TIME_ATTACKS], ids=lambda choice: choice.__name__)
def test_replayed_and_forged_times_are_refused_as_by_our_node(exported, choice: Choice) -> None:
    run = faulty_run(exported, "ipfc", TimeAttack(512, choice))
    assert max(run.levels) == WatchLevel.EMERGENCY
    assert any(cause.startswith("time_") for cause in run.c)


def test_silence_of_all_ports_is_bridged_by_polls_and_time_sync(exported) -> None:
    ids = [can_id for port in wire_contract().ports if port.source == "plant" for can_id in port.can_ids]
    quiet = {can_id: range(200, 300) for can_id in ids}
    run = faulty_run(exported, "ipfc", Faulty(1, 0.0, quiet))
    assert max(run.levels) == WatchLevel.EMERGENCY


# -- the safe channel -------------------------------------------------------------------------------------------------


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("often", [0.0, 0.01, 0.1, 0.6])
def test_the_safe_channel_is_that_of_our_node(exported, often: float, tmp_path: Path) -> None:
    """Equal answers, NOTCH_SDT among them, levels, causes and counts."""
    scenario = dataclasses.replace(short(), safety=Safety(sdt=True, cmthr=30))
    scenario = dataclasses.replace(scenario, sha256=scenario_sha256(scenario))
    refused: set[str] = set()
    for seed in range(2 if often else 1):
        wire = SafeFaulty(seed, often) if often else None
        run = twin_run(scenario, CNode(exported(scenario), "ipfc"), tmp_path, seed=3, wire=wire)
        assert {cause: run.python.get(cause, 0) for cause in run.c} == run.c
        assert run.python.keys() - {"no_mailbox", "unknown_id"} == run.c.keys()
        assert run.ended[0] == run.ended[1]
        refused |= run.c.keys()
    if not often:
        assert (run.levels, run.c) == ({WatchLevel.NORMAL}, {})
    if often == 0.1:
        assert {"safe_crc", "safe_duplicate", "safe_out_of_sequence"} <= refused
