"""Filters of the measured speed: pure steps that take the five samples of a cycle and give one estimate.

The wavelet packet (equation (3)) with node aaa kept is the approximation of the three-level wavelet transform, and on a
fixed window a fixed FIR filter. Read 63 samples behind the newest one, it has its full benefit (noise power 1/8) and
lags by 202 ms.

The weights come from ``taps.json``, written by ``make_taps.py``, which needs PyWavelets.
"""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Generic, Literal, NamedTuple, TypeVar, get_args

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.numbers import ACCEL_Q, GAIN_Q, SPEED_Q, Numbers

#: Steps of the Riccati equation, and the relative change at which it has settled.
_STEPS = 200_000
_SETTLED = 1e-14


def steady_gains(period_s: float, noise_mps: float, walk: float) -> tuple[float, float]:
    """Steady-state gains of the Kalman filter on the innovation: of the speed (1) and of the acceleration (1/s).

    The model is v+ = v + T a, a+ = a + w; only sums, products and quotients, so that it has the same bits everywhere.

    :param noise_mps: standard deviation of a reading. :param walk: of ``a`` after one second, m/s2.
    :raises ValueError: noise or walk are not positive.
    """
    if not (noise_mps > 0.0 and walk > 0.0):
        raise ValueError(f"noise {noise_mps:g} m/s and walk {walk:g} m/s2 must be positive")
    reading, walked = noise_mps * noise_mps, walk * walk * period_s
    vv, va, aa = reading, 0.0, 1.0
    before = (0.0, 0.0)
    for _ in range(_STEPS):
        vv, va, aa = vv + 2.0 * period_s * va + period_s * period_s * aa, va + period_s * aa, aa + walked
        variance = vv + reading
        gains = (vv / variance, va / variance)
        vv, va, aa = reading * gains[0], reading * gains[1], aa - gains[1] * va
        if all(abs(new - old) <= _SETTLED * new for new, old in zip(gains, before, strict=True)):
            break
        before = gains
    return before


PATH = Path(__file__).with_name("taps.json")


@cache
def document(path: Path = PATH) -> dict[str, Any]:
    """The file: ``low_pass`` (16 numbers of db8), ``rate_hz``, and ``taps`` by filter, oldest sample first.

    :raises InputError: its numbers differ from the recorded ones.
    """
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    text = json.dumps(found["taps"], sort_keys=True, separators=(",", ":"))
    sha256 = hashlib.sha256(text.encode()).hexdigest()
    if sha256 != found["taps_sha256"]:
        raise InputError(path, "taps_sha256", sha256, f"{found['taps_sha256']}, as recorded")
    return found


def taps(name: str) -> tuple[float, ...]:
    """Weights of one filter.

    :raises KeyError: there is no such filter.
    """
    return tuple(document()["taps"][name])


State = TypeVar("State")

#: Samples in a cycle, and their spacing.
SAMPLES = 5
SAMPLE_S = 0.0032
#: Bounds of an estimated acceleration or disturbance, m/s2.
_ACCEL_MPS2 = 8.0


class SpeedFilter(ABC, Generic[T, State]):
    """``warm_up``: samples after which the estimate no longer depends on the first one. ``lag_s``: its delay."""

    warm_up: int
    lag_s: float

    def __init__(self, numbers: Numbers[T]) -> None:
        self.numbers = numbers
        self.ar = numbers.ar

    @abstractmethod
    def start(self, speed: T) -> State:
        """State of a filter that has always seen ``speed`` (m/s, Q ``SPEED_Q``)."""

    @abstractmethod
    def step(self, state: State, samples: Sequence[T], accel: T) -> tuple[State, T]:
        """One cycle.

        :param samples: speeds, m/s, oldest first.
        :param accel: acceleration that the commands give by the model, m/s2 (Q ``ACCEL_Q``).
        """


class Fir(SpeedFilter[T, tuple[T, ...]]):
    """Weighted sum of the last samples.

    :param weights: oldest first.
    """

    def __init__(self, numbers: Numbers[T], name: str, weights: Sequence[float], lag_samples: float) -> None:
        super().__init__(numbers)
        self.warm_up = len(weights)
        self.lag_s = lag_samples * SAMPLE_S
        self._taps = numbers.hold_all(name, weights, GAIN_Q, "taps.json")

    def start(self, speed: T) -> tuple[T, ...]:
        return (speed,) * self.warm_up

    def step(self, state: tuple[T, ...], samples: Sequence[T], accel: T) -> tuple[tuple[T, ...], T]:
        window = (*state, *samples)[-self.warm_up :]
        return window, self.ar.dot(self._taps, window, GAIN_Q)


class Newest(SpeedFilter[T, tuple[T, ...]]):
    """No filter: the newest sample."""

    warm_up = 1
    lag_s = 0.0

    def start(self, speed: T) -> tuple[T, ...]:
        return ()

    def step(self, state: tuple[T, ...], samples: Sequence[T], accel: T) -> tuple[tuple[T, ...], T]:
        return (), samples[-1]


class BiquadState(NamedTuple, Generic[T]):
    """Last two inputs and outputs, newest first, m/s."""

    inputs: tuple[T, T]
    outputs: tuple[T, T]


class Biquad(SpeedFilter[T, BiquadState[T]]):
    """Butterworth low-pass of second order, 2 Hz."""

    warm_up = 256
    lag_s = 0.1125

    def __init__(self, numbers: Numbers[T]) -> None:
        super().__init__(numbers)
        origin = "taps.json"
        self._b = numbers.hold_all("butterworth_b", taps("butterworth2_2hz_b"), GAIN_Q, origin)
        feedback = [-value for value in taps("butterworth2_2hz_a")[1:]]
        self._a = numbers.hold_all("butterworth_a", feedback, GAIN_Q, origin)

    def start(self, speed: T) -> BiquadState[T]:
        return BiquadState((speed, speed), (speed, speed))

    def step(self, state: BiquadState[T], samples: Sequence[T], accel: T) -> tuple[BiquadState[T], T]:
        ar, held = self.ar, self.numbers
        inputs, outputs = state
        for sample in samples:
            forward = ar.dot(self._b, (sample, *inputs), GAIN_Q)
            total = ar.add(forward, ar.dot(self._a, outputs, GAIN_Q))
            inputs, outputs = (sample, inputs[0]), (ar.clip(total, held.fastest, held.slowest), outputs[0])
        return BiquadState(inputs, outputs), outputs[0]


class TwoState(NamedTuple, Generic[T]):
    """``speed``, m/s; ``accel``: acceleration, or the disturbance if the command is known, m/s2."""

    speed: T
    accel: T


class Kalman(SpeedFilter[T, TwoState[T]]):
    """Steady Kalman filter of speed and acceleration, at each sample.

    :param noise_mps: of a sample. :param walk: of the second state, m/s2 in a second (standard deviation).
    :param command: the commands are known, and the second state is the disturbance.
    """

    warm_up = 512
    lag_s = 0.0

    def __init__(self, numbers: Numbers[T], noise_mps: float, walk: float, *, command: bool) -> None:
        super().__init__(numbers)
        on_speed, on_accel = steady_gains(SAMPLE_S, noise_mps, walk)
        self._on_speed = numbers.hold("kalman_speed", on_speed, GAIN_Q, "steady state of the Kalman filter")
        self._on_accel = numbers.hold("kalman_accel", on_accel, 24, "steady state of the Kalman filter")
        self._period = numbers.hold("sample", SAMPLE_S, GAIN_Q, "port table")
        self._most = numbers.hold("filter_accel", _ACCEL_MPS2, ACCEL_Q, "law")
        self._least = numbers.hold("minus_filter_accel", -_ACCEL_MPS2, ACCEL_Q, "law")
        self._command = command

    def start(self, speed: T) -> TwoState[T]:
        return TwoState(speed, self.numbers.zero)

    def step(self, state: TwoState[T], samples: Sequence[T], accel: T) -> tuple[TwoState[T], T]:
        ar, held = self.ar, self.numbers
        speed, found = state
        known = accel if self._command else held.zero
        for sample in samples:
            gained = ar.mpy_iqx(ar.add(known, found), ACCEL_Q, self._period, GAIN_Q, SPEED_Q)
            guess = ar.add(speed, gained)
            error = ar.clip(ar.sub(sample, guess), held.fastest, held.slowest)
            corrected = ar.add(guess, ar.mpy(error, self._on_speed, GAIN_Q))
            speed = ar.clip(corrected, held.fastest, held.slowest)
            found = ar.add(found, ar.mpy_iqx(error, SPEED_Q, self._on_accel, 24, ACCEL_Q))
            found = ar.clip(found, self._most, self._least)
        return TwoState(speed, found), speed


FilterName = Literal[
    "none",
    "packet",
    "packet_8",
    "packet_newest",
    "packet_antireflect",
    "mean5",
    "mean16",
    "fir65",
    "iir",
    "kalman",
    "kalman_command",
]
FILTERS: tuple[str, ...] = get_args(FilterName)

#: Random walk of an acceleration that is not known, and of the disturbance where the command is known: m/s2 in a
#: second.
ACCEL_WALK = 0.30
DISTURBANCE_WALK = 0.036


def speed_filter(numbers: Numbers[T], name: str, noise_mps: float) -> SpeedFilter[T, Any]:
    """The filter of that name (one of :data:`FILTERS`).

    :param noise_mps: standard deviation of a sample, for which the Kalman filters are designed.
    """

    def packet(mode: str, lag: int) -> Callable[[], SpeedFilter[T, Any]]:
        return lambda: Fir(numbers, name, taps(f"packet_{mode}_{lag}"), lag)

    def mean(count: int) -> Callable[[], SpeedFilter[T, Any]]:
        return lambda: Fir(numbers, name, [1.0 / count] * count, (count - 1) / 2)

    made: dict[str, Callable[[], SpeedFilter[T, Any]]] = {
        "none": lambda: Newest(numbers),
        "packet": packet("symmetric", 63),
        "packet_8": packet("symmetric", 8),
        "packet_newest": packet("symmetric", 0),
        "packet_antireflect": packet("antireflect", 0),
        "mean5": mean(5),
        "mean16": mean(16),
        "fir65": lambda: Fir(numbers, name, taps("fir65_10hz"), 32),
        "iir": lambda: Biquad(numbers),
        "kalman": lambda: Kalman(numbers, noise_mps, ACCEL_WALK, command=False),
        "kalman_command": lambda: Kalman(numbers, noise_mps, DISTURBANCE_WALK, command=True),
    }
    return made[name]()
