"""A sequence of runs of a law that learns over the hub, with the helper of the same test on kernel SocketCAN."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.hub import running_hub
from hil_tests.transport.vcan.bench import STOPS, STOPS_SHA256, local_sequence, sequence_on, short_stop
from railhil.sequences.evidence import sequence_sha256

pytestmark = pytest.mark.slow


def test_two_stops_give_the_hash_of_the_same_runs_in_one_process(tmp_path: Path) -> None:
    scenario = short_stop()
    for name in ("hub", "local"):
        (tmp_path / name).mkdir()
    expected = local_sequence(scenario, tmp_path / "local", STOPS, 2)
    with running_hub() as hub:
        made = sequence_on({"interface": "railhil", "channel": hub.channel}, scenario, tmp_path / "hub", STOPS, 2)
    assert [one.line for one in made] == [one.line for one in expected]
    assert sequence_sha256(made) == sequence_sha256(expected) == STOPS_SHA256
    assert len({one.memory_after_sha256 for one in made}) == 2
