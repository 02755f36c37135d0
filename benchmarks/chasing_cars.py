"""The benchmark "chasing cars" (CC) of ARCH-COMP's falsification category: model, requirements and inputs.

Five cars run towards minus infinity. Throttle and brake move the first one, each of the others follows the one before
it in three modes (Hu, Lygeros and Sastry, "Towards a Theory of Stochastic Hybrid Systems", HSCC 2000). The
equations, guards and first modes are those of the charts of the category's ``cars.mdl``. Requirements: CC1 to CC5 and
CCx of the category, each as a sentence that says the same at samples of 10 ms.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numba
import numpy as np

from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.signals import SignalJudge
from railhil.study.descent import Margins

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

CARS = 5
#: End of a run, and the time between two samples.
END_S, SAMPLE_NS = 100, 10_000_000
#: Instants of changes of mode are found to this time; more changes than these between two samples are left out.
_EVENT_S, _CHANGES_MAX = 1e-12, 100
#: A smaller brake is none: the solution divides by it.
_BRAKE_MIN = 1e-6
_SAMPLES = END_S * 1_000_000_000 // SAMPLE_NS + 1
_CHASING, _KEEPING, _BRAKING = 0, 1, 2

#: Requirement -> sentence (the formulas: docs/reference/falsification.md). A window in the past of its last instant
#: is the same as one in the future of its first.
SENTENCES = {
    "CC1": "always y5 - y4 <= 40 m",
    "CC2": "from 30 s to end, always highest(y5 - y4, 30 s) >= 15 m",
    "CC3": "from 20 s to end, always highest(y2 - y1, 20 s) <= 20 m or highest(y5 - y4, 20 s) >= 40 m",
    "CC4": "from 35 s to end, always highest(lowest(y5 - y4, 5 s), 30 s) >= 8 m",
    "CC5": "from 28 s to end, always "
    "highest(max(9 m - before(lowest(y2 - y1, 5 s), 15 s), lowest(y5 - y4, 15 s) - 9 m), 8 s) >= 0 m",
    "CCx": "from 0 s to 50 s, always y2 - y1 > 7.5 m and y3 - y2 > 7.5 m and y4 - y3 > 7.5 m and y5 - y4 > 7.5 m",
}
_UNITS = {f"y{car}": "m" for car in range(1, CARS + 1)}


@numba.njit(cache=True)
def _move(y: Floats, v: Floats, modes: NDArray[np.int64], inputs: tuple[float, float], span_s: float) -> Floats:
    """Places and speeds (2, cars) after a time without a change of mode: each motion is solved exactly."""
    throttle, brake = inputs
    found = np.empty((2, CARS))
    if brake > _BRAKE_MIN:  # v' = -throttle - brake v, y' = v
        final, kept = -throttle / brake, math.exp(-brake * span_s)
        found[0, 0] = y[0] + final * span_s + (v[0] - final) * (1 - kept) / brake
        found[1, 0] = final + (v[0] - final) * kept
    else:
        found[0, 0] = y[0] + v[0] * span_s - throttle * span_s**2 / 2
        found[1, 0] = v[0] - throttle * span_s
    for car in range(1, CARS):
        if modes[car] == _CHASING:  # v' = 1, y' = -v
            found[0, car] = y[car] - v[car] * span_s - span_s**2 / 2
            found[1, car] = v[car] + span_s
        elif modes[car] == _KEEPING:  # v' = 0, y' = v
            found[0, car] = y[car] + v[car] * span_s
            found[1, car] = v[car]
        else:  # v' = -v, y' = -v
            kept = math.exp(-span_s)
            found[0, car] = y[car] - v[car] * (1 - kept)
            found[1, car] = v[car] * kept
    return found


@numba.njit(cache=True)
def _next_mode(mode: int, gap: float) -> int:
    """The guards of the charts; ``gap``: to the car before it."""
    if mode == _CHASING:
        return _KEEPING if gap <= 10 else mode
    if mode == _KEEPING:
        return _CHASING if gap >= 15 else _BRAKING if gap <= 5 else mode
    return _CHASING if gap >= 20 else mode


@numba.njit(cache=True)
def _changes(y: Floats, modes: NDArray[np.int64]) -> bool:
    """Whether a guard holds."""
    for car in range(1, CARS):  # noqa: SIM110 (numba compiles no generator here)
        if _next_mode(modes[car], y[car] - y[car - 1]) != modes[car]:
            return True
    return False


@numba.njit(cache=True)
def _drive(throttle: Floats, brake: Floats, places: Floats) -> None:
    """Fill ``places`` (samples, cars) with a run; inputs (samples,) hold from their sample to the next."""
    state = np.zeros((2, CARS))
    state[0] = np.arange(CARS) * 10.0
    # Every chart begins in the mode Keeping.
    modes = np.full(CARS, _KEEPING)
    for sample in range(len(places)):
        places[sample] = state[0]
        inputs, left_s = (throttle[sample], brake[sample]), SAMPLE_NS / 1e9
        for _ in range(_CHANGES_MAX):
            reached = _move(state[0], state[1], modes, inputs, left_s)
            if not _changes(reached[0], modes):
                state = reached
                break
            # The first instant at which a guard holds.
            before_s, at_s = 0.0, left_s
            while at_s - before_s > _EVENT_S:
                middle_s = (before_s + at_s) / 2
                if _changes(_move(state[0], state[1], modes, inputs, middle_s)[0], modes):
                    at_s = middle_s
                else:
                    before_s = middle_s
            state = _move(state[0], state[1], modes, inputs, at_s)
            left_s -= at_s
            for car in range(1, CARS):
                modes[car] = _next_mode(modes[car], state[0, car] - state[0, car - 1])


def drive(throttle: Floats, brake: Floats) -> dict[str, Floats]:
    """The places y1 to y5 in m each 10 ms from 0 to 100 s.

    :param throttle, brake: 0 to 1 at each sample, shape (10001,); each value holds to the next one.
    """
    places = np.empty((_SAMPLES, CARS))
    _drive(np.ascontiguousarray(throttle), np.ascontiguousarray(brake), places)
    return {name: np.ascontiguousarray(places[:, car]) for car, name in enumerate(_UNITS)}


def pieces(values: Floats) -> Floats:
    """Inputs at each sample from control points, shape (count,), at equal distances from 0: piecewise constant."""
    instants = np.arange(_SAMPLES) / (_SAMPLES - 1)
    return np.asarray(values)[np.minimum((instants * len(values) + 1e-9).astype(int), len(values) - 1)]


def judge(name: str) -> SignalJudge:
    """The judge of one requirement."""
    return SignalJudge([Requirement(name, SENTENCES[name])], _UNITS, SAMPLE_NS)


def margins(name: str, points: int) -> Margins:
    """The margins of blocks of inputs (n, 2 ``points``): values 0 to 1 of throttle, then of brake."""
    judged = judge(name)

    def margin(inputs: Floats) -> float:
        (outcome,) = judged.outcomes(drive(pieces(inputs[:points]), pieces(inputs[points:])))
        assert outcome.margin is not None
        # A violation at the limit itself has the margin 0.
        return min(outcome.margin, -math.ulp(0.0)) if outcome.violated else outcome.margin

    return lambda block: np.array([margin(inputs) for inputs in block])
