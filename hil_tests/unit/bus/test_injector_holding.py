"""What becomes of telegrams that a fault loses, holds back, repeats or reorders: published ones and answers."""

from __future__ import annotations

import pytest

from hil_tests.support.scripted import Scripted
from railhil.bus.frame import Frame
from railhil.bus.injector.holding import Holding, Silence
from railhil.faults.activity import Activity
from railhil.faults.language import parse

MS = 1_000_000
#: One telegram a step of 10 ms.
STEP_NS = 10 * MS


class Passing:
    """A fault at a port: telegrams 1, 2, ... go in; the numbers of those that leave come out."""

    def __init__(self, text: str, numbers: tuple[float, ...] = (), *, polled: bool = False) -> None:
        self.fault = Activity(parse(text), 1)
        self.random = Scripted(numbers)
        self.keep = (
            Silence(self.fault, polled)
            if self.fault.fault.place.level == "bus"
            else Holding(self.fault, self.random, polled)
        )
        self.number = 0
        self.fault.active = True

    def end(self) -> None:
        self.fault.active, self.fault.over = False, True

    def take(self, at_ns: int | None = None) -> tuple[list[int], str]:
        self.number += 1
        given = [Frame(self.number, b"")]
        leaving, said = self.keep.take(given, self.number * STEP_NS if at_ns is None else at_ns)
        return [one[0].can_id for one in leaving], said

    def run(self, count: int) -> list[list[int]]:
        return [self.take()[0] for _ in range(count)]

    def due(self, at_ns: int) -> list[int]:
        return [one[0].can_id for one in self.keep.due(at_ns)]


@pytest.mark.parametrize("polled", [False, True])
def test_a_fault_that_is_not_active_does_nothing(polled: bool) -> None:
    for text in ("loss", "delay 1s", "duplicate", "reorder"):
        given = Passing(f"TRN_SPEED {text} @0s", polled=polled)
        given.fault.active = False
        assert given.take() == ([1], "")
        assert not given.keep.waits
        assert given.due(10**12) == []


@pytest.mark.parametrize("polled", [False, True])
def test_a_share_is_lost(polled: bool) -> None:
    given = Passing("TRN_SPEED loss 30% @0s", (0.9, 0.3, 0.0, 0.2999), polled=polled)
    assert given.take() == ([1], "")
    assert given.take() == ([], "lost")
    assert given.random.left == 0


def test_losses_in_bursts() -> None:
    """Pairs of numbers: whether the burst begins or ends, whether the telegram is lost in it."""
    # Not begun, nor at 20 %; in the burst, not lost; still in it at 40 %, lost; ended; not begun; begun, lost; lost.
    given = Passing(
        "TRN_SPEED loss 50% gemodel 20% 40% @0s",
        (0.9, 0.0, 0.2, 0.0, 0.19, 0.5, 0.4, 0.49, 0.39, 0.0, 0.2, 0.0, 0.19, 0.0, 0.9, 0.0),
    )
    assert [given.take()[1] for _ in range(8)] == ["", "", "", "lost", "", "", "lost", "lost"]


def test_delayed_telegrams_leave_when_they_are_due() -> None:
    given = Passing("TRN_SPEED delay 25ms @0s")
    # At 10, 20, 30, 40 ms.
    assert [given.take() for _ in range(2)] == [([], "later"), ([], "later")]
    assert given.keep.waits
    assert given.due(35 * MS - 1) == []
    assert given.due(35 * MS) == [1]
    assert given.due(35 * MS) == []
    assert given.take(45 * MS) == ([2], "later")
    assert given.due(69 * MS) == []
    assert given.due(10**12) == [3]
    assert not given.keep.waits
    # Several at once leave in the order of their instants.
    given = Passing("TRN_SPEED delay 25ms jitter 20ms @0s", (1.0, 0.0, 0.5))
    assert [given.take(at_ns)[0] for at_ns in (0, 10 * MS, 10 * MS)] == [[], [], []]
    assert given.due(45 * MS) == [2, 3, 1]


def test_a_jitter_is_uniform_about_the_delay() -> None:
    for drawn, due_ms in ((0.0, 5), (0.25, 15), (0.5, 25), (0.75, 35)):
        given = Passing("TRN_SPEED delay 25ms jitter 20ms @0s", (drawn,))
        given.take(0)
        assert given.due(due_ms * MS - 1) == []
        assert given.due(due_ms * MS) == [1]


def test_no_delay_is_no_fault_unless_others_wait() -> None:
    given = Passing("TRN_SPEED delay 0s @0s")
    assert given.take() == ([1], "")
    given = Passing("TRN_SPEED delay 1e-9s @0s")
    assert given.take(0) == ([], "later")
    assert given.due(1) == [1]
    given = Passing("TRN_SPEED delay 100s @0s")
    assert given.take(0) == ([], "later")
    assert given.due(10**11) == [1]
    # Less than nothing counts as nothing.
    given = Passing("TRN_SPEED delay 10ms jitter 20ms @0s", (0.0, 0.75, 0.0, 0.25))
    assert given.take(0) == ([1], "")
    assert given.take(0) == ([], "later")
    assert given.take(MS) == ([3], "later")
    assert given.take(MS) == ([4], "later")
    assert given.due(20 * MS) == [2]
    # It does not overtake one that is due at the same instant.
    given = Passing("TRN_SPEED delay 10ms jitter 20ms @0s", (0.75, 0.0))
    given.take(0)
    assert given.take(20 * MS) == ([1, 2], "later")


def test_what_is_held_back_at_the_end() -> None:
    given = Passing("TRN_SPEED delay 25ms @0s")
    given.take()
    given.end()
    assert given.take(20 * MS) == ([2], "")
    assert given.take(35 * MS) == ([3, 1], "")
    for by_take in (True, False):
        given = Passing("TRN_SPEED delay 25ms @0s after drop")
        given.take()
        # While it is active nothing is dropped.
        assert given.due(10 * MS) == []
        assert given.keep.waits
        given.end()
        if by_take:
            assert given.take(35 * MS) == ([2], "")
        else:
            assert given.due(35 * MS) == []
        assert not given.keep.waits


def test_a_delayed_answer_waits_for_a_poll() -> None:
    given = Passing("NOTCH_CMD delay 25ms @0s", polled=True)
    # At 10, 20, ... ms: the first may leave at 35 ms.
    assert given.run(5) == [[], [], [], [1], [2]]
    given.end()
    # What is held back takes the place of fresh answers until all have left.
    assert [given.take() for _ in range(5)] == [([3], "lost"), ([4], "lost"), ([5], "lost"), ([9], ""), ([10], "")]
    given = Passing("NOTCH_CMD delay 25ms @0s after drop", polled=True)
    given.run(2)
    given.end()
    assert given.take() == ([3], "")


def test_of_delayed_answers_one_leaves_with_a_poll() -> None:
    given = Passing("NOTCH_CMD delay 25ms @0s", polled=True)
    for at_ns in (0, 0, 0):
        given.take(at_ns)
    assert given.due(25 * MS) == [1]
    assert given.take(25 * MS) == ([2], "later")
    # At the end one that is not due yet is none.
    given = Passing("NOTCH_CMD delay 25ms @0s", polled=True)
    given.take(0)
    given.end()
    assert given.take(24 * MS) == ([], "lost")
    assert given.take(25 * MS) == ([1], "lost")
    assert given.take(26 * MS) == ([4], "")


def test_a_slow_node_delays_without_jitter() -> None:
    given = Passing("node.controller slow 25ms @0s", polled=True)
    assert given.run(5) == [[], [], [], [1], [2]]
    given.end()
    assert [given.take() for _ in range(4)] == [([3], "lost"), ([4], "lost"), ([5], "lost"), ([9], "")]


def test_copies() -> None:
    given = Passing("TRN_SPEED duplicate 50% copies 2 @0s", (0.5, 0.49))
    assert given.take() == ([1], "")
    assert given.take() == ([2, 2, 2], "again")
    assert not given.keep.waits
    assert given.due(10**12) == []


def test_copies_of_an_answer_take_the_place_of_later_ones() -> None:
    given = Passing("NOTCH_CMD duplicate copies 2 @0s", (0.0, 0.0), polled=True)
    assert [given.take() for _ in range(4)] == [([1], "again"), ([1], "lost"), ([1], "lost"), ([4], "again")]
    assert given.random.left == 0
    given.end()
    # Also after its end.
    assert [given.take() for _ in range(3)] == [([4], "lost"), ([4], "lost"), ([7], "")]


def test_a_copy_answers_a_second_poll_of_the_same_instant() -> None:
    given = Passing("NOTCH_CMD duplicate @0s", (0.0,), polled=True)
    assert [given.take(0) for _ in range(2)] == [([1], "again"), ([1], "lost")]


def test_overtaken_telegrams() -> None:
    given = Passing("TRN_SPEED reorder 50% gap 2 @0s", (0.49, 0.5, 0.5, 0.5, 0.5))
    assert given.take() == ([], "later")
    assert given.due(10**12) == []
    assert [given.take() for _ in range(3)] == [([2], ""), ([3, 1], ""), ([4], "")]
    # Two on the way at the same time.
    given = Passing("TRN_SPEED reorder 50% gap 2 @0s", (0.4, 0.4, 0.5, 0.5, 0.5))
    assert given.run(5) == [[], [], [3, 1], [4, 2], [5]]
    # Those that pass count after its end, too.
    given = Passing("TRN_SPEED reorder gap 1 @0s", (0.0,))
    given.take()
    given.end()
    assert given.run(2) == [[2, 1], [3]]


def test_overtaken_answers() -> None:
    given = Passing("NOTCH_CMD reorder 50% gap 2 @0s", (0.4, 0.4, 0.4, 0.5), polled=True)
    # While one is held back no other one is; it takes the place of the answer after the gap.
    assert [given.take() for _ in range(5)] == [([], "later"), ([2], ""), ([3], ""), ([1], "lost"), ([5], "")]
    given = Passing("NOTCH_CMD reorder gap 1 @0s", (0.0,), polled=True)
    given.take()
    given.end()
    assert [given.take() for _ in range(3)] == [([2], ""), ([1], "lost"), ([4], "")]


@pytest.mark.parametrize("polled", [False, True])
def test_a_silent_bus_loses_what_is_sent(polled: bool) -> None:
    given = Passing("bus off @0s", polled=polled)
    assert [given.take() for _ in range(2)] == [([], "lost")] * 2
    assert not given.keep.waits
    given.end()
    assert given.take() == ([3], "")
    assert given.due(10**12) == []


def test_a_silent_bus_may_deliver_later() -> None:
    given = Passing("bus down @0s after deliver")
    assert [given.take() for _ in range(2)] == [([], "later")] * 2
    assert given.keep.waits
    assert given.due(10**12) == []
    given.end()
    assert given.due(0) == [1, 2]
    assert given.due(0) == []
    assert given.take() == ([3], "")
    given = Passing("bus down @0s after deliver", polled=True)
    given.run(3)
    given.end()
    assert given.due(0) == [1]
    assert [given.take() for _ in range(3)] == [([2], "lost"), ([3], "lost"), ([6], "")]


def test_a_full_queue_keeps_the_newest() -> None:
    given = Passing("bus full @0s")
    assert [given.take() for _ in range(2)] == [([], "later")] * 2
    given.end()
    assert given.due(0) == [2]
    given = Passing("bus full @0s", polled=True)
    given.run(2)
    given.end()
    assert [given.take() for _ in range(2)] == [([2], "lost"), ([4], "")]
