"""The ends used to measure transports, on kernel SocketCAN: Python and C on one interface."""

from __future__ import annotations

import pytest

from benchmarks.buses import KERNEL
from benchmarks.native import c_loop
from benchmarks.pairs import PYTHON, C
from benchmarks.transports import open_pairs

# Long: it measures buses, and decides nothing about a run.
pytestmark = [pytest.mark.needs_socketcan, pytest.mark.long, pytest.mark.timeout(300)]


def test_two_pairs_on_one_interface_lose_nothing_and_hear_only_their_own(tmp_path) -> None:
    with open_pairs(KERNEL, c_loop(tmp_path), tmp_path) as pairs:
        assert [pair.language for pair in pairs] == [PYTHON, C]
        # At the same time: a frame too few or of the other pair would be an error.
        for pair in pairs:
            pair.tell("stream 5")
        assert all(len(pair.answer()) == 1 for pair in pairs)
        for pair in pairs:
            assert len(pair.ask("trips 10")) == 10
