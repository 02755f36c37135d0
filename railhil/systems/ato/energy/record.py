"""Work of a recorded run, from the truth on its bus: traction, regenerated, and its share of the bound.

The port SIM_TRUTH has these signals in every system with this train, so a section of a longer run is an interval of its
time.
"""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge import measures
from railhil.systems.ato.scenario.effort import force_limit_n
from railhil.systems.ato.scenario.model import Scenario

_TRUTH = "SIM_TRUTH"


def traction_work_kj(trace: Trace, from_s: float = 0.0, to_s: float = inf) -> float:
    """Work of the traction at the wheel between two times of a run, kJ; 0 if the record has no truth there."""
    time_s, speed_mps, rows = _read_truth(trace, from_s, to_s)
    return work_kj(time_s, trace.values(_TRUTH, "TractionForce")[rows] * speed_mps)


def regenerated_kj(scenario: Scenario, trace: Trace, from_s: float = 0.0, to_s: float = inf) -> float | None:
    """Work that is fed back between two times of a run, kJ: ``eta_r * integral of min(F_brake, F_el(v)) ds``.

    eta_r is ``energy.regenerative_efficiency``, F_el the force limit ``train.electric_brake``; the friction brake is
    taken to begin where the electric brake ends (chosen).

    :returns: None if the train's electric brake is not known.
    """
    time_s, speed_mps, rows = _read_truth(trace, from_s, to_s)
    return electric_work_kj(scenario, time_s, speed_mps, trace.values(_TRUTH, "BrakeForce")[rows])


def electric_work_kj(
    scenario: Scenario, time_s: FloatArray, speed_mps: FloatArray, brake_n: FloatArray
) -> float | None:
    """As :func:`regenerated_kj`, from samples of shape (n,) in the order of time."""
    if scenario.train.electric_brake is None:
        return None
    electric_n = np.minimum(brake_n, force_limit_n(scenario.train.electric_brake, speed_mps))
    return scenario.energy.regenerative_efficiency * work_kj(time_s, electric_n * speed_mps)


def energy_share_percent(work_kj: float, bound_kj: float) -> float:
    """Traction work as a percentage of the bound of the same section at the time that the run took; inf if that is
    0, as for a train that rolls."""
    return 100 * work_kj / bound_kj if bound_kj > 0.0 else inf


def _read_truth(trace: Trace, from_s: float, to_s: float) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Times (s) and speeds (m/s) between two times, and the rows of the telegrams; one recorded twice counts once."""
    time_s = trace.times_s(_TRUTH)
    fresh = np.diff(time_s, prepend=-1.0) > 0
    rows = np.flatnonzero(fresh & (time_s >= from_s) & (time_s <= to_s))
    return time_s[rows], trace.values(_TRUTH, "TrueSpeed")[rows], rows


def work_kj(time_s: FloatArray, power_w: FloatArray) -> float:
    """Work of a power over samples of shape (n,) in the order of time, kJ."""
    return float(measures.total(measures.work_j(np.diff(time_s), power_w[:-1], power_w[1:]))) / 1000
