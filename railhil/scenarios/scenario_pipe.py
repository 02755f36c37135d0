"""A scenario handed to a node by the command that starts it: read, checked and resolved once for all processes.

The document is in anonymous memory whose descriptor the node inherits, so it cannot come from another program, and
nothing of it remains. A node without such a descriptor reads the files itself.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Iterator
from contextlib import contextmanager

from railhil.scenarios.model import AnyScenario

#: Option of plant and controller, for the command that starts all nodes.
OPTION = "--handed-scenario"


@contextmanager
def offer_scenario(scenario: AnyScenario) -> Iterator[tuple[list[str], list[int]]]:
    """The words of a node's command line, and the descriptors that it must inherit.

    Both are empty for a scenario of a system that plugs in, if it cannot be pickled.
    """
    try:
        document = pickle.dumps(scenario)
    except (pickle.PicklingError, TypeError, AttributeError):
        yield [], []
        return
    descriptor = os.memfd_create("railhil-scenario")
    try:
        with open(descriptor, "wb", closefd=False) as stream:
            stream.write(document)
        yield [OPTION, str(descriptor)], [descriptor]
    finally:
        os.close(descriptor)


def receive_scenario(descriptor: int) -> AnyScenario:
    """The scenario behind a descriptor of :func:`offer_scenario`."""
    # The descriptor's position is shared with the other node.
    document = os.pread(descriptor, os.fstat(descriptor).st_size, 0)
    os.close(descriptor)
    scenario: AnyScenario = pickle.loads(document)
    return scenario
