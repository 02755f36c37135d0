"""The check after every test of runs sees what it is there for."""

from __future__ import annotations

import json
import weakref
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support import health
from hil_tests.support.health import disturbed_runs
from railhil.bench import Result
from railhil.judge.events.event import RecordedEvent
from railhil.scenarios.run_spec import RunSpec
from railhil.testing.result import disturbed_events


@pytest.mark.parametrize(
    ("pace", "counters", "missed_polls", "found"),
    [
        ("lockstep", {"sent": 5, "received": 7, "send_retries": 1}, 0, {}),
        ("lockstep", {"rx_lost": 2, "crc": 0, "sequence": 1}, 0, {"rx_lost": 2, "sequence": 1}),
        ("lockstep", {}, 3, {"missed_polls": 3}),
        ("realtime", {}, 3, {}),
    ],
)
def test_what_is_disturbed(
    tmp_path_factory: pytest.TempPathFactory,
    pace: str,
    counters: dict[str, int],
    missed_polls: int,
    found: dict[str, int],
) -> None:
    # Not among the folders that the check itself looks into.
    place = tmp_path_factory.mktemp("health")
    (place / "run").mkdir()
    run = {"pace": pace, "counters": counters, "timing": {"missed_polls": missed_polls}}
    (place / "run" / "score.json").write_text(json.dumps({"run": run}))
    assert disturbed_runs(place) == ({"run": found} if found else {})


def test_events_of_a_disturbed_bus() -> None:
    events = [
        RecordedEvent(1.0, "TRN_SPEED", "refused", "out_of_order", count=3),
        RecordedEvent(9.0, "TRN_SPEED", "refused", "out_of_order"),
        RecordedEvent(2.0, "BALISE", "lost", "gap", count=2),
        RecordedEvent(3.0, "plant", "milestone", "departed"),
        RecordedEvent(4.0, "NOTCH_CMD", "missed_poll", "no_answer"),
    ]
    assert disturbed_events(events) == {"refused TRN_SPEED (out_of_order)": 4, "lost BALISE (gap)": 2}
    assert disturbed_events(events[3:]) == {}


def test_folders_of_a_test_are_looked_into(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    assert request.node.funcargs["tmp_path"] == tmp_path
    assert {"healthy", "noted_runs"} <= set(request.fixturenames)


def test_a_run_that_is_looked_at_is_not_kept() -> None:
    class Trace:
        pass

    trace: Any = Trace()
    kept = weakref.ref(trace)
    run = Result(trace, RunSpec(), trace, trace)
    del run, trace
    assert kept() is None


@pytest.mark.faults
def test_what_a_run_has_refused_is_noted() -> None:
    trace: Any = None
    Result(trace, RunSpec(), trace, trace, counters={"plant": {"gap": 2, "polls": 7}})
    assert health._REFUSED == [{"plant.gap": 2}]
