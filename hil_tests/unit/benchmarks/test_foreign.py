"""Transports of python-can beside those of the bench, without its daemon, a kernel with CAN or a multicast group."""

from __future__ import annotations

import json
import sys
import threading
from contextlib import closing

import pytest

from benchmarks.__main__ import work
from benchmarks.buses import UNIX_HUB
from benchmarks.figures import Figure
from benchmarks.foreign import SOCKETCAND, foreign_transports
from benchmarks.peer import Near, echo, open_end
from benchmarks.transports import _beside_the_hub
from railhil.bus.frame import Frame
from railhil.bus.link import Link
from railhil.common.errors import InputError

FIRST_ID = 0x110
GROUP = "239.74.163.2"


class Until:
    """A far end that ends with a frame of its own."""

    LAST_ID = 0x7FF

    def __init__(self, link: Link) -> None:
        self._link = link
        self.send = link.send

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """What has come; nothing at the end."""
        frames = self._link.receive(timeout_s)
        return [] if any(frame.can_id == self.LAST_ID for frame in frames) else frames


def test_an_end_is_opened_on_any_interface_of_python_can() -> None:
    """``virtual`` is in one process: the far end is a thread of it."""
    where = json.dumps({"interface": "virtual", "channel": "benchmarks"})
    near_end, far_end = (open_end("python-can", where, FIRST_ID) for _ in range(2))
    assert isinstance(near_end, Link)
    assert isinstance(far_end, Link)
    with closing(near_end), closing(far_end):
        echoing = threading.Thread(target=echo, args=(Until(far_end), FIRST_ID))
        echoing.start()
        try:
            near = Near(near_end, FIRST_ID)
            near.wait_for_echo()
            assert len(near.trips(5)) == 5
            assert len(near.stream(2)) == 1
        finally:
            near_end.send([Frame(Until.LAST_ID, b"")])
            echoing.join()


def test_multicast_is_not_sent_unless_a_group_is_named(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    ways, missing = foreign_transports("")
    assert ways == []
    why = {each.name: each.why for each in missing}
    assert "--multicast GROUP permits" in why["python-can udp_multicast"]
    assert "no socketcand on the PATH: github.com/linux-can/socketcand" in why[SOCKETCAND.name]


@pytest.mark.parametrize("group", ["127.0.0.1", "railhil", "ff15"])
def test_what_is_no_group_is_refused(group: str, monkeypatch) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--only", "transports", "--multicast", group])
    with pytest.raises(InputError, match=r"--multicast.*a multicast address"):
        work()


def test_figures_of_python_can_are_compared_with_those_of_the_hub() -> None:
    trip, rate = "round trip, free, Python", "one way, Python"
    figures = [
        Figure(f"{UNIX_HUB.name}: {trip}", 50.0, "us", 2.0, "Python to C, free"),
        Figure(f"{UNIX_HUB.name}: {rate}", 1000.0, "frames/s"),
        Figure(f"{SOCKETCAND.name}: {trip}", 75.0, "us", None, "", {"min": 70.0}),
        Figure(f"{SOCKETCAND.name}: {rate}", 100.0, "frames/s"),
    ]
    beside = f"to {UNIX_HUB.name}"
    assert _beside_the_hub(SOCKETCAND, figures) == [
        Figure(f"{SOCKETCAND.name}: {trip}", 75.0, "us", 1.5, beside, {"min": 70.0}),
        Figure(f"{SOCKETCAND.name}: {rate}", 100.0, "frames/s", 0.1, beside),
    ]
