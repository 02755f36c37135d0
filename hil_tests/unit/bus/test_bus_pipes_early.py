"""Telegrams that the plant writes into pipes early."""

from __future__ import annotations

import select
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from hil_tests.support.pipe_links import CLOCK, COMMAND, NODES, POLL, SUPERVISOR_POLL, heard, pipe_links
from railhil.bus.frame import Frame
from railhil.bus.link.pipes import PipeLink
from railhil.bus.packing import CLASSIC_SIZE, pack_frame, pack_frames
from railhil.bus.sent import SentFrames

SendEarly = Callable[[Sequence[Frame]], bool]


@pytest.fixture
def links() -> Iterator[dict[str, PipeLink]]:
    with pipe_links() as made:
        yield made


@pytest.fixture
def send_early(links: dict[str, PipeLink]) -> SendEarly:
    """Sends frames early from the plant, while it is awake."""
    plant = links["plant"]
    plant._spin_wait._asleep = 0
    return lambda frames: plant.send_early(b"".join(pack_frames(frames)))


def test_what_was_sent_early_is_recorded_with_what_is_sent_next(
    links: dict[str, PipeLink], send_early: SendEarly
) -> None:
    """The controller has it at once and only once, the record has it before the poll: one order for both."""
    assert send_early([COMMAND])
    assert send_early([CLOCK])
    assert heard(links) == {"plant": [], "controller": [COMMAND, CLOCK], "supervisor": []}
    links["plant"].send([POLL])
    links["plant"].send([])
    assert heard(links) == {"plant": [], "controller": [POLL], "supervisor": [COMMAND, CLOCK, POLL]}
    assert links["plant"].counters["sent"] == 3
    links["plant"].send([SUPERVISOR_POLL])
    assert links["supervisor"].receive(0.0) == [SUPERVISOR_POLL], "nothing twice"


def test_a_poll_of_the_supervisor_brings_what_was_sent_early(links: dict[str, PipeLink], send_early: SendEarly) -> None:
    assert send_early([COMMAND])
    links["plant"].send([SUPERVISOR_POLL])
    assert links["supervisor"].receive(10.0) == [COMMAND, SUPERVISOR_POLL]
    assert links["controller"].receive(0.0) == [COMMAND, SUPERVISOR_POLL]


def test_what_was_sent_early_is_recorded_when_nothing_follows(
    links: dict[str, PipeLink], send_early: SendEarly
) -> None:
    assert send_early([COMMAND])
    links["plant"].send([])
    assert heard(links) == {"plant": [], "controller": [COMMAND], "supervisor": [COMMAND]}


@pytest.mark.parametrize("following", [[POLL], [POLL] * 250, [POLL] * 256, [POLL] * 600])
def test_a_long_packet_follows_what_was_sent_early(
    links: dict[str, PipeLink], send_early: SendEarly, following: list[Frame]
) -> None:
    """A write of more than PIPE_BUF bytes would not be whole: the record gets several."""
    assert send_early([COMMAND] * 7)
    links["plant"].send(following)
    links["plant"].send([])
    assert links["supervisor"].receive(0.0) == [COMMAND] * 7 + following
    assert links["controller"].receive(0.0) == [COMMAND] * 7 + following


def test_no_more_is_sent_early_at_once_than_fits_one_write(links: dict[str, PipeLink], send_early: SendEarly) -> None:
    most = select.PIPE_BUF // CLASSIC_SIZE
    assert not send_early([COMMAND] * (most + 1))
    assert send_early([COMMAND] * most)
    assert send_early([CLOCK])
    links["plant"].send([])
    expected = [COMMAND] * most + [CLOCK]
    assert heard(links) == {"plant": [], "controller": expected, "supervisor": expected}


def test_nothing_is_sent_early_of_a_node_that_sleeps(links: dict[str, PipeLink], send_early: SendEarly) -> None:
    links["plant"]._spin_wait._asleep = 1
    assert not send_early([COMMAND])
    assert heard(links) == {role: [] for role in NODES}
    assert links["plant"].counters["sent"] == 0


def test_nothing_is_sent_early_into_a_full_inbox(links: dict[str, PipeLink], send_early: SendEarly) -> None:
    """As a whole or not at all: it is sent, and waited for, with the rest."""
    packets = 0
    while send_early([COMMAND] * 200):
        links["plant"].send([])
        links["supervisor"].receive(0.0)
        packets += 1
    assert packets
    assert links["supervisor"].receive(0.0) == []
    frames: list[Frame] = []
    while more := links["controller"].receive(0.0):
        frames += more
    assert frames == [COMMAND] * 200 * packets


def test_nothing_is_sent_early_to_a_controller_that_has_ended(
    links: dict[str, PipeLink], send_early: SendEarly
) -> None:
    links["controller"].close()
    assert not send_early([COMMAND])
    links["plant"].send([COMMAND])
    links["plant"].send([])
    assert links["supervisor"].receive(0.0) == [COMMAND], "the train goes on without its controller"


def test_the_list_of_what_was_sent_has_it_once(
    links: dict[str, PipeLink], send_early: SendEarly, tmp_path: Path
) -> None:
    plant = links["plant"]
    plant.sent = SentFrames(tmp_path / "sent", "plant")
    assert send_early([COMMAND])
    links["controller"].close()
    assert not send_early([CLOCK])
    plant.send([CLOCK, POLL])
    assert plant.sent._packed == b"".join(map(pack_frame, (COMMAND, CLOCK, POLL)))
