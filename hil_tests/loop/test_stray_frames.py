"""One lost, stray or duplicate frame around the milestones of a run never changes its verdict silently."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from benchmarks.figures import QUICK_TOML
from railhil.bench import Result, local_run
from railhil.bus.codes import EVENT_COPIES, Event
from railhil.bus.frame import Frame
from railhil.bus.mvb import TelegramSource
from railhil.bus.telegrams import RunEvent
from railhil.dbc import wire_contract
from railhil.judge.score import Score
from railhil.plant_sim.cycle import Milestones
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.scenarios.load import load
from railhil.systems.ato.judge.score import score
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import TrnSpeed

pytestmark = pytest.mark.faults

Record = list[tuple[int, Frame]]

BLOCKS_AND_TRAILER = RunEvent.port().can_ids


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    """A short run that passes."""
    path = tmp_path_factory.mktemp("short") / "short.toml"
    path.write_text(QUICK_TOML)
    scenario = load(str(path))
    return replace(scenario, plan=replace(scenario.plan, stop_error_max_m=8.0, time_error_max_s=8.0))


def silence(from_ms: int, to_ms: int) -> Callable[[Frame], list[Frame]]:
    """Nothing of the speed reaches the controller: it asks for the emergency brake."""
    ticks = iter(range(1_000_000))

    def wire(frame: Frame) -> list[Frame]:
        return [] if frame.can_id == TrnSpeed.port().address and from_ms <= 10 * next(ticks) < to_ms else [frame]

    return wire


@pytest.fixture(scope="module")
def passed(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    return local_run(short, tmp_path_factory.mktemp("passed"))


@pytest.fixture(scope="module")
def braked(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    return local_run(short, tmp_path_factory.mktemp("braked"), wire=silence(3000, 4500))


@pytest.fixture(params=["passed", "braked"])
def run(request: pytest.FixtureRequest) -> Result:
    found: Result = request.getfixturevalue(request.param)
    return found


def record_of(run: Result) -> Record:
    assert run.log is not None
    return list(read_log(run.log))


def milestones(record: Record) -> list[int]:
    """Places of the frames of RUN_EVENT in the record."""
    return [place for place, (_, frame) in enumerate(record) if frame.can_id in BLOCKS_AND_TRAILER]


def same_or_invalid(scenario: Scenario, run: Result, record: Record) -> Score:
    found = score(scenario, trace_of(record, wire_contract()))
    assert found.verdict in (run.score.verdict, "INVALID")
    if found.verdict == "INVALID":
        assert found.failures
        assert all(found.failures)
    else:
        assert found == run.score
    return found


def test_the_runs_are_what_they_are_to_be(passed: Result, braked: Result) -> None:
    assert (passed.score.verdict, passed.score.failures) == ("PASS", ())
    assert braked.score.verdict == "FAIL"
    (failure,) = braked.score.failures
    assert failure.startswith("emergency brake at ")
    for found, events in ((passed, "departed stopped"), (braked, "departed emergency stopped")):
        codes = [Event(code).name.lower() for code in found.trace.raw(RunEvent.PORT, "RunEvent")]
        assert codes == [name for name in (*events.split(), "ended_complete") for _ in range(EVENT_COPIES)]


def test_one_frame_lost(short: Scenario, run: Result) -> None:
    record = record_of(run)
    for place in milestones(record):
        assert same_or_invalid(short, run, record[:place] + record[place + 1 :]).verdict == run.score.verdict


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("data", "after"),
    [
        (bytes(8), 0),
        (b"\xff" * 8, 1),
        pytest.param(bytes(8), 1, marks=pytest.mark.long),
        pytest.param(b"\xff" * 8, 0, marks=pytest.mark.long),
    ],
    ids=["zeros before", "ones after", "zeros after", "ones before"],
)
def test_one_stray_frame_beside_a_frame_of_a_milestone(short: Scenario, run: Result, data: bytes, after: int) -> None:
    record = record_of(run)
    for place in milestones(record):
        for can_id in BLOCKS_AND_TRAILER:
            stray = (record[place][0], Frame(can_id, data))
            found = same_or_invalid(short, run, [*record[: place + after], stray, *record[place + after :]])
            assert found.verdict == run.score.verdict


@pytest.mark.long_after(1)
@pytest.mark.slow
def test_one_stray_frame_at_any_time(short: Scenario, run: Result) -> None:
    """The stray block waits for the next milestone, seconds later."""
    record = record_of(run)
    for place in range(0, len(record), 97):
        for can_id in BLOCKS_AND_TRAILER:
            stray = (record[place][0], Frame(can_id, bytes(8)))
            assert same_or_invalid(short, run, [*record[:place], stray, *record[place:]]).verdict == run.score.verdict


@pytest.mark.long_after(1)
@pytest.mark.slow
def test_one_frame_repeated_at_once_and_later(short: Scenario, run: Result) -> None:
    record = record_of(run)
    for place in milestones(record):
        for later in (1, 2, 3, 50, 700):
            at = min(place + later, len(record))
            again = (record[at - 1][0], record[place][1])
            assert same_or_invalid(short, run, [*record[:at], again, *record[at:]]).verdict == run.score.verdict


def telegrams(record: Record) -> Iterator[list[int]]:
    """Places of the frames of each milestone, with all its repetitions."""
    places = milestones(record)
    size = EVENT_COPIES * len(BLOCKS_AND_TRAILER)
    for first in range(0, len(places), size):
        yield places[first : first + size]


def test_a_milestone_that_is_lost_with_all_its_repetitions_is_missed(short: Scenario, run: Result) -> None:
    record = record_of(run)
    whole = list(telegrams(record))
    for number, places in enumerate(whole, start=1):
        found = same_or_invalid(short, run, [item for k, item in enumerate(record) if k not in places])
        assert found.verdict == "INVALID"
        if number < len(whole):
            assert found.failures == (f"record: RUN_EVENT {number} of {len(whole)} is missing",)
        else:
            assert found.ended == "record_incomplete"


def test_one_repetition_is_enough(short: Scenario, run: Result) -> None:
    record = record_of(run)
    size = len(BLOCKS_AND_TRAILER)
    for places in telegrams(record):
        for kept in range(EVENT_COPIES):
            gone = {*places} - {*places[kept * size : (kept + 1) * size]}
            found = same_or_invalid(short, run, [item for k, item in enumerate(record) if k not in gone])
            assert found.verdict == run.score.verdict


# -- how they are sent ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("tick_ms", "spacing"), [(1, 20), (10, 2), (16, 2), (20, 1), (100, 1)])
def test_a_milestone_is_repeated_at_its_spacing_and_the_last_one_at_once(tick_ms: int, spacing: int) -> None:
    sent: list[tuple[int, int, int]] = []
    now = 0
    sender = Milestones(lambda telegram: sent.append((now, telegram.event, telegram.number)), tick_ms * 1_000_000)  # type: ignore[attr-defined]
    for now in range(200):
        sender.repeat(now)
        if now == 3:
            sender.reached(now, Event.DEPARTED, 0, 0)
    assert sent == [(3, 1, 1), (3 + spacing, 1, 1), (3 + 2 * spacing, 1, 1)]
    del sent[:]
    now = 300
    sender.reached(now, Event.STOPPED, 0, 0)
    sender.end(Event.ENDED_COMPLETE, 0, 0)
    sender.repeat(1000)
    assert sent == [(300, 2, 2)] * 3 + [(300, 4, 3)] * 3


def test_the_frames_of_a_milestone_are_these() -> None:
    """The layout, written out: event, number, instant, position beyond 214 km."""
    frames = TelegramSource(RunEvent.port()).frames(RunEvent(2, 3, 288_600_000, 4_000_000_001).encode())
    assert [f"{frame.can_id:x}#{frame.data.hex()}" for frame in frames[:2]] == [
        "160#020000031133afc0",
        "161#0000ee6b28010000",
    ]
