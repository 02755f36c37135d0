"""The parameters of the laws of high-speed trains: the generator of their defaults.

Every law gets the same number of evaluations on one training seed, normal running only, of J = RMSE (km/h) + 2 RMS of
the command's slope (m/s^3), by Nelder and Mead's method on the logarithms of its parameters. The parameters are then
frozen; figures are measured on other seeds::

    python -m railhil.systems.high_speed.tuning pid mm_gpc
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from railhil.common.exit_codes import run_guarded
from railhil.controller_node.arithmetic import make
from railhil.controller_node.vector.controller import VectorLoop
from railhil.plant_sim.high_speed.train import HighSpeedTrain, Wayside
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.wire.power_units import ACCEL_PER_MPS2

SCENARIO = "jinan_xuzhou"
#: Seed of the training run, and evaluations for each law.
TRAINING_SEED = 100
EVALUATIONS = 40
#: Weight of the command's slope in J.
SLOPE_WEIGHT = 2.0
#: Scored while the target is at least this, m/s.
_SCORED_MPS = 0.5
_KMH = 3.6

#: Parameters that are tuned, with the values from which the search begins.
TUNED: Mapping[str, Mapping[str, float]] = {
    "pid": {"kp_per_s": 0.4, "ki_per_s2": 0.04, "kd": 0.1},
    "pid_ff": {"kp_per_s": 0.3, "ki_per_s2": 0.02, "kd": 0.1},
    "mm_gpc": {"control_weight": 3.0, "forgetting": 0.9},
    "a_gpc": {"control_weight": 9.0, "covariance": 0.05},
    "delay_gpc": {
        "control_weight": 5.0,
        "disturbance_walk_mps2": 0.006,
        "speed_walk_mps": 0.004,
        "gain_walk": 0.02,
    },
}


@dataclass(frozen=True)
class Journey:
    """A run without a bus: speed errors (km/h) in the scored control periods, commands (m/s^2) at each sample."""

    errors_kmh: NDArray[np.float64]
    commands_mps2: NDArray[np.float64]
    sample_s: float

    @property
    def rmse_kmh(self) -> float:
        """RMSE of the speed."""
        return float(np.sqrt(np.mean(self.errors_kmh**2)))

    @property
    def slope_mps3(self) -> float:
        """RMS of the command's slope."""
        return float(np.sqrt(np.mean((np.diff(self.commands_mps2) / self.sample_s) ** 2)))

    @property
    def cost(self) -> float:
        """J of the protocol."""
        return self.rmse_kmh + SLOPE_WEIGHT * self.slope_mps3


def journey(scenario: Any, law: str, seed: int, values: Mapping[str, Any] | None = None) -> Journey:
    """One run of a train of one unit in float64.

    :param scenario: of the system ``hst1``.
    :param values: parameters that differ from the law's defaults.
    :raises InputError: the law refuses them.
    """
    task = scenario.task
    given = ParameterSet(law, values, Path("tuning")) if values else None
    loop: Any = VectorLoop(scenario, LawSpec(law, parameters=given), make("float64"))
    tick_s, period_s = (ns / 1e9 for ns in (scenario.timing.base_tick_ns, scenario.timing.control_period_ns))
    ticks = round(period_s / tick_s)
    train, wayside = HighSpeedTrain(task, seed, tick_s), Wayside(task, tick_s)
    errors, commands = [], []
    for tick in range(0, round(task.duration_s / tick_s), ticks):
        now, *ahead = wayside.preview_raw(tick)
        _, answer = loop.step([train.read_speed_raw(0), *ahead, now, int(wayside.emergency)])
        train.commands_mps2[0] = answer.commands[0] / ACCEL_PER_MPS2
        target_mps = wayside.target_mps(tick)
        if target_mps >= _SCORED_MPS:
            errors.append((target_mps - train.speed_mps) * _KMH)
        commands.append(train.commands_mps2[0])
        for later in range(ticks):
            wayside.look(tick + later, train.position_m)
            train.advance()
    sample_s = loop.law.sample_s
    return Journey(np.array(errors), np.array(commands[:: round(sample_s / period_s)]), sample_s)


def tuned(scenario: Any, law: str) -> tuple[dict[str, float], list[float]]:
    """Best parameters of a law and J of each evaluation, in order."""
    start = TUNED[law]
    costs: list[float] = []
    best: tuple[float, dict[str, float]] = math.inf, dict(start)

    def cost(logarithms: NDArray[np.float64]) -> float:
        nonlocal best
        values = {name: _limited(name, math.exp(x)) for name, x in zip(start, logarithms, strict=True)}
        found = journey(scenario, law, TRAINING_SEED, values).cost
        costs.append(found)
        best = min(best, (found, values), key=lambda pair: pair[0])
        return found

    first = np.log(list(start.values()))
    corners = np.vstack([first, first + 0.7 * np.eye(len(first))])
    options = {"maxfev": EVALUATIONS, "initial_simplex": corners}
    minimize(cost, first, method="Nelder-Mead", options=options)
    return best[1], costs


def _limited(name: str, value: float) -> float:
    """A forgetting factor stays below 1."""
    return min(value, 0.9999) if name == "forgetting" else value


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tuned parameters of the laws."""
    parser = argparse.ArgumentParser(prog="python -m railhil.systems.high_speed.tuning", description=main.__doc__)
    parser.add_argument("law", nargs="*", choices=[[], *TUNED], metavar="LAW", help=f"of {', '.join(TUNED)}; all")
    scenario = load_any(SCENARIO)
    for law in parser.parse_args(arguments).law or TUNED:
        values, costs = tuned(scenario, law)
        listed = ", ".join(f"{name} = {value:.4g}" for name, value in values.items())
        print(f"{law}: J {costs[0]:.4f} -> {min(costs):.4f} in {len(costs)} evaluations: {listed}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("railhil.systems.high_speed.tuning", main))
