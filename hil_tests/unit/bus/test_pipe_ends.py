"""The pipes of a run before its nodes are started, and how a command line names them."""

from __future__ import annotations

import contextlib
import os
import stat

import pytest

from hil_tests.support.pipe_links import descriptors
from railhil.bus.errors import BusUnavailable
from railhil.bus.link import open_link
from railhil.bus.link import pipes as module
from railhil.bus.link.pipes import Ends, Pipes
from railhil.bus.select import own_pipes
from railhil.bus.transports import limits, limits_of


def test_only_their_owner_may_open_the_pipes() -> None:
    pipes = Pipes()
    try:
        for ends in pipes.ends.values():
            assert all(stat.S_IMODE(os.fstat(end).st_mode) == 0o600 for end in ends.descriptors)
            assert not any(os.get_inheritable(end) for end in ends.descriptors)
    finally:
        pipes.close()


def test_nothing_is_left_open_when_pipes_cannot_be_made(monkeypatch: pytest.MonkeyPatch) -> None:
    before = descriptors()

    made: list[int] = []
    pipe2 = os.pipe2

    def refused(flags: int) -> tuple[int, int]:
        if len(made) == 3:
            raise OSError(24, "too many open files")
        made.append(flags)
        return pipe2(flags)

    monkeypatch.setattr(module.os, "pipe2", refused)
    with pytest.raises(BusUnavailable, match="pipes between the nodes: too many open files"):
        Pipes()
    assert descriptors() == before


@pytest.mark.parametrize(
    "channel", ["pipes:", "pipes:1,plant", "pipes:x,plant=1", "pipes:0+,plant=1", "pipes:9999,plant=9999"]
)
def test_a_channel_without_pipes_is_refused_in_one_line(channel: str) -> None:
    with pytest.raises(BusUnavailable, match="found no pipes of this process; railhil run makes them"):
        open_link({"interface": "railhil", "channel": channel}, "plant")


def test_a_channel_names_the_ends() -> None:
    pipes = Pipes()
    with contextlib.closing(pipes):
        for ends in pipes.ends.values():
            assert Ends.parse(ends.channel) == ends


def test_its_limits_are_told() -> None:
    assert limits_of(own_pipes().transport) == limits()["railhil pipes"]
    assert own_pipes().is_private
