"""The observer of ``ipfc_plus_stop``: that of IPFC+ with the actuator's time constant and the loop's delay apart.

The observer of IPFC+ knows one lag, which shifts the force in time. Here the time constant is an unknown of its own:
its error shows as the lagged notch minus the same notch lagged once more
(:mod:`railhil.controller_node.ato.stop_observer_design` has the equations). The force is then known well enough that
the disturbance may be held nearly constant, and noise of the speed is averaged over a longer time.
"""

from __future__ import annotations

from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.ipfc_plus_constants import ACCEL_Q, UNIT_Q
from railhil.controller_node.ato.ipfc_plus_stop_constants import IpfcPlusStopConstants
from railhil.controller_node.ato.laws.ipfc_plus import IpfcPlusCore
from railhil.controller_node.laws.base import SPEED_Q, State
from railhil.systems.ato.scenario.model import Scenario

_UNIT_TO_UNIT = UNIT_Q
_ACCEL_BY_UNIT_TO_SPEED = ACCEL_Q + UNIT_Q - SPEED_Q
_SPEED_BY_UNIT_TO_ACCEL = SPEED_Q + UNIT_Q - ACCEL_Q
_SPEED_BY_UNIT_TO_UNIT = SPEED_Q


class StopObserverState(NamedTuple, Generic[T]):
    """Estimated state of the train at the last reading.

    ``speed`` as measured at the wheel (km/h, Q20), ``disturbance`` (km/h/s, Q22), ``gain`` acceleration per notch
    (km/h/s, Q22), ``lag`` and ``delay`` by which the actuator's time constant and the loop's delay are longer than in
    the model (s, Q24), ``lagged`` and ``lagged_twice`` the notch after one and two of the model's lags (Q24).
    """

    speed: T
    disturbance: T
    gain: T
    lag: T
    delay: T
    lagged: T
    lagged_twice: T


class StopObserver(IpfcPlusCore[T, State]):
    """The part of the law that observes and predicts. Speeds in km/h (Q20), notch in notches."""

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, table: IpfcPlusStopConstants) -> None:
        super().__init__(arithmetic, scenario, table)
        ar = arithmetic
        self._tables["observe_delay"] = ar.table("observe_delay", table.observe_delay)
        self._twice, self._delay_twice = ar.load(table.twice), ar.load(table.delay_twice)
        self._delay_limits = self._both(table.delay_max)

    def _unobserved(self, speed: T) -> StopObserverState[T]:
        """The nominal train with its actuator at rest."""
        zero = self._zero
        return StopObserverState(speed, zero, self._gain, zero, zero, zero, zero)

    def _observe(
        self, old: StopObserverState[T], notches: tuple[T, T], speed: T, planned: dict[str, T]
    ) -> StopObserverState[T]:
        """Advance the observer from the last reading to this one: prediction, and correction by the surprise.

        :param notches: those sent two periods ago and one period ago (Q24).
        """
        ar = self._ar
        drive = (old.lagged, *notches)
        lagged = ar.note("lagged", ar.dot(self._lagged, drive, _UNIT_TO_UNIT), UNIT_Q, "notch")
        twice = ar.dot(self._twice, (old.lagged_twice, *drive), _UNIT_TO_UNIT)
        twice = ar.note("lagged_twice", twice, UNIT_Q, "notch")
        integral = ar.dot(self._integral, drive, _UNIT_TO_UNIT)
        gained = self._gained(old, integral, lagged, twice)
        expected, surprise = self._surprise(old.speed, old.disturbance, gained, speed, planned)

        def corrected(value: T, weight: str, shift: int, limits: tuple[T, T]) -> T:
            return self._corrected(value, surprise, planned[weight], shift, limits)

        to_accel, to_unit = _SPEED_BY_UNIT_TO_ACCEL, _SPEED_BY_UNIT_TO_UNIT
        seen = corrected(expected, "observe_speed", _UNIT_TO_UNIT, self._speed_limits)
        disturbance = corrected(old.disturbance, "observe_disturbance", to_accel, self._disturbance_limits)
        gain = corrected(old.gain, "observe_gain", to_accel, self._gain_limits)
        lag = corrected(old.lag, "observe_lag", to_unit, self._lag_limits)
        delay = corrected(old.delay, "observe_delay", to_unit, self._delay_limits)
        return StopObserverState(
            ar.note("observed_speed", seen, SPEED_Q, "km/h"),
            ar.note("disturbance", disturbance, ACCEL_Q, "km/h/s"),
            ar.note("gain", gain, ACCEL_Q, "km/h/s"),
            ar.note("lag", lag, UNIT_Q, "s"),
            ar.note("delay", delay, UNIT_Q, "s"),
            lagged,
            twice,
        )

    def _gained(self, old: StopObserverState[T], integral: T, lagged: T, twice: T) -> T:
        """Speed (km/h, Q20) gained from the actuator until the notches after one and two lags have these values."""
        ar = self._ar
        late = ar.rmpy(old.lag, ar.sub(twice, old.lagged_twice), _UNIT_TO_UNIT)
        late = ar.add(late, ar.rmpy(old.delay, ar.sub(lagged, old.lagged), _UNIT_TO_UNIT))
        return ar.rmpy(old.gain, ar.sub(integral, late), _ACCEL_BY_UNIT_TO_SPEED)

    def _ahead(self, observer: StopObserverState[T], notch: T, planned: dict[str, T]) -> tuple[T, T]:
        """Force (km/h/s, Q22) and speed at the wheel (km/h, Q20) when the next notch takes effect."""
        ar = self._ar
        drive = (observer.lagged, notch)
        lagged = ar.dot(self._delay_lagged, drive, _UNIT_TO_UNIT)
        integral = ar.dot(self._delay_integral, drive, _UNIT_TO_UNIT)
        twice = ar.dot(self._delay_twice, (observer.lagged_twice, *drive), _UNIT_TO_UNIT)
        late = ar.rmpy(observer.lag, ar.sub(lagged, twice), _UNIT_TO_UNIT)
        late = ar.add(late, ar.rmpy(observer.delay, ar.sub(notch, lagged), _UNIT_TO_UNIT))
        late = ar.rmpy(late, self._pole, _UNIT_TO_UNIT)
        force = ar.note("force", ar.rmpy(observer.gain, ar.sub(lagged, late), _UNIT_TO_UNIT), ACCEL_Q, "km/h/s")
        speed = ar.add(observer.speed, self._gained(observer, integral, lagged, twice))
        speed = ar.add(speed, ar.rmpy(observer.disturbance, self._delay, _ACCEL_BY_UNIT_TO_SPEED))
        return force, ar.sub(speed, planned["drag_over_delay"])
