"""The pipes between the processes of one run: order, ends of nodes, full inboxes, foreign_frames."""

from __future__ import annotations

import os
import select
import time
from collections.abc import Iterator

import pytest

from hil_tests.support.pipe_links import ANSWER, CLOCK, COMMAND, NODES, POLL, SUPERVISOR_POLL, heard, pipe_links
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.bus.link import pipes as module
from railhil.bus.link.pipes import PipeLink
from railhil.bus.packing import CLASSIC_SIZE, ROLES, pack_frame


@pytest.fixture
def links() -> Iterator[dict[str, PipeLink]]:
    with pipe_links() as made:
        yield made


def test_every_other_node_gets_each_frame_in_one_order(links: dict[str, PipeLink]) -> None:
    links["plant"].send([CLOCK, POLL])
    assert links["controller"].receive(0.0) == [CLOCK, POLL]
    links["controller"].send([ANSWER])
    assert links["plant"].receive(0.0) == [ANSWER]
    links["plant"].send([SUPERVISOR_POLL])
    links["supervisor"].send([COMMAND])
    assert heard(links) == {
        "plant": [COMMAND],
        "controller": [SUPERVISOR_POLL, COMMAND],
        "supervisor": [CLOCK, POLL, ANSWER, SUPERVISOR_POLL],
    }, "its own answer does not come back to the supervisor"
    assert heard(links) == {role: [] for role in NODES}


@pytest.mark.parametrize(
    ("role", "frame", "order"),
    [
        ("plant", POLL, ["controller"]),
        ("plant", SUPERVISOR_POLL, ["controller", "supervisor"]),
        ("controller", ANSWER, ["plant"]),
        ("supervisor", COMMAND, ["controller", "plant"]),
    ],
)
def test_who_acts_on_a_frame_gets_it_last(
    links: dict[str, PipeLink], monkeypatch: pytest.MonkeyPatch, role: str, frame: Frame, order: list[str]
) -> None:
    """Otherwise its answer could overtake the frame, in the record or at the third node."""
    written: list[str] = []
    names = {end: name for name, end in links[role]._ends.others.items()}
    write = os.write

    def noted(end: int, packet: bytes) -> int:
        # Other threads write, too: those of pytest-xdist.
        if end not in names:
            return write(end, packet)
        written.append(names[end])
        return len(packet)

    monkeypatch.setattr(module.os, "write", noted)
    links[role].send([frame])
    assert written == order


def test_the_supervisor_sleeps_until_it_is_asked(links: dict[str, PipeLink]) -> None:
    links["plant"].send([POLL])
    links["controller"].send([ANSWER])
    assert links["plant"].receive(10.0) == [ANSWER]
    assert links["supervisor"].receive(0.0) == []
    links["plant"].send([SUPERVISOR_POLL])
    assert links["supervisor"].receive(10.0) == [POLL, ANSWER, SUPERVISOR_POLL]


def test_it_never_stays_awake(links: dict[str, PipeLink]) -> None:
    """Plant and controller have a processor each."""
    for _ in range(200):
        links["plant"].send([SUPERVISOR_POLL])
        assert links["supervisor"].receive(10.0) == [SUPERVISOR_POLL]
        assert links["controller"].receive(10.0) == [SUPERVISOR_POLL]
    assert not links["supervisor"]._spin_wait.is_awake


def test_the_record_is_written_when_it_fills_a_write(links: dict[str, PipeLink]) -> None:
    """Whole packets, with what the controller has answered between them."""
    expected: list[Frame] = []
    for _ in range(20):
        links["plant"].send([POLL] * 20)
        links["controller"].send([ANSWER] * 3)
        assert links["plant"].receive(10.0) == [ANSWER] * 3
        expected += [POLL] * 20 + [ANSWER] * 3
    found = links["supervisor"].receive(0.0)
    waiting = len(expected) - len(found)
    assert 0 < waiting <= select.PIPE_BUF // CLASSIC_SIZE
    assert found == expected[:-waiting]
    links["plant"].send([])
    assert links["supervisor"].receive(0.0) == expected[-waiting:]


def test_more_answers_than_fit_one_write_are_recorded_whole(
    links: dict[str, PipeLink], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Into a pipe with little room, too: a longer write would leave a part of itself out."""
    sizes: list[int] = []
    record, write = links["plant"]._record, os.write

    def noted(end: int, packet: bytes) -> int:
        if end == record:
            sizes.append(len(packet))
        return write(end, packet)

    monkeypatch.setattr(module.os, "write", noted)
    answers = [Frame(0x110, number.to_bytes(2)) for number in range(900)]
    links["plant"].send([POLL])
    links["controller"].send(answers)
    assert links["plant"].receive(10.0) == answers
    links["plant"].send([SUPERVISOR_POLL])
    assert links["supervisor"].receive(10.0) == [POLL, *answers, SUPERVISOR_POLL]
    assert max(sizes) <= select.PIPE_BUF


def test_the_record_is_written_when_no_answer_comes(links: dict[str, PipeLink]) -> None:
    """A controller that stands still is seen with all that came before."""
    links["plant"].send([POLL])
    assert links["plant"].receive(0.0) == []
    assert links["supervisor"].receive(0.0) == [], "a look is no wait"
    assert links["plant"].receive(0.01) == []
    assert links["supervisor"].receive(0.0) == [POLL]


def test_the_record_is_written_when_the_plant_leaves(links: dict[str, PipeLink]) -> None:
    links["plant"].send([POLL])
    links["plant"].close()
    assert links["supervisor"].receive(0.0) == [POLL]


def test_frames_are_sent_and_received_as_they_are_packed(links: dict[str, PipeLink]) -> None:
    supervisor = links["supervisor"].packed
    assert supervisor.receive_packed(0.0) == b""
    packet = pack_frame(POLL) + pack_frame(SUPERVISOR_POLL)
    links["plant"].packed.send_packed(packet)
    assert supervisor.receive_packed(10.0) == links["controller"].packed.receive_packed(10.0) == packet
    assert links["supervisor"].counters["received"] == links["plant"].counters["sent"] == 2


def test_what_a_node_sent_outlives_it(links: dict[str, PipeLink]) -> None:
    links["controller"].send([ANSWER])
    links["controller"].close()
    assert not links["plant"].has_ended("controller"), "its answer is still to be read"
    assert links["plant"].receive(0.0) == [ANSWER]
    assert links["plant"].receive(0.0) == []
    assert links["plant"].has_ended("controller")
    assert links["supervisor"].has_ended("controller")
    assert not links["supervisor"].has_ended("plant")
    links["plant"].send([SUPERVISOR_POLL])
    assert links["supervisor"].receive(0.0) == [ANSWER, SUPERVISOR_POLL], "the train goes on without its controller"
    links["supervisor"].send([COMMAND])
    assert links["plant"].receive(10.0) == [COMMAND]


@pytest.mark.parametrize("role", ["plant", "controller"])
def test_a_node_that_is_left_alone_ends(links: dict[str, PipeLink], role: str) -> None:
    for other in set(ROLES) - {role}:
        links[other].close()

    def hear() -> None:
        for _ in range(2):
            links[role].receive(10.0)

    with pytest.raises(BusLost, match="pipes of this run: the other nodes have ended"):
        hear()


def test_a_plant_that_is_left_alone_cannot_send(links: dict[str, PipeLink]) -> None:
    links["supervisor"].close()
    links["plant"].send([SUPERVISOR_POLL])
    links["controller"].close()
    with pytest.raises(BusLost, match="cannot send: the other nodes have ended"):
        links["plant"].send([POLL])


def test_a_controller_without_its_plant_still_hears_the_supervisor(links: dict[str, PipeLink]) -> None:
    links["plant"].close()
    links["controller"].send([ANSWER])
    assert links["controller"].has_ended("plant")
    links["supervisor"].send([COMMAND])
    assert links["controller"].receive(10.0) == [COMMAND]


def test_the_supervisor_left_alone_only_hears_nothing(links: dict[str, PipeLink]) -> None:
    links["plant"].close()
    links["controller"].close()
    links["supervisor"].send([COMMAND])
    assert links["supervisor"].receive(0.0) == []
    begun_s = time.monotonic()
    assert links["supervisor"].receive(0.05) == []
    assert time.monotonic() - begun_s >= 0.05, "it does not turn round and round"


def test_a_node_that_does_not_read_is_given_up(links: dict[str, PipeLink], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PATIENCE_S", 0.01)
    looks: list[int] = []
    links["plant"].while_waiting = lambda: looks.append(1)

    def fill() -> None:
        for _ in range(10_000):
            links["plant"].send([POLL] * 256)
            links["supervisor"].receive(0.0)

    with pytest.raises(BusLost, match="controller has not read for"):
        fill()
    assert looks


def test_a_full_inbox_is_waited_for(links: dict[str, PipeLink]) -> None:
    packets = 1

    def read_on() -> None:
        frames.extend(links["controller"].receive(0.0))

    frames: list[Frame] = []
    links["plant"].while_waiting = read_on
    while not links["plant"].counters["send_retries"]:
        links["plant"].send([POLL] * 256)
        links["supervisor"].receive(0.0)
        packets += 1
    while more := links["controller"].receive(0.0):
        frames += more
    assert len(frames) == (packets - 1) * 256


def test_bytes_of_a_stranger_end_the_run(links: dict[str, PipeLink]) -> None:
    """Another process of the same user could open the pipe under /proc."""
    os.write(links["plant"]._ends.others["controller"], b"stranger")
    with pytest.raises(BusLost, match="8 bytes read, allowed: frames of 16"):
        links["controller"].receive(0.0)
