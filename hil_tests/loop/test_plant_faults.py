"""Runs with faults of the plant: what the nodes make of them, from a scenario or a command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import Result, local_run
from railhil.bus.codes import FaultOrder
from railhil.bus.frame import Frame
from railhil.bus.layout import CHECK_ERRONEOUS
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource
from railhil.bus.telegrams import SupCmd
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.node import make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import CtlMode, NotchCmd, SimTruth, TrnPos, TrnSpeed, TrnWatch, WatchLevel

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return str(path)


def run(short: str, folder: Path, *faults: str, seed: int = 0, law: str = "ipfc") -> Result:
    folder.mkdir(exist_ok=True)
    scenario = load_any(short, (), faults)
    return local_run(scenario, folder, RunSpec(short, law=LawSpec(law, "float64"), seed=seed, faults=faults))


def first_s(made: Result, port: str, signal: str, least: int) -> float | None:
    """Simulation time at which a signal first has at least this raw value."""
    found = made.trace.times_s(port)[made.trace.raw(port, signal) >= least]
    return float(found[0]) if found.size else None


@pytest.mark.slow
def test_a_speed_sensor_that_is_off_cuts_the_traction(short: str, tmp_path: Path) -> None:
    """S1a: three telegrams without a valid value in ten."""
    made = run(short, tmp_path, "speed off @8s for 200ms")
    times_s, check = made.trace.times_s(TrnSpeed.PORT), made.trace.raw(TrnSpeed.PORT, "SpeedChk")
    off = times_s[check == CHECK_ERRONEOUS]
    assert (off[0], off[-1], off.size) == (8.0, 8.19, 20)
    assert made.counters["controller"]["check_variable"] == 20
    cut_s = first_s(made, NotchCmd.PORT, "CtlMode", CtlMode.TRACTION_CUT)
    assert cut_s is not None
    assert 8.0 < cut_s <= 8.07
    # The run goes on: the train stops by itself at the end of the journey.
    assert made.score.verdict in ("PASS", "FAIL")
    assert first_s(made, TrnWatch.PORT, "WatchLevel", WatchLevel.EMERGENCY) is None


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "raw"), [("speed value -1 @8s for 200ms", -10_000), ("speed value 800 @8s for 200ms", 8_000_000)]
)
def test_an_impossible_speed_is_a_bad_telegram(short: str, tmp_path: Path, fault: str, raw: int) -> None:
    """S4 and T18."""
    made = run(short, tmp_path, fault)
    speeds = made.trace.raw(TrnSpeed.PORT, "TrainSpeed")
    assert (speeds == raw).sum() == 20
    assert made.counters["controller"]["out_of_range"] == 20
    cut_s = first_s(made, NotchCmd.PORT, "CtlMode", CtlMode.TRACTION_CUT)
    assert cut_s is not None
    assert cut_s <= 8.05


@pytest.mark.slow
def test_a_state_that_is_not_a_number_is_no_verdict(short: str, tmp_path: Path) -> None:
    """S4b."""
    with pytest.raises(PlantError):
        run(short, tmp_path, "model nan @8s")
    ended = railhil(
        "run", short, "--bus", "local", "--no-report", "--fault", "model nan @8s", "--out", tmp_path / "out"
    )
    assert ended.exit_code == 4
    assert "not finite at tick 801" in ended.out + ended.err


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("fault", ["balise doubled @0s", "balise wrong 5m @0s", "balise off @0s", "balise missed @0s"])
def test_a_law_that_uses_balises_stands_faults_of_their_reader(fault: str, tmp_path: Path) -> None:
    """S3: it stops, and the train's watch stays at NORMAL."""
    path = tmp_path / "balises.toml"
    path.write_text(RUN_72M_TOML + "[[line.balises]]\nnumber = 1\nsurveyed_m = 30\n")
    made = run(str(path), tmp_path / "run", fault, law="ipfc_plus")
    assert made.score.ended == "ended_complete"
    last = made.trace.raw(TrnWatch.PORT, "WatchLevel")
    assert (last[10:] == WatchLevel.NORMAL).all()


def test_an_odometer_that_jumps_shows_in_the_record(short: str, tmp_path: Path) -> None:
    made = run(short, tmp_path, "position jump 30m @8s")
    read_mm = made.trace.raw(TrnPos.PORT, "TrainPos")[:1000]
    true_mm = made.trace.raw(SimTruth.PORT, "TruePos")[:1000] / 10
    error_m = (read_mm - true_mm) / 1000
    at = made.trace.times_s(TrnPos.PORT)[:1000] >= 8.0
    assert abs(error_m[~at]).max() < 0.02
    assert abs(error_m[at] - 30.0).max() < 0.02


def test_a_fault_is_injected_and_cleared_by_hand(short: str) -> None:
    """SUP_CMD orders it by its number; it acts from the next tick on."""
    scenario = load_any(short, (), ("speed wrong 1.5 @20s", "doors off @manual"))
    spec = RunSpec(short, law=LawSpec("ipfc", "float64"))
    session, node = make_session(scenario, lambda line: None, spec), ControllerNode(scenario, spec.law)
    source, port = TelegramSource(SupCmd.port()), SupCmd.port()

    def supervisor(frame: Frame) -> list[Frame]:
        found: list[Frame] = []
        for answer in session.handle(frame):
            if answer.can_id == port.address and 5.0 < session.sim_time_s < 7.0:
                order = SupCmd.decode(answer.data[: port.data_bytes])
                order.fault_number, order.fault_order = (
                    2,
                    FaultOrder.INJECT if session.sim_time_s < 6.0 else FaultOrder.CLEAR,
                )
                found += source.frames(order.encode())
            else:
                found.append(answer)
        return found

    plant = make_plant_node(scenario, spec, LocalBus([node.handle, supervisor]))
    plant.run()
    assert plant.faults.inside is not None
    wrong, doors = plant.faults.inside.activities
    assert wrong.begun_ns == 20_000_000_000
    assert doors.begun_ns is not None
    assert 5.0 < doors.begun_ns / 1e9 < 5.3
    assert doors.ended_ns is not None
    assert 6.0 < doors.ended_ns / 1e9 < 6.3
    assert doors.hits == 1
