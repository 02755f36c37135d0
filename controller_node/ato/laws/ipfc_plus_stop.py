"""IPFC+ with an end phase: the last seconds before the stop are aimed at the stopping point.

IPFC+ brings the errors of position and speed to zero at the planned stop until some 2 s before it, and cannot do both
afterwards. From a chosen speed on, this law weighs the remaining errors: the place of the stop counts most, its time
less. Position and speed are predicted with the commands still on their way, and the observer's disturbance is
subtracted as in IPFC+. The equations are in ``docs/explanation/ipfc_plus.md``, and what each element contributes in
``docs/reference/ipfc_plus_results.md``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.balise_odometer import BaliseOdometer, BaliseState, Place
from railhil.controller_node.ato.ipfc_plus_constants import (
    ACCEL_Q,
    GAP_Q,
    POSITION_GAIN_Q,
    SHARE_Q,
    UNIT_Q,
    WHEEL_Q,
)
from railhil.controller_node.ato.ipfc_plus_stop_constants import (
    DESIGN_SEEDS,
    STOP_GAIN_Q,
    STOP_TUNABLE,
    IpfcPlusStopConstants,
    IpfcPlusStopParameters,
    stop_constants,
)
from railhil.controller_node.ato.laws.ipfc_plus import IpfcPlusCore
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, LawInputs, LawOutputs, State, TrackInputs
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
    """The part of the law that observes and predicts. Speeds in km/h (Q20), notch in notches.

    The observer of IPFC+ knows one lag, which shifts the force in time. Here the actuator's time constant is an unknown
    of its own, apart from the loop's delay: its error shows as the lagged notch minus the same notch lagged once more
    (:func:`railhil.controller_node.ato.ipfc_plus_design.stop_observer_gains` has the equations). The force is then
    known well enough that the disturbance may be held nearly constant, and noise of the speed is averaged over a longer
    time.
    """

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


class WheelBounds(NamedTuple, Generic[T]):
    """Bounds of the wheel error (Q ``WHEEL_Q``)."""

    low: T
    high: T


class SurveyOdometer(Generic[T]):
    """Bounds of the wheel error from balises whose survey has a tolerance, beside the fit of a :class:`BaliseOdometer`.

    Every balise passed at odometer o bounds the wheel error w: its true position o (1 + w) lies within the tolerance t
    of the surveyed one s, so that w is between (s - t - o) / o and (s + t - o) / o. The middle of the interval that all
    balises leave has the smallest largest error, and with survey errors spread evenly over the tolerance also the
    smallest median (the midrange; the fit is the best one for normal errors). If the interval is empty, the tolerance
    was wrong, and the fit is used.
    """

    def __init__(self, arithmetic: Arithmetic[T], table: IpfcPlusStopConstants, fit: BaliseOdometer[T]) -> None:
        self._ar = ar = arithmetic
        self._per_distance = ar.const(fit.per_distance)
        self._to_share = fit.per_distance.q - SHARE_Q
        self._to_error = fit.per_distance.q - WHEEL_Q
        self._odometer_max = ar.const(table.odometer_max)
        self._wheel_max = ar.const(table.wheel_max)
        self._wheel_min = ar.neg(self._wheel_max)
        self._tolerance = ar.const(table.tolerance)
        self._bounds = ar.const(table.bound_max), ar.neg(ar.const(table.bound_max))
        self._share_min = ar.const(table.share_min)
        self._half = ar.const(table.half)
        self._zero = ar.const(table.zero)

    def start(self) -> WheelBounds[T]:
        """Before any balise: the whole range of wheels."""
        return WheelBounds(self._wheel_min, self._wheel_max)

    def step(
        self,
        state: WheelBounds[T],
        fits: tuple[BaliseState[T], BaliseState[T]],
        track: TrackInputs[T],
        fitted: Place[T],
    ) -> tuple[WheelBounds[T], Place[T]]:
        """Include a new balise.

        :param fits: the fit before it and with it; a balise that the fit ignored bounds nothing.
        :param fitted: the place by the fit.
        """
        ar, (before, after), (_, surveyed, passed) = self._ar, fits, track.balise
        surveyed = ar.clip(surveyed, self._odometer_max, self._zero)
        passed = ar.clip(passed, self._odometer_max, self._zero)
        share = ar.rmpy(passed, self._per_distance, self._to_share)
        error = ar.clip(ar.rmpy(ar.sub(surveyed, passed), self._per_distance, self._to_error), *self._bounds)
        divisor = ar.convert(ar.maximum(share, self._share_min), SHARE_Q, WHEEL_Q)
        low = ar.div(ar.sub(error, self._tolerance), divisor, WHEEL_Q)
        high = ar.div(ar.add(error, self._tolerance), divisor, WHEEL_Q)
        taken, far = ar.gt(after.squares, before.squares), ar.gt(share, self._share_min)

        def tightened(bound: T, old: T) -> T:
            limited = ar.clip(bound, self._wheel_max, self._wheel_min)
            return ar.where(taken, ar.where(far, limited, old), old)

        low = ar.note("wheel_low", tightened(ar.maximum(low, state.low), state.low), WHEEL_Q)
        high = ar.note("wheel_high", tightened(ar.minimum(high, state.high), state.high), WHEEL_Q)
        middle = ar.rmpy(ar.add(low, high), self._half, UNIT_Q)
        wheel = ar.note("wheel_bounded", ar.where(ar.gt(low, high), fitted.wheel, middle), WHEEL_Q)
        correction = ar.rmpy(fitted.odometer, wheel, WHEEL_Q - GAP_Q)
        correction = ar.note("place_correction", correction, GAP_Q, "0.1 mm")
        return WheelBounds(low, high), Place(wheel, fitted.odometer, correction)


_GAP_TO_ACCEL = GAP_Q + POSITION_GAIN_Q - ACCEL_Q
_GAP_TO_STOP_ACCEL = GAP_Q + STOP_GAIN_Q - ACCEL_Q


class IpfcPlusStopState(NamedTuple, Generic[T]):
    """Memory of the law between two control periods; the notches last sent and the one before in Q24."""

    observer: StopObserverState[T]
    notch: T
    notch_before: T
    balises: BaliseState[T]
    wheel: WheelBounds[T]


class IpfcPlusStop(StopObserver[T, IpfcPlusStopState[T]]):
    """The law on one arithmetic.

    Raises ``ValueError`` for parameters that do not fit the scenario.
    """

    name: ClassVar[str] = "ipfc_plus_stop"
    parameters_type: ClassVar[type[Any]] = IpfcPlusStopParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = STOP_TUNABLE
    parameters_origin: ClassVar[str] = "designed on seeds 0 to 999"
    design_seeds: ClassVar[Mapping[str, range]] = DESIGN_SEEDS

    def __init__(
        self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: IpfcPlusStopParameters | None = None
    ) -> None:
        ar, given = arithmetic, parameters or IpfcPlusStopParameters()
        self.table = t = stop_constants(given, scenario)
        super().__init__(ar, scenario, t)
        rows = ("ending", "stop_by_position", "stop_by_speed", "stop_by_force")
        self._tables |= {name: ar.table(name, getattr(t, name)) for name in rows}
        self._survey = SurveyOdometer(ar, t, self._odometer)
        self._capture_position, self._capture_speed = self._both(t.capture_position), self._both(t.capture_speed)
        self._force_error = self._both(t.force_error_max)
        self._correction = self._both(t.correction_max)
        self._wheel_on_forces = given.wheel_on_forces

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        t = self.table
        bounds, wheel = super().state_bounds(), (-t.wheel_max.value, t.wheel_max.value)
        return bounds | {
            "observer.delay": (-t.delay_max.value, t.delay_max.value),
            "observer.lagged_twice": bounds["observer.lagged"],
            "wheel.low": wheel,
            "wheel.high": wheel,
        }

    def start(self, inputs: LawInputs[T]) -> IpfcPlusStopState[T]:
        """The nominal train with its actuator at rest."""
        zero = self._zero
        return IpfcPlusStopState(
            self._unobserved(inputs.speed), zero, zero, self._odometer.start(), self._survey.start()
        )

    def with_sent(self, state: IpfcPlusStopState[T], notch: T) -> IpfcPlusStopState[T]:
        return state._replace(notch=self._ar.convert(notch, NOTCH_Q, UNIT_Q))

    def step(self, state: IpfcPlusStopState[T], inputs: LawInputs[T]) -> tuple[IpfcPlusStopState[T], LawOutputs[T]]:
        ar, track = self._ar, inputs.track
        assert track, "the controller supplies track to a law that asks for it"
        planned = self._at(track.k)
        balises, fitted = self._odometer.step(state.balises, track)
        wheel, place = self._survey.step(state.wheel, (state.balises, balises), track, fitted)
        observer = self._observe(state.observer, (state.notch_before, state.notch), inputs.speed, planned)
        force, speed = self._ahead(observer, state.notch, planned)
        error_v, error_x = self._deviations(observer.speed, speed, place, planned)

        planned_force = self._at_the_wheel(planned["planned_force"], place)
        error_f = ar.sub(ar.sub(planned_force, observer.disturbance), force)
        correction = self._correct(planned, error_x, error_v, error_f)
        behind = ar.add(observer.lag, observer.delay)
        accel = ar.add(planned["feed_forward"], ar.rmpy(planned["force_rate"], behind, _UNIT_TO_UNIT))
        accel = ar.sub(self._at_the_wheel(accel, place), observer.disturbance)
        outputs = self._outputs(ar.add(accel, correction), observer.gain, planned)
        sent = ar.convert(outputs.notch, NOTCH_Q, UNIT_Q)
        return IpfcPlusStopState(observer, sent, state.notch, balises, wheel), outputs

    def _at_the_wheel(self, accel: T, place: Place[T]) -> T:
        """An acceleration of the train (km/h/s, Q22) as measured at its wheel: divided by 1 + w, to the first order."""
        if not self._wheel_on_forces:
            return accel
        return self._ar.sub(accel, self._ar.rmpy(accel, place.wheel, WHEEL_Q))

    def _correct(self, planned: dict[str, T], error_x: T, error_v: T, error_f: T) -> T:
        """Acceleration (km/h/s, Q22) that removes the errors: of the end phase near the plan, else of IPFC+."""
        ar = self._ar
        usual = ar.rmpy(error_x, planned["by_position"], _GAP_TO_ACCEL)
        usual = ar.add(usual, ar.rmpy(error_v, planned["by_speed"], _SPEED_BY_UNIT_TO_ACCEL))
        usual = ar.add(usual, ar.rmpy(error_f, self._by_force, _UNIT_TO_UNIT))
        near_x, near_v = ar.clip(error_x, *self._capture_position), ar.clip(error_v, *self._capture_speed)
        last = ar.rmpy(near_x, planned["stop_by_position"], _GAP_TO_STOP_ACCEL)
        last = ar.add(last, ar.rmpy(near_v, planned["stop_by_speed"], _SPEED_BY_UNIT_TO_ACCEL))
        near_f = ar.clip(error_f, *self._force_error)
        last = ar.add(last, ar.rmpy(near_f, planned["stop_by_force"], _UNIT_TO_UNIT))
        last = ar.note("stop_correction", ar.clip(last, *self._correction), ACCEL_Q, "km/h/s")
        off_x, off_v = ar.abs(ar.sub(error_x, near_x)), ar.abs(ar.sub(error_v, near_v))
        far = ar.where(ar.gt(off_x, self._zero), usual, ar.where(ar.gt(off_v, self._zero), usual, last))
        return ar.where(ar.gt(planned["ending"], self._zero), far, usual)
