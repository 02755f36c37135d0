"""Whether a record has all that a verdict needs: holes in the truth, and telegrams that may be missing."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from railhil.bus.ident import PltIdent, Role, make_ident
from railhil.dbc import wire_contract
from railhil.judge.record_checks import Unseen, incomplete
from railhil.record.trace import NodeCounters, Trace
from railhil.scenarios.load import load
from railhil.wire.ato import SimTruth, TrnPos

MS = 1_000_000


def trace_of(truth_ms: Iterable[int], positions_ms: Iterable[int], end_ms: int) -> Trace:
    """A record of two ports."""
    trace = Trace(wire_contract())
    for count, time_ms in enumerate(truth_ms):
        trace.add(SimTruth.PORT, time_ms * MS, SimTruth(count, 100).encode())
    for count, time_ms in enumerate(positions_ms):
        trace.add(TrnPos.PORT, time_ms * MS, TrnPos(count, life=time_ms // 20 % 16).encode())
    trace.end_ns = end_ms * MS
    return trace


@pytest.mark.parametrize(
    ("truth_ms", "end_ms", "said"),
    [
        (range(1000, 4001, 20), 4000, ""),
        (range(1260, 4001, 20), 4000, "no SIM_TRUTH for 1.26 s from 0.00 s on, allowed 1 s"),
        (range(0, 3001, 20), 4000, ""),
        (range(0, 2741, 20), 4000, "no SIM_TRUTH for 1.26 s from 2.74 s on, allowed 1 s"),
        ([*range(0, 1001, 20), *range(2260, 4001, 20)], 4000, "no SIM_TRUTH for 1.26 s from 1.00 s on, allowed 1 s"),
    ],
)
def test_a_time_without_the_train_is_a_hole_at_the_start_within_and_at_the_end(
    truth_ms: Iterable[int], end_ms: int, said: str
) -> None:
    """It begins with the first telegram of any port."""
    found = incomplete(trace_of(truth_ms, [0, 3000], end_ms), SimTruth.PORT)
    assert found == (said and f"record: {said}")


@pytest.mark.parametrize(
    ("from_s", "until_s", "missing"),
    [
        (0.0, 10.0, 4),
        (0.0, 1.019, 0),
        (0.0, 1.02, 4),
        (0.0, 1.05, 4),
        (1.05, 1.06, 4),
        (1.1, 10.0, 4),
        (1.101, 10.0, 0),
    ],
)
def test_telegrams_that_may_be_missing_count_where_the_gap_touches_the_time(
    from_s: float, until_s: float, missing: int
) -> None:
    kept = [ms for ms in range(0, 4001, 20) if not 1000 < ms < 1100]
    trace = trace_of(range(0, 4001, 20), kept, 4000)
    unseen = Unseen(load("lvshun_tieshan"), trace)
    assert unseen.period_s(TrnPos.PORT) == 0.02
    assert unseen.count(TrnPos.PORT, from_s, until_s) == missing
    assert unseen.count(SimTruth.PORT, from_s, until_s) == 0
    trace.reported = NodeCounters(exact=True, nodes={})
    assert Unseen(load("lvshun_tieshan"), trace).count(TrnPos.PORT, from_s, until_s) == 0


def test_a_gap_at_the_very_start_may_be_missing() -> None:
    """The record begins with PLT_IDENT."""
    trace = trace_of(range(0, 4001, 20), range(400, 4001, 20), 4000)
    trace.add(PltIdent.PORT, 0, make_ident(Role.PLANT, "0" * 64, contract=wire_contract()).encode())
    unseen = Unseen(load("lvshun_tieshan"), trace)
    assert unseen.count(TrnPos.PORT) == 20
    assert unseen.count(TrnPos.PORT, 0.0, 0.0) == 20
    assert unseen.count(TrnPos.PORT, 0.41) == 0
