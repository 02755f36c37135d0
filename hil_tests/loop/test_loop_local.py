"""The loop through codec and stores, in one process."""

from __future__ import annotations

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import Result, direct_run, local_run
from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.controller_node.ato.node import MAILBOXES, ControllerNode
from railhil.dbc import wire_contract
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth, TrnSpeed


@pytest.fixture(scope="module")
def brief(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    """72 m in 24 s."""
    path = tmp_path_factory.mktemp("brief") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return load(path)


@pytest.fixture(scope="module")
def brief_run(brief: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """It without sockets, seed 1; read-only."""
    return local_run(brief, tmp_path_factory.mktemp("run"), RunSpec(seed=1))


def test_nominal_run_is_healthy_and_complete(nominal):
    assert nominal.ended is Event.ENDED_COMPLETE
    assert nominal.trace.count(TrnSpeed.PORT) == round(nominal.trace.times_s(TrnSpeed.PORT)[-1] * 100) + 1
    assert nominal.counters["gate"]["accepted"] == nominal.trace.count(NotchCmd.PORT)
    assert nominal.counters["plant"].get("missed_polls", 0) == 0


def test_nominal_scores_are_those_of_the_paper_s_law_on_this_plant(nominal):
    found = nominal.score
    assert found.values["itae"] == pytest.approx(2120, rel=0.10)
    assert found.values["punctuality_s"] == pytest.approx(0.078, abs=0.02)
    assert found.values["stop_error_m"] == pytest.approx(0.26, abs=0.05)
    assert found.values["comfort"] == pytest.approx(1.8, abs=0.15)
    assert found.extras["overspeed_mps"] == 0


@pytest.mark.slow
def test_same_seed_same_bytes_other_seed_other_bytes(brief, brief_run, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    assert local_run(brief, tmp_path / "a", RunSpec(seed=1)).frames_sha256 == brief_run.frames_sha256
    other = local_run(brief, tmp_path / "b", RunSpec(seed=2))
    assert other.frames_sha256 != brief_run.frames_sha256
    # Not only the handshake differs: the sensor noise does.
    assert list(other.trace.raw(TrnSpeed.PORT, "TrainSpeed")) != list(brief_run.trace.raw(TrnSpeed.PORT, "TrainSpeed"))


def test_can_fd_form_gives_the_same_run(brief, brief_run, tmp_path):
    fd = local_run(brief, tmp_path, RunSpec(seed=1), fd=True)
    assert fd.commands("notch") == brief_run.commands("notch")
    assert fd.score == brief_run.score
    assert fd.frames_sha256 != brief_run.frames_sha256


@pytest.mark.long_after(2)
@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
@pytest.mark.parametrize(("seed", "drawn"), [(2, False), (5, True)])
def test_direct_coupling_is_the_same_loop(nominal, lvshun, brief, tmp_path, arithmetic, seed, drawn):
    """The published run, and shorter ones."""
    is_nominal = (seed, drawn, arithmetic) == (2, False, "iq")
    run = RunSpec(law=LawSpec(arithmetic=arithmetic), seed=seed, perturbed=drawn)
    through_telegrams = nominal if is_nominal else local_run(brief, tmp_path, run)
    direct = direct_run(lvshun if is_nominal else brief, run)
    assert direct.commands("notch") == through_telegrams.commands("notch")
    assert direct.score == through_telegrams.score


@pytest.mark.long_after(4)
@pytest.mark.parametrize(
    "timing",
    [
        "control_period_ms = 200",
        # The period begins between two polls.
        "control_period_ms = 330",
        # Shorter than the poll's period: periods are left out.
        "control_period_ms = 200\nport_period_ms = { NOTCH_CMD = 240 }\n[watch]\nhold_ms = 230\ntraction_cut_ms = 240",
        "port_period_ms = { NOTCH_CMD = 30 }",
        "control_period_ms = 330\nport_period_ms = { NOTCH_CMD = 10, SIM_TRUTH = 40 }",
        # The position that the law sees is older than its poll.
        "control_period_ms = 330\nport_period_ms = { NOTCH_CMD = 10, TRN_POS = 160 }",
        "base_tick_ms = 5",
        "base_tick_ms = 20",
    ],
)
@pytest.mark.parametrize("indexing", ["time", "distance"])
def test_direct_coupling_is_the_same_loop_at_any_period(tmp_path, timing, indexing):
    path = tmp_path / "timing.toml"
    path.write_text(f"{QUICK_TOML}[timing]\n{timing}\n")
    scenario = load(str(path))
    through_telegrams = local_run(scenario, tmp_path, RunSpec(law=LawSpec(indexing=indexing), seed=1))
    direct = direct_run(scenario, RunSpec(law=LawSpec(indexing=indexing), seed=1))
    for port in (NotchCmd.PORT, SimTruth.PORT):
        assert direct.trace.times_s(port).tolist() == through_telegrams.trace.times_s(port).tolist(), port
    assert direct.commands("notch") == through_telegrams.commands("notch")
    assert direct.score == through_telegrams.score


def test_controller_has_no_mailbox_for_the_truth(lvshun):
    node = ControllerNode(lvshun, LawSpec())
    assert SimTruth not in MAILBOXES
    assert SimTruth.PORT not in node.responder.store.ports
    truth_ids = set(SimTruth.port().can_ids)
    for count, can_id in enumerate(sorted(truth_ids), 1):
        node.handle(Frame(can_id, bytes(8)))
        assert node.counters == {"no_mailbox": count}


def test_scrambled_truth_changes_nothing_for_the_controller(brief, brief_run, tmp_path):
    truth_ids = set(SimTruth.port().can_ids)

    def wire(frame: Frame) -> list[Frame]:
        return [frame._replace(data=b"\xa5" * 8)] if frame.can_id in truth_ids else [frame]

    assert local_run(brief, tmp_path, RunSpec(seed=1), wire=wire).commands("notch") == brief_run.commands("notch")


def test_control_status_follows_the_law(nominal):
    basis = set(nominal.trace.raw(CtlStat.PORT, "Note1").tolist())
    assert {1, 2} <= basis
    softening = nominal.trace.values(CtlStat.PORT, "Note2")
    assert softening[5:].min() >= 0.76
    assert softening.max() <= 0.851


def test_measured_bus_load_is_the_computed_one(nominal):
    """The record's bits per second against the load formula (events and handshake are the difference)."""
    from railhil.bus.schedule import bus_load, longest_frame_bits
    from railhil.record.framelog import read_log

    assert nominal.log is not None
    frames = list(read_log(nominal.log))
    bits = sum(longest_frame_bits(len(frame.data)) for _, frame in frames)
    measured = bits / (frames[-1][0] / 1e9) / 500_000
    loads = bus_load(wire_contract(), 500_000)
    usual = sum(loads[port.name] for port in wire_contract().ports if not port.optional)
    assert measured == pytest.approx(usual, rel=0.02)
