"""Bus order for a recorder on a kernel bus, where one sender's frames may overtake another's."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from railhil.bus.frame import Frame
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.order import BusOrder
from railhil.dbc import wire_contract
from railhil.wire.ato import CtlStat, NotchCmd, TrnSpeed

SPEED = TelegramSource(TrnSpeed.port()).frames(TrnSpeed(1).encode())
NOTCH = TelegramSource(NotchCmd.port()).frames(NotchCmd(1).encode())
STATUS = TelegramSource(CtlStat.port()).frames(CtlStat().encode())
NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
STATUS_POLL = master_frame(CtlStat.port().f_code, CtlStat.port().address)


def ordered(frames: list[Frame]) -> list[Frame]:
    order = BusOrder(wire_contract(), patience_s=0.0)
    return [item for frame in frames for item in order.feed(frame)] + order.flush()


def test_frames_in_order_pass_at_once():
    order = BusOrder(wire_contract())
    frames = [*SPEED, NOTCH_POLL, *NOTCH, *SPEED, STATUS_POLL, *STATUS, *SPEED]
    assert [order.feed(frame) for frame in frames] == [[frame] for frame in frames]
    assert order.moved == 0


@given(st.lists(st.integers(0, 4), min_size=2, max_size=12), st.randoms(use_true_random=False))
def test_any_merge_of_the_two_senders_gives_the_order_of_the_wire(gaps, random):
    """Plant and controller each keep their own order; how the two streams merge is up to the processors."""
    wire: list[tuple[int, Frame]] = []
    for index, gap in enumerate(gaps):
        # Distinct data, so that equal frames cannot hide a swap.
        wire += [(0, Frame(0x118, bytes([index, k] * 4))) for k in range(gap)]
        poll, answer = ((NOTCH_POLL, NOTCH), (STATUS_POLL, STATUS))[index % 2]
        wire.append((0, poll))
        wire += [(1, frame._replace(data=bytes([index]) * 8)) for frame in answer]
    # The recorder may see an answer early by at most its own poll, late by anything before the next answer.
    plant = [frame for sender, frame in wire if sender == 0]
    controller = [frame for sender, frame in wire if sender == 1]
    seen: list[Frame] = []
    while plant or controller:
        source = plant if not controller or (plant and random.random() < 0.5) else controller
        seen.append(source.pop(0))
    assert ordered(seen) == [frame for _, frame in wire]


def test_no_answer_ends_the_wait_for_a_telegram_of_several_frames():
    order = BusOrder(wire_contract())
    none = Frame(CtlStat.port().can_ids[-1], b"")
    frames = [STATUS_POLL, none, *SPEED, STATUS_POLL, *STATUS]
    assert [order.feed(frame) for frame in frames] == [[frame] for frame in frames]


def test_answer_that_never_comes_is_given_up_when_the_bus_falls_silent():
    order = BusOrder(wire_contract(), patience_s=0.0)
    assert order.feed(NOTCH_POLL) == [NOTCH_POLL]
    assert [order.feed(frame) for frame in SPEED] == [[]]
    assert order.flush() == SPEED
    assert order.feed(STATUS_POLL) == [STATUS_POLL]
    assert [order.feed(frame) for frame in STATUS] == [[frame] for frame in STATUS]


def test_answer_after_a_pause_stands_behind_its_poll():
    """A slow controller, a busy machine: the record is the same as without the pause."""
    order = BusOrder(wire_contract())
    assert order.feed(NOTCH_POLL) == [NOTCH_POLL]
    assert order.flush() == []
    assert [order.feed(frame) for frame in SPEED] == [[]]
    assert order.flush() == []
    assert [order.feed(frame) for frame in NOTCH] == [[*NOTCH, *SPEED]]


@given(st.lists(st.tuples(st.integers(0, 0x7FF), st.binary(max_size=8)), max_size=80))
def test_random_frames_are_neither_lost_nor_invented(frames):
    sent = [Frame(can_id, data) for can_id, data in frames]
    assert sorted(ordered(sent)) == sorted(sent)


def test_can_fd_answers_are_known():
    order = BusOrder(wire_contract(), fd=True)
    answer = TelegramSource(NotchCmd.port(), fd=True).frames(NotchCmd(1).encode())
    assert order.feed(NOTCH_POLL) == [NOTCH_POLL]
    assert order.feed(SPEED[0]) == []
    assert order.feed(answer[0]) == [answer[0], SPEED[0]]
