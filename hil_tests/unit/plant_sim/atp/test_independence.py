"""The train protection is independent: what it imports, what it gets, and that equal readings give equal demands."""

from __future__ import annotations

import ast
import subprocess
import sys
from dataclasses import astuple
from random import Random

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.protected_train import STOP_M, TRAIN, Worst, draw
from railhil.plant_sim.atp.protection import TrainProtection
from railhil.plant_sim.atp.readings import Authority, Demands, Readings, Track, TrainData
from railhil.systems.line.scenario.protection import Protection

FOLDER = ROOT / "plant_sim" / "atp"
#: Names of what a protection must not see: the true motion, the truth on the bus, the controller's command.
FORBIDDEN_NAMES = {"Motion", "SimTruth", "SIM_TRUTH", "NotchCmd", "NOTCH_CMD"}
_IMPORTED = """
import sys
from railhil.plant_sim.atp import protection
print(*sorted(name for name in sys.modules if name.startswith("railhil.")))
"""


def imported_packages() -> list[str]:
    found = subprocess.run([sys.executable, "-c", _IMPORTED], check=True, capture_output=True, text=True, timeout=60)
    return found.stdout.split()


def test_it_imports_no_controller_no_dynamics_no_telegrams() -> None:
    names = imported_packages()
    assert "railhil.plant_sim.atp.supervision" in names
    for forbidden in ("railhil.controller_node", "railhil.plant_sim.ato", "railhil.plant_sim.line", "railhil.bus"):
        assert not [name for name in names if name.startswith(forbidden)], forbidden
    assert not [name for name in names if name.startswith("railhil.wire.")]


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_no_module_names_the_motion_the_truth_or_the_command(path: object) -> None:
    tree = ast.parse((FOLDER / str(path)).read_text(encoding="utf-8"))
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    names |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    names |= {part.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for part in node.names}
    assert not names & FORBIDDEN_NAMES


def recorded(seed: int) -> tuple[Worst, list[Readings]]:
    """The readings of a train that moves as nobody has ordered."""
    rng = Random(seed)
    worst, readings = draw(rng), []
    speed_mps = odometer_m = 0.0
    authority = Authority(STOP_M + 10.0, STOP_M + 30.0)
    for tick in range(3000):
        speed_mps = max(0.0, min(23.0, speed_mps + rng.uniform(-0.02, 0.04)))
        before_m, odometer_m = odometer_m, odometer_m + speed_mps * 0.05
        passed = tuple((number, at_m) for number, at_m, _ in worst.balises if before_m < at_m <= odometer_m)
        readings.append(Readings(tick * 0.05, speed_mps, odometer_m, passed, authority, True, False))
    return worst, readings


def replay(worst: Worst, readings: list[Readings]) -> list[tuple[object, ...]]:
    protection = TrainProtection(
        Protection(),
        TrainData(TRAIN.length_m, TRAIN.speed_limit_mps),
        Track(worst.grade_permil, worst.limits_mps, tuple((number, at_m) for number, at_m, _ in worst.balises)),
        0.0,
    )
    return [astuple(protection.step(one)) for one in readings]


@pytest.mark.parametrize("seed", range(4))
def test_equal_readings_give_equal_demands_to_the_last_bit(seed: int) -> None:
    """Its whole input is in the readings: no telegram of a controller changes a bit while the motion is the same."""
    worst, readings = recorded(seed)
    first = replay(worst, readings)
    assert first == replay(worst, readings)
    # It has been in more than one status and at more than one permitted speed.
    assert len({row[3] for row in first}) > 1
    assert len({row[6] for row in first}) > 1


def test_readings_hold_nothing_of_a_controller() -> None:
    assert Readings._fields == (
        "time_s", "speed_mps", "odometer_m", "balises", "authority", "doors_locked", "train_held",
    )  # fmt: skip
    assert set(Demands.__slots__).isdisjoint(Readings._fields)
