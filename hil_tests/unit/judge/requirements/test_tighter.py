"""The tightest bound that a record keeps: it keeps the new sentence, and violates the next tighter one."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from hil_tests.unit.judge.requirements.records import judged, names, record_of
from railhil.judge.record import Record
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.tighter import Tighter, tighter
from railhil.wire.ato import CtlMode

RUNNING = int(CtlMode.RUNNING)


def tightened(record: Record, says: str) -> Tighter | None:
    found = judged(record, says)
    assert found.kept, found
    return tighter(Requirement("R", says), names(), found.slack, found.margin)


@pytest.mark.parametrize(
    ("says", "bound"),
    [
        ("never measured_speed > 10 km/h", "7.2001 km/h"),
        ("always measured_speed <= 10 m/s", "2.0001 m/s"),
        ("always 10 m/s > measured_speed", "2.0001 m/s"),
        ("always measured_speed >= 0.5 m/s", "0.9999 m/s"),
        ("always rate(measured_speed, 20 ms) <= 400 m/s2", "50.001 m/s2"),
        ("at end measured_speed < 5 m/s", "1.0001 m/s"),
        ("whenever notch_command > 0, at once measured_speed < 2 m/s + 3 m/s", "2.0001 m/s"),
        ("whenever measured_speed > 1.5 m/s, within 150 ms notch_command <= 0", "60 ms"),
        ("never measured_speed > 1.5 m/s for longer than 1 s", "180 ms"),
        ("eventually within 190 ms measured_speed > 1.5 m/s", "100 ms"),
    ],
)
def test_the_bound_is_what_the_record_shows(says: str, bound: str) -> None:
    notches = [(256, RUNNING)] * 8 + [(0, RUNNING)] * 7
    record = record_of([1000] * 10 + [2000] * 18 + [1000] * 2, notches)
    found = tightened(record, says)
    assert found is not None
    assert found.bound == bound
    assert judged(record, found.requirement.says).kept
    assert found.beyond is not None
    assert judged(record, found.beyond.says).violated


@pytest.mark.parametrize(
    "says",
    [
        "always controller_level < service_brake",
        "always measured_speed < 3 m/s and notch_command < 7",
        "whenever measured_speed > 1.5 m/s, within 20 ms notch_command > 0",
    ],
)
def test_a_sentence_without_a_bound_that_leaves_room_has_no_tighter_one(says: str) -> None:
    record = record_of([1000] * 10 + [2000] * 20, [(256, RUNNING)] * 15)
    assert tightened(record, says) is None


@settings(max_examples=60, deadline=None)
@given(
    speeds=st.lists(st.integers(0, 30_000), min_size=3, max_size=20),
    room_dmps=st.integers(1, 100),
    sign=st.sampled_from(["<", "<=", ">", ">="]),
    never=st.booleans(),
)
def test_any_limit_is_tightened_to_what_the_record_keeps(
    speeds: list[int], room_dmps: int, sign: str, never: bool
) -> None:
    record = record_of(speeds)
    is_highest = never == sign.startswith(">")
    limit_mps = (max(speeds) // 100 + room_dmps if is_highest else max(min(speeds) // 100 - room_dmps, 0)) / 10
    says = f"{'never' if never else 'always'} measured_speed {sign} {limit_mps} m/s"
    assume(judged(record, says).kept)
    found = tightened(record, says)
    if found is not None:
        assert judged(record, found.requirement.says).kept
        assert found.beyond is not None
        assert judged(record, found.beyond.says).violated
