"""When a fault is active: every trigger and every end, at the instants beside them."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.bus.injector.activities import Activities, Hit
from railhil.faults.activity import Activity
from railhil.faults.language import parse
from railhil.faults.operator_values import octets_of

S = 1_000_000_000
MS = 1_000_000


def made(text: str) -> Activity:
    return Activity(parse(text), 7)


def state(one: Activity) -> tuple[bool, bool, int | None, int | None]:
    return one.active, one.over, one.begun_ns, one.ended_ns


def test_a_fault_waits_at_first() -> None:
    one = made("TRN_SPEED loss @2s")
    assert (one.number, one.hits, one.fault.what) == (7, 0, "loss")
    assert state(one) == (False, False, None, None)


def test_a_time_and_a_duration() -> None:
    one = made("TRN_SPEED loss @2s for 500ms")
    assert not one.look(2 * S - 1, 0.0, 0.0)
    assert state(one) == (False, False, None, None)
    # The duration counts from the instant at which it really begins.
    assert one.look(2 * S + 3, 0.0, 0.0)
    assert one.look(2 * S + 3 + 500 * MS - 1, 0.0, 0.0)
    assert state(one) == (True, False, 2 * S + 3, None)
    assert not one.look(2 * S + 3 + 500 * MS, 0.0, 0.0)
    assert state(one) == (False, True, 2 * S + 3, 2 * S + 3 + 500 * MS)
    assert not one.look(9 * S, 0.0, 0.0)
    assert one.ended_ns == 2 * S + 3 + 500 * MS


def test_values_of_an_operator_are_for_a_fault_that_has_not_begun() -> None:
    prepared, wanted = parse("TRN_SPEED loss @manual"), parse("TRN_SPEED loss 12% @manual")
    octets = octets_of(7, prepared, wanted)
    waiting, running, cleared = (Activity(prepared, 7) for _ in range(3))
    running.order(True, 2 * S)
    cleared.order(False, 2 * S)
    found = [(one.give(octets), one.given, one.fault.values["share"]) for one in (waiting, running, cleared)]
    before = prepared.values["share"]
    assert found == [(True, True, 0.12), (True, False, before), (True, False, before)]
    assert not Activity(prepared, 8).give(octets)


def test_it_begins_at_the_very_instant() -> None:
    one = made("TRN_SPEED loss @2s")
    assert one.look(2 * S, 0.0, 0.0)
    assert one.begun_ns == 2 * S
    assert one.look(10**6 * S, 0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "values", "begins"),
    [
        # Only a crossing counts: the first look has none before it.
        ("TRN_SPEED loss @100m", [150.0, 151.0], None),
        ("TRN_SPEED loss @100m", [99.0, 99.5, 100.0], 2),
        ("TRN_SPEED loss @100m", [100.0, 101.0], None),
        ("TRN_SPEED loss @100m", [100.5, 99.5, 100.5], 2),
        ("TRN_SPEED loss @v>36km/h", [9.0, 9.5, 10.0], 2),
        ("TRN_SPEED loss @v>36km/h", [10.0, 11.0], None),
        ("TRN_SPEED loss @v<36km/h", [11.0, 10.0], 1),
        ("TRN_SPEED loss @v<36km/h", [9.0, 8.0], None),
        ("TRN_SPEED loss @v<36km/h", [9.0, 11.0], None),
        ("TRN_SPEED loss @v<36km/h", [9.0, 11.0, 9.0], 2),
    ],
)
def test_a_crossing(text: str, values: list[float], begins: int | None) -> None:
    one = made(text)
    by_place = one.fault.trigger.kind == "position"
    found = [
        number
        for number, value in enumerate(values)
        # The other value crosses nothing, or everything.
        if one.look(number * MS, value if by_place else 200.0 * number, value if not by_place else 20.0 * number)
    ]
    assert found[:1] == ([] if begins is None else [begins])
    assert one.begun_ns == (None if begins is None else begins * MS)


def test_a_crossing_counts_once() -> None:
    one = made("TRN_SPEED loss @100m+1s")
    one.look(0, 99.0, 0.0)
    assert not one.look(1 * S, 101.0, 0.0)
    one.look(1 * S + MS, 99.0, 0.0)
    # A second crossing does not begin the delay again.
    assert not one.look(1 * S + 2 * MS, 101.0, 0.0)
    assert not one.look(2 * S - 1, 101.0, 0.0)
    assert one.look(2 * S, 101.0, 0.0)


def test_an_event_and_until_an_event() -> None:
    one = made("TRN_SPEED loss @braking until standstill")
    one.happened("standstill", 1 * S)
    one.happened("departed", 2 * S)
    assert not one.look(2 * S, 0.0, 0.0)
    assert state(one) == (False, False, None, None)
    one.happened("braking", 3 * S)
    # Before it is active its end does not count.
    one.happened("standstill", 3 * S)
    assert one.look(3 * S, 0.0, 0.0)
    one.happened("braking", 3 * S + 1)
    assert one.active
    one.happened("departed", 3 * S + 2)
    assert one.active
    one.happened("standstill", 4 * S)
    assert state(one) == (False, True, 3 * S, 4 * S)
    one.happened("braking", 5 * S)
    one.happened("standstill", 5 * S)
    assert not one.look(5 * S, 0.0, 0.0)
    assert one.ended_ns == 4 * S


def test_the_same_event_begins_it_and_ends_it_later() -> None:
    one = made("TRN_SPEED loss @braking until braking")
    one.happened("braking", 1 * S)
    assert one.look(1 * S, 0.0, 0.0)
    one.happened("braking", 2 * S)
    assert state(one) == (False, True, 1 * S, 2 * S)


def test_an_event_of_another_kind_of_trigger_begins_nothing() -> None:
    one = made("TRN_SPEED loss @manual")
    one.happened("", 1 * S)
    one.telegram(5, 1 * S)
    assert not one.look(1 * S, 0.0, 0.0)


def test_a_telegram_by_its_number() -> None:
    one = made("TRN_SPEED loss x2 @#5")
    one.telegram(4, 1 * S)
    assert not one.look(1 * S, 0.0, 0.0)
    one.telegram(5, 2 * S)
    assert one.look(2 * S, 0.0, 0.0)
    one.hit(2 * S)
    assert (one.active, one.hits) == (True, 1)
    one.hit(3 * S)
    assert (one.hits, *state(one)) == (2, False, True, 2 * S, 3 * S)
    # Another telegram does not move its beginning.
    waiting = made("TRN_SPEED loss @#5")
    waiting.telegram(6, 2 * S)
    waiting.telegram(7, 9 * S)
    assert waiting.look(2 * S, 0.0, 0.0)


def test_hits_without_a_count_end_nothing() -> None:
    one = made("TRN_SPEED loss @0s")
    one.look(0, 0.0, 0.0)
    for _ in range(3):
        one.hit(S)
    assert (one.active, one.hits) == (True, 3)


def test_orders_by_hand() -> None:
    one = made("TRN_SPEED loss @manual for 1s")
    one.order(True, 3 * S)
    assert one.look(3 * S, 0.0, 0.0)
    # A second order to inject changes nothing.
    one.order(True, 3 * S + MS)
    assert one.active
    one.order(False, 3 * S + 2 * MS)
    assert state(one) == (False, True, 3 * S, 3 * S + 2 * MS)
    one.order(False, 9 * S)
    one.order(True, 9 * S)
    assert not one.look(9 * S, 0.0, 0.0)
    assert one.ended_ns == 3 * S + 2 * MS
    # One that waits can be cleared, too.
    waiting = made("TRN_SPEED loss @9s")
    waiting.order(False, 1 * S)
    assert not waiting.look(9 * S, 0.0, 0.0)
    assert state(waiting) == (False, True, None, 1 * S)


def all_of(*texts: str) -> Activities:
    return Activities((number, parse(text)) for number, text in enumerate(texts, start=3))


def test_the_faults_of_a_node() -> None:
    node = all_of("TRN_SPEED loss @1s", "TRN_POS loss @manual", "TRN_SPEED delay 1s @manual")
    assert [one.number for one in node.all] == [3, 4, 5]
    assert node.now_ns == 0
    node.order([(5, True)])
    node.order([(9, True)])
    # They act from the next instant on, once.
    assert [one.active for one in node.all] == [False] * 3
    node.look(1 * S, 0.0, 0.0)
    assert node.now_ns == 1 * S
    assert [one.active for one in node.all] == [True, False, True]
    node.order([(5, False)])
    node.look(2 * S, 0.0, 0.0)
    assert [one.active for one in node.all] == [True, False, False]
    assert node.all[2].ended_ns == 2 * S
    node.look(3 * S, 0.0, 0.0)
    assert node.all[2].ended_ns == 2 * S


def test_place_and_speed_reach_the_faults() -> None:
    node = all_of("TRN_SPEED loss @100m", "TRN_SPEED loss @v>36km/h")
    node.look(0, 99.0, 9.0)
    node.look(1, 101.0, 9.0)
    assert [one.active for one in node.all] == [True, False]
    node.look(2, 102.0, 11.0)
    assert [one.active for one in node.all] == [True, True]


def test_events_reach_all_faults_at_the_present_instant() -> None:
    node = all_of("TRN_SPEED loss @braking", "TRN_POS loss @standstill", "TRN_POS loss @0s until standstill")
    node.look(5 * S, 0.0, 0.0)
    node.happened(["braking", "standstill"])
    assert node.all[2].ended_ns == 5 * S
    node.look(5 * S, 0.0, 0.0)
    assert [one.active for one in node.all] == [True, True, False]


def test_ok_ends_what_is_active_at_its_place() -> None:
    node = all_of(
        "TRN_SPEED loss @0s", "TRN_SPEED delay 1s @9s", "TRN_POS loss @0s", "TRN_SPEED ok @1s", "TRN_SPEED stuck @0s",
        "TRN_SPEED.counter freeze @0s",
    )  # fmt: skip
    node.look(1 * S - 1, 0.0, 0.0)
    assert [one.active for one in node.all] == [True, False, True, False, True, True]
    node.look(1 * S, 0.0, 0.0)
    assert [one.active for one in node.all] == [False, False, True, False, False, True]
    assert [one.over for one in node.all] == [True, False, False, True, True, False]
    assert [one.ended_ns for one in node.all] == [S, None, None, S, S, None]
    assert node.log.hits == [Hit(6, S, "ok", "loss", "ok"), Hit(6, S, "ok", "stuck", "ok")]
    assert node.all[3].hits == 2
    node.look(9 * S, 0.0, 0.0)
    assert node.all[1].active


def test_the_log(tmp_path: Path) -> None:
    node = all_of("TRN_SPEED loss @1s for 1s", "TRN_POS loss @0s", "TRN_POS stuck @9s", "TRN_POS ok @manual")
    node.all[3].order(False, 5)
    node.look(1 * S, 0.0, 0.0)
    node.note(node.all[1], "b", "a")
    node.note(node.all[0], "before", "after")
    # Of one fault and one instant as they came.
    node.note(node.all[0], "a", "z")
    node.look(2 * S, 0.0, 0.0)
    node.write(None, "plant")
    node.write(tmp_path, "plant")
    assert [path.name for path in tmp_path.iterdir()] == ["faults-plant.csv"]
    assert (tmp_path / "faults-plant.csv").read_text("utf-8").splitlines() == [
        "fault,time_ns,what,before,after",
        "3,1000000000,begun,,",
        "3,1000000000,loss,before,after",
        "3,1000000000,loss,a,z",
        "4,1000000000,begun,,",
        "4,1000000000,loss,b,a",
        "3,2000000000,ended,,",
    ]
    assert [one.hits for one in node.all] == [2, 1, 0, 0]


def test_without_faults_there_is_no_log(tmp_path: Path) -> None:
    all_of().write(tmp_path, "plant")
    assert list(tmp_path.iterdir()) == []
