"""The pipes of one run with a link for each of its nodes, in one process."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from railhil.bus.frame import Frame
from railhil.bus.ident import Role
from railhil.bus.link.pipes import Ends, PipeLink, Pipes
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame

POLL = master_frame(1, 0x110)
SUPERVISOR_POLL = master_frame(F_DEVICE_STATUS, Role.SUPERVISOR)
ANSWER = Frame(0x110, b"\x01\x02")
COMMAND = Frame(0x108, b"\x03")
CLOCK = Frame(0x080, b"\x04")
NODES = ("plant", "controller", "supervisor")


def descriptors() -> set[str]:
    return set(os.listdir("/proc/self/fd"))


@contextmanager
def pipe_links() -> Iterator[dict[str, PipeLink]]:
    """One link for each node, with descriptors of its own as after a start."""
    before = descriptors()
    pipes = Pipes()
    copies = {
        role: Ends(tuple(map(os.dup, ends.inboxes)), {name: os.dup(end) for name, end in ends.others.items()})
        for role, ends in pipes.ends.items()
    }
    pipes.close()
    made = {role: PipeLink(ends, role) for role, ends in copies.items()}
    yield made
    for link in made.values():
        link.close()
    assert descriptors() == before


def heard(links: dict[str, PipeLink]) -> dict[str, list[Frame]]:
    """What each node has to read now."""
    return {role: links[role].receive(0.0) for role in NODES}
