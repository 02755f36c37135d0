"""Faults of telegrams and nodes on vcan0: the bytes of the run in one process, and a train that stops by itself."""

from __future__ import annotations

import pytest

from hil_tests.support.fault_runs import BRAKED, KILLED, Made, assert_stopped_by_its_own_watch, fast
from hil_tests.transport.vcan.bench import run_on, socketcan
from railhil.bench import local_run

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.faults, pytest.mark.timeout(600)]


def test_a_train_whose_controller_is_killed_stops_by_itself(tmp_path, folder):
    scenario = fast(tmp_path, *KILLED)
    result, exit_codes = run_on(socketcan(), scenario, folder, seed=0)
    assert exit_codes[0] == -9
    assert all(one.hits for one in result.faults)
    assert result.frames_sha256 == local_run(scenario, tmp_path).frames_sha256
    assert_stopped_by_its_own_watch(scenario, Made.of(folder, result))


@pytest.mark.long
def test_a_controller_that_hangs_starts_anew_or_brakes(tmp_path, folder):
    scenario = fast(tmp_path, *BRAKED)
    result, exit_codes = run_on(socketcan(), scenario, folder, seed=0)
    assert exit_codes == [0, 0]
    assert all(one.hits for one in result.faults)
    assert result.frames_sha256 == local_run(scenario, tmp_path).frames_sha256
    assert (result.exit_code, result.line.startswith("stop error ")) == (1, True), result.line
