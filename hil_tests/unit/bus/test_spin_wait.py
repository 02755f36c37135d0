"""How a node on pipes waits: awake on a calm machine, asleep where its turns come late."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator

import pytest

from railhil.bus.link.spin_wait import Sleep, SpinWait

AT_ONCE = Sleep(starting=1, least=4, most=8)


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    """Reading and writing end."""
    ends = os.pipe()
    yield ends
    for end in ends:
        os.close(end)


@pytest.fixture
def processors() -> Iterator[set[int]]:
    """Those of this process, which the test may change."""
    before = os.sched_getaffinity(0)
    yield before
    os.sched_setaffinity(0, before)


def come(turn: SpinWait, pipe: tuple[int, int], after_s: float = 0.0) -> None:
    """One turn that comes after a time."""
    if after_s:
        timer = threading.Timer(after_s, os.write, (pipe[1], b"x"))
        timer.start()
        assert turn.wait(5000)
        timer.join()
    else:
        os.write(pipe[1], b"x")
        assert turn.wait(5000)
    os.read(pipe[0], 1)


def late(turn: SpinWait, pipe: tuple[int, int]) -> None:
    """As many late turns as put a node to sleep."""
    for _ in range(3):
        assert turn.is_awake
        come(turn, pipe, 0.05)
    assert not turn.is_awake


def sleeps(turn: SpinWait, pipe: tuple[int, int]) -> int:
    """Turns until it is awake."""
    turns = 0
    while not turn.is_awake:
        come(turn, pipe)
        turns += 1
        assert turns < 100
    return turns


def test_awake_after_the_start_and_as_long_as_turns_come_in_time(pipe: tuple[int, int]) -> None:
    turn = SpinWait((pipe[0],), sleep=Sleep(starting=3))
    assert sleeps(turn, pipe) == 3
    for _ in range(1000):
        come(turn, pipe)
    assert turn.is_awake


def test_sleeps_longer_when_it_is_late_again(pipe: tuple[int, int]) -> None:
    turn = SpinWait((pipe[0],), sleep=AT_ONCE)
    come(turn, pipe)
    found = []
    for _ in range(3):
        late(turn, pipe)
        found.append(sleeps(turn, pipe))
    assert found == [4, 8, 8]


@pytest.mark.parametrize("starting", [0, 9])
def test_a_time_out_is_kept_awake_and_asleep(pipe: tuple[int, int], starting: int) -> None:
    turn = SpinWait((pipe[0],), sleep=Sleep(starting=starting))
    assert not turn.wait(0)
    begun_s = time.monotonic()
    assert not turn.wait(30)
    assert time.monotonic() - begun_s >= 0.03


def test_the_end_of_the_other_side_is_a_turn(pipe: tuple[int, int]) -> None:
    """Awake, too: a node must notice that the writers have ended."""
    reading, writing = os.pipe()
    os.close(writing)
    try:
        for starting in (0, 9):
            assert SpinWait((reading,), sleep=Sleep(starting=starting)).wait(5000)
    finally:
        os.close(reading)


def test_awake_it_leaves_the_shared_processor_and_asleep_it_returns(
    pipe: tuple[int, int], processors: set[int]
) -> None:
    if len(processors) < 2:
        pytest.skip("MISSING CAPABILITY two processors")
    turn = SpinWait((pipe[0],), moves=True, sleep=AT_ONCE)
    shared = {min(processors)}
    os.sched_setaffinity(0, shared)
    come(turn, pipe)
    assert os.sched_getaffinity(0) == processors - shared
    late(turn, pipe)
    assert os.sched_getaffinity(0) == shared


def test_it_stays_asleep_until_it_has_been_placed(pipe: tuple[int, int], processors: set[int]) -> None:
    if len(processors) < 2:
        pytest.skip("MISSING CAPABILITY two processors")
    turn = SpinWait((pipe[0],), moves=True, sleep=AT_ONCE)
    for _ in range(20):
        come(turn, pipe)
        assert not turn.is_awake
    assert os.sched_getaffinity(0) == processors
    os.sched_setaffinity(0, {max(processors)})
    come(turn, pipe)
    assert turn.is_awake
    assert os.sched_getaffinity(0) == processors - {max(processors)}


def test_who_need_not_move_stays(pipe: tuple[int, int], processors: set[int]) -> None:
    """The plant, and any node where there is one processor."""
    only = {min(processors)}
    for moves in (False, True):
        if moves:
            os.sched_setaffinity(0, only)
        turn = SpinWait((pipe[0],), moves=moves, sleep=AT_ONCE)
        os.sched_setaffinity(0, only)
        come(turn, pipe)
        late(turn, pipe)
        assert os.sched_getaffinity(0) == only
