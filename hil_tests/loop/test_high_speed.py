"""Whole runs of the systems of high-speed trains, in one process and over the hub."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import pytest

from hil_tests.support.cli import railhil
from railhil.bench import BenchRun, local_run
from railhil.bus.codes import Event
from railhil.controller_node.vector.node import ports_of
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.vector_bench import direct_run

#: Ports of the bench's own nodes, which a run without a bus has not; it leaves open where the run ended.
NOT_COUPLED = ("SUP_CMD", "PLT_IDENT", "SUP_IDENT", "RUN_EVENT")
SPEC = RunSpec(law=LawSpec("pid", arithmetic="float64"), seed=3)


class Both(NamedTuple):
    local: BenchRun
    direct: BenchRun


@pytest.fixture(scope="module")
def hst1(tmp_path_factory: pytest.TempPathFactory) -> Both:
    scenario = load_any("hst_short")
    return Both(local_run(scenario, tmp_path_factory.mktemp("run"), SPEC), direct_run(scenario, SPEC))


def test_the_run_is_complete_and_healthy(hst1: Both) -> None:
    assert hst1.local.ended is Event.ENDED_COMPLETE
    assert hst1.local.score.verdict == "PASS"
    assert hst1.local.refused == {}


def test_a_run_without_a_bus_has_the_same_telegrams_at_the_same_instants(hst1: Both) -> None:
    """Also those of the polls, whose time comes from two time bases of the recorder."""
    for port in hst1.local.trace.contract.ports:
        if port.name not in NOT_COUPLED:
            assert list(hst1.direct.trace.times_ns(port.name)) == list(hst1.local.trace.times_ns(port.name)), port.name
            for signal in port.signals:
                pair = (run.trace.raw(port.name, signal.name).tolist() for run in hst1)
                assert next(pair) == next(pair), (port.name, signal.name)
    assert hst1.direct.score.values == hst1.local.score.values


@pytest.mark.loop
@pytest.mark.slow
def test_three_processes_over_the_hub_send_the_same_bytes(hst1: Both, tmp_path: Path) -> None:
    words = (
        "run",
        "hst_short",
        "--seed",
        "3",
        "--arithmetic",
        "float64",
        "--no-report",
        "--out",
        str(tmp_path / "run"),
    )
    done = railhil(*words)
    assert done.exit_code == 0, done.err
    log = (tmp_path / "run" / "frames.log").read_bytes()
    assert hashlib.sha256(log).hexdigest() == hst1.local.frames_sha256


def test_no_controller_has_a_mailbox_for_the_mutation() -> None:
    """The controller's node takes neither MUTATION nor TRUTH, and its law reads neither."""
    for system in map(system_named, ("hst1",)):
        received, _ = ports_of(system.contract, system.part("interface"))
        names = {port.name for port in received}
        assert not names & {"MUTATION", "TRUTH"}
        assert names == {"TIME_SYNC", "RUN_EVENT", "UNIT1_FB", "REF", "EVENT"}
        node = system.part("controller")(load_any("hst_short"), SPEC.law)
        assert {*node.responder.store.ports} == names
