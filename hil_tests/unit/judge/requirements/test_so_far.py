"""A run in progress: what its frames so far decide, and what only its end does."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.unit.judge.requirements.records import record_of
from railhil.bus.codes import Event
from railhil.judge.requirements.outcome import judge_requirements
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.so_far import judge_so_far

_SENTENCES = (
    "always measured_speed < 2 m/s",
    "never measured_speed > 2 m/s for longer than 30 ms",
    "whenever measured_speed > 2 m/s, within 40 ms measured_speed < 1 m/s",
    "whenever begin of measured_speed > 2 m/s, at once measured_speed > 1 m/s, until end",
    "whenever measured_speed > 2 m/s, at once age(TRN_SPEED) < 20 ms, until measured_speed < 1 m/s",
    "at departed measured_speed < 1 m/s",
    "after departed, always measured_speed > 0.5 m/s",
    "between departed and stopped, never measured_speed > 2.5 m/s",
    "eventually within 50 ms measured_speed > 2 m/s for 20 ms",
    "eventually measured_speed > 2 m/s",
    "at end measured_speed > 2 m/s",
    "from start to end, eventually measured_speed > 2 m/s",
)
_REQUIREMENTS = tuple(Requirement(f"T-{number}", says) for number, says in enumerate(_SENTENCES))
_SPEEDS = st.lists(st.sampled_from([0, 700, 1500, 2200, 3000, None]), min_size=2, max_size=40)


@pytest.mark.slow
@given(_SPEEDS, st.data())
@settings(max_examples=60, deadline=None)
def test_what_the_frames_so_far_violate_the_whole_run_violates(speeds: list[int | None], data: st.DataObject) -> None:
    departs = data.draw(st.integers(0, len(speeds) - 1))
    cut = data.draw(st.integers(1, len(speeds)))
    events = [(departs / 100, Event.DEPARTED)]
    whole = judge_requirements(record_of(speeds, events=events), _REQUIREMENTS)
    part = judge_so_far(record_of(speeds[:cut], events=events if departs < cut else ()), _REQUIREMENTS)
    for before, after in zip(part, whole, strict=True):
        assert after.violated or not before.violated, (before, after)


@pytest.mark.slow
@given(_SPEEDS)
@settings(max_examples=20, deadline=None)
def test_at_its_end_a_run_is_judged_as_its_record(speeds: list[int | None]) -> None:
    record = record_of(speeds)
    assert judge_so_far(record, _REQUIREMENTS, ended=True) == judge_requirements(record, _REQUIREMENTS)


@pytest.mark.parametrize(
    ("says", "so_far", "at_the_end"),
    [
        ("at end measured_speed > 2 m/s", "open", "violated"),
        ("at end measured_speed < 2 m/s", "open", "kept"),
        ("eventually measured_speed > 2 m/s", "open", "violated"),
        ("eventually measured_speed > 1 m/s", "kept", "kept"),
        ("eventually within 20 ms measured_speed > 2 m/s", "violated", "violated"),
        ("whenever fault, within 20 ms measured_speed > 2 m/s", "open", "open"),
        ("never is_faulty and measured_speed > 9 m/s", "open", "open"),
    ],
)
def test_what_only_the_end_or_the_certificate_tells_is_open(says: str, so_far: str, at_the_end: str) -> None:
    record = record_of([1500] * 10)
    requirement = [
        Requirement("T-1", says, define=(("is_faulty", "broken or stopped"), ("broken", "fault or departed")))
    ]
    assert judge_so_far(record, requirement)[0].verdict == so_far
    assert judge_so_far(record, requirement, ended=True)[0].verdict == at_the_end
