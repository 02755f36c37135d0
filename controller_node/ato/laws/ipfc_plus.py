"""IPFC+: predictive functional control of speed and position with feed-forward of all known data.

railhil's own law, built around the core of the paper's law (an internal model, basis functions, fitting points, gains
computed offline). Known data of the run enter as tables over the control period number; unknown quantities (force per
notch, lag, remaining resistance, wheel circumference) are estimated on line. The equations
are in ``docs/explanation/ipfc_plus.md``, and what each element contributes in ``docs/reference/ipfc_plus_results.md``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.ato.balise_odometer import BaliseOdometer, BaliseState, Place
from railhil.controller_node.ato.ipfc_plus_constants import (
    ACCEL_Q,
    ADVANCE_Q,
    GAP_Q,
    POSITION_GAIN_Q,
    TUNABLE,
    UNIT_Q,
    WHEEL_Q,
    IpfcPlusConstants,
    IpfcPlusParameters,
    compute_constants,
)
from railhil.controller_node.ato.ipfc_plus_design import DESIGN_SEEDS
from railhil.controller_node.ato.pfc_model import BASIS_NOTE, SOFTENING_NOTE
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, SPEED_Q, Law, LawInputs, LawOutputs, State
from railhil.controller_node.laws.note import Note
from railhil.systems.ato.scenario.model import Scenario

# Shifts of the products: Q of the first factor + Q of the second - Q of the result.
_UNIT_TO_UNIT = UNIT_Q
_ACCEL_BY_UNIT_TO_SPEED = ACCEL_Q + UNIT_Q - SPEED_Q
_SPEED_BY_UNIT_TO_ACCEL = SPEED_Q + UNIT_Q - ACCEL_Q
_SPEED_BY_UNIT_TO_UNIT = SPEED_Q
_GAP_TO_ACCEL = GAP_Q + POSITION_GAIN_Q - ACCEL_Q
_SPEED_TO_GAP = SPEED_Q + ADVANCE_Q - GAP_Q
#: Tables of :class:`IpfcPlusConstants` over the number of the control period.
_OVER_TIME = (
    "target_position",
    "target_speed",
    "feed_forward",
    "planned_force",
    "force_rate",
    "notch_upper",
    "notch_lower",
    "drag_over_period",
    "drag_over_delay",
    "observe_speed",
    "observe_disturbance",
    "observe_gain",
    "observe_lag",
    "by_position",
    "by_speed",
)


class ObserverState(NamedTuple, Generic[T]):
    """Estimated state of the train at the last reading.

    ``speed`` as measured at the wheel (km/h, Q20), ``disturbance`` (km/h/s, Q22), ``gain`` acceleration per notch
    (km/h/s, Q22), ``lag`` the additional lag of the train compared with the model (s, Q24), ``lagged`` the notch after
    the actuator's lag (Q24).
    """

    speed: T
    disturbance: T
    gain: T
    lag: T
    lagged: T


class IpfcPlusState(NamedTuple, Generic[T]):
    """Memory of the law between two control periods; the notches last sent and the one before in Q24."""

    observer: ObserverState[T]
    notch: T
    notch_before: T
    balises: BaliseState[T]


class IpfcPlusCore(Law[T, State]):
    """Common part of the laws built on IPFC+: the surprise of a reading, the errors, and the notch for an acceleration.

    Speeds in km/h (Q20), notch in notches.
    """

    indexings: ClassVar[tuple[str, ...]] = ("time",)
    track: ClassVar[bool] = True
    notes: ClassVar[tuple[Note, ...]] = (BASIS_NOTE, SOFTENING_NOTE)

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, table: IpfcPlusConstants) -> None:
        self._ar = ar = arithmetic
        self._constants = t = table
        self._odometer = BaliseOdometer(ar, t, scenario.plan.distance_m)
        self._last_k = len(t.target_speed) - 1
        self._tables = {name: ar.table(name, getattr(t, name)) for name in _OVER_TIME}
        self._by_force = ar.const(t.by_force)
        self._lagged, self._integral = ar.load(t.lagged), ar.load(t.integral)
        self._delay_lagged, self._delay_integral = ar.load(t.delay_lagged), ar.load(t.delay_integral)
        self._pole, self._period, self._delay = ar.const(t.pole), ar.const(t.period), ar.const(t.delay)
        self._advance = ar.const(t.advance)
        self._gain = ar.const(t.gain)
        self._gain_limits = ar.const(t.gain_max), ar.const(t.gain_min)
        self._lag_limits = self._both(t.lag_max)
        self._disturbance_limits = self._both(t.disturbance_max)
        self._innovation_limits = self._both(t.innovation_max)
        self._standstill = ar.const(t.standstill)
        self._speed_limits = self._both(t.speed_max)
        self._speed_error_limits = self._both(t.speed_error_max)
        self._position_error_limits = self._both(t.position_error_max)
        self._gap_limits = self._both(t.gap_max)
        self._notch_max = scenario.train.notch_max
        self._basis = ar.const(t.basis)
        self._one_softening = ar.const(t.one_softening)
        self._zero = ar.const(t.zero)

    def _both(self, limit: Constant) -> tuple[T, T]:
        upper = self._ar.const(limit)
        return upper, self._ar.neg(upper)

    @property
    def horizon(self) -> int:
        """Zero: the set-points are in the law's own tables."""
        return 0

    @property
    def constants(self) -> tuple[Constant, ...]:
        return (*self._constants.entries(), self._odometer.per_distance)

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds of the clipped variables; in addition, the lagged notch is a mean of notches, and the balises' sums
        stop at their limit.

        A millionth is added for the rounding of the weights.
        """
        t = self._constants
        lagged = self._notch_max * (1 + 1e-6)
        return {
            "observer.speed": (-t.speed_max.value, t.speed_max.value),
            "observer.disturbance": (-t.disturbance_max.value, t.disturbance_max.value),
            "observer.gain": (t.gain_min.value, t.gain_max.value),
            "observer.lag": (-t.lag_max.value, t.lag_max.value),
            "observer.lagged": (-lagged, lagged),
            "balises.squares": (t.prior.value / 2, t.sum_max.value),
            "balises.errors": (-t.sum_max.value, t.sum_max.value),
        }

    def _at(self, k: T) -> dict[str, T]:
        """Entries of the tables for control period ``k``."""
        index = self._ar.index(k, self._last_k)
        return {name: self._ar.at(table, index) for name, table in self._tables.items()}

    def _outputs(self, accel: T, gain: T, planned: dict[str, T]) -> LawOutputs[T]:
        """The notch for an acceleration.

        :param gain: acceleration per notch (km/h/s, Q22).
        """
        ar = self._ar
        accel = ar.note("accel", accel, ACCEL_Q, "km/h/s")
        notch_raw = ar.note("notch_raw", ar.div(accel, gain, NOTCH_RAW_Q), NOTCH_RAW_Q, "notch")
        clipped = ar.clip(notch_raw, planned["notch_upper"], planned["notch_lower"])
        notch = ar.note("notch", ar.quantise(clipped, NOTCH_RAW_Q, NOTCH_Q), NOTCH_Q, "notch")
        return LawOutputs(notch_raw, notch, (self._basis, self._one_softening))

    def _surprise(self, before: T, disturbance: T, gained: T, speed: T, planned: dict[str, T]) -> tuple[T, T]:
        """Speed expected at this reading, and the difference of the reading from it (km/h, Q20).

        :param before: the observed speed at the last reading; ``gained`` since then from the actuator.
        """
        ar = self._ar
        expected = ar.add(before, gained)
        expected = ar.add(expected, ar.rmpy(disturbance, self._period, _ACCEL_BY_UNIT_TO_SPEED))
        expected = ar.sub(expected, planned["drag_over_period"])
        # A standing train gives no information about its forces; if it cannot have stopped, the reading is a fault.
        moving = ar.gt(speed, self._zero)
        expected_still = ar.where(ar.gt(expected, self._standstill), expected, self._zero)
        expected = ar.note("expected", ar.where(moving, expected, expected_still), SPEED_Q, "km/h")
        surprise = ar.clip(ar.sub(speed, expected), *self._innovation_limits)
        return expected, ar.note("surprise", ar.where(moving, surprise, self._zero), SPEED_Q, "km/h")

    def _corrected(self, value: T, surprise: T, weight: T, shift: int, limits: tuple[T, T]) -> T:
        """An estimate corrected by the surprise."""
        ar = self._ar
        return ar.clip(ar.add(value, ar.rmpy(surprise, weight, shift)), *limits)

    def _deviations(self, before: T, speed: T, place: Place[T], planned: dict[str, T]) -> tuple[T, T]:
        """Errors of speed (km/h, Q20) and position (0.1 mm, Q6) when the next notch takes effect.

        :param before: the speed at this reading, ``speed`` when the notch takes effect, both as measured at the wheel.
        """
        ar = self._ar
        speed = ar.add(speed, ar.rmpy(speed, place.wheel, WHEEL_Q))
        speed = ar.note("speed_ahead", speed, SPEED_Q, "km/h")
        advance = ar.rmpy(ar.add(before, speed), self._advance, _SPEED_TO_GAP)
        gap = ar.clip(ar.sub(planned["target_position"], place.odometer), *self._gap_limits)
        error_x = ar.sub(ar.convert(gap, 0, GAP_Q), ar.add(place.correction, advance))
        error_x = ar.note("position_error", ar.clip(error_x, *self._position_error_limits), GAP_Q, "0.1 mm")
        error_v = ar.clip(ar.sub(planned["target_speed"], speed), *self._speed_error_limits)
        return ar.note("speed_error", error_v, SPEED_Q, "km/h"), error_x


class IpfcPlus(IpfcPlusCore[T, IpfcPlusState[T]]):
    """The IPFC+ law on one arithmetic.

    Raises ``ValueError`` for parameters that do not fit the scenario.
    """

    name: ClassVar[str] = "ipfc_plus"
    parameters_type: ClassVar[type[Any]] = IpfcPlusParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = TUNABLE
    parameters_origin: ClassVar[str] = "designed on seeds 0 to 199"
    design_seeds: ClassVar[Mapping[str, range]] = DESIGN_SEEDS

    def __init__(
        self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: IpfcPlusParameters | None = None
    ) -> None:
        self.table = compute_constants(parameters or IpfcPlusParameters(), scenario)
        super().__init__(arithmetic, scenario, self.table)

    def start(self, inputs: LawInputs[T]) -> IpfcPlusState[T]:
        """The nominal train with its actuator at rest."""
        zero = self._zero
        observer = ObserverState(inputs.speed, zero, self._gain, zero, zero)
        return IpfcPlusState(observer, zero, zero, self._odometer.start())

    def with_sent(self, state: IpfcPlusState[T], notch: T) -> IpfcPlusState[T]:
        return state._replace(notch=self._ar.convert(notch, NOTCH_Q, UNIT_Q))

    def _observe(self, state: IpfcPlusState[T], speed: T, planned: dict[str, T]) -> ObserverState[T]:
        """Advance the observer from the last reading to this one: prediction, and correction by the innovation."""
        ar, old = self._ar, state.observer
        drive = (old.lagged, state.notch_before, state.notch)
        lagged = ar.note("lagged", ar.dot(self._lagged, drive, _UNIT_TO_UNIT), UNIT_Q, "notch")
        integral = ar.dot(self._integral, drive, _UNIT_TO_UNIT)
        gained = self._gained(old, integral, old.lagged, lagged)
        expected, surprise = self._surprise(old.speed, old.disturbance, gained, speed, planned)

        def corrected(value: T, weight: str, shift: int, limits: tuple[T, T]) -> T:
            return self._corrected(value, surprise, planned[weight], shift, limits)

        to_accel = _SPEED_BY_UNIT_TO_ACCEL
        return ObserverState(
            ar.note(
                "observed_speed",
                corrected(expected, "observe_speed", _UNIT_TO_UNIT, self._speed_limits),
                SPEED_Q,
                "km/h",
            ),
            ar.note(
                "disturbance",
                corrected(old.disturbance, "observe_disturbance", to_accel, self._disturbance_limits),
                ACCEL_Q,
                "km/h/s",
            ),
            ar.note("gain", corrected(old.gain, "observe_gain", to_accel, self._gain_limits), ACCEL_Q, "km/h/s"),
            ar.note("lag", corrected(old.lag, "observe_lag", _SPEED_BY_UNIT_TO_UNIT, self._lag_limits), UNIT_Q, "s"),
            lagged,
        )

    def _gained(self, observer: ObserverState[T], integral: T, before: T, after: T) -> T:
        """Speed (km/h, Q20) gained from the actuator while the lagged notch goes from one value to another."""
        ar = self._ar
        late = ar.rmpy(observer.lag, ar.sub(after, before), _UNIT_TO_UNIT)
        return ar.rmpy(observer.gain, ar.sub(integral, late), _ACCEL_BY_UNIT_TO_SPEED)

    def _ahead(self, observer: ObserverState[T], notch: T, planned: dict[str, T]) -> tuple[T, T]:
        """Force (km/h/s, Q22) and speed at the wheel (km/h, Q20) when the next notch takes effect."""
        ar = self._ar
        drive = (observer.lagged, notch)
        lagged = ar.dot(self._delay_lagged, drive, _UNIT_TO_UNIT)
        integral = ar.dot(self._delay_integral, drive, _UNIT_TO_UNIT)
        late = ar.rmpy(observer.lag, ar.rmpy(ar.sub(notch, lagged), self._pole, _UNIT_TO_UNIT), _UNIT_TO_UNIT)
        force = ar.rmpy(observer.gain, ar.sub(lagged, late), _UNIT_TO_UNIT)
        force = ar.note("force", force, ACCEL_Q, "km/h/s")
        speed = ar.add(observer.speed, self._gained(observer, integral, observer.lagged, lagged))
        speed = ar.add(speed, ar.rmpy(observer.disturbance, self._delay, _ACCEL_BY_UNIT_TO_SPEED))
        return force, ar.sub(speed, planned["drag_over_delay"])

    def step(self, state: IpfcPlusState[T], inputs: LawInputs[T]) -> tuple[IpfcPlusState[T], LawOutputs[T]]:
        ar = self._ar
        track = inputs.track
        assert track, "the controller supplies track to a law that asks for it"
        planned = self._at(track.k)
        balises, place = self._odometer.step(state.balises, track)
        observer = self._observe(state, inputs.speed, planned)
        force, speed = self._ahead(observer, state.notch, planned)
        error_v, error_x = self._deviations(observer.speed, speed, place, planned)

        accel = ar.add(planned["feed_forward"], ar.rmpy(planned["force_rate"], observer.lag, _UNIT_TO_UNIT))
        accel = ar.sub(accel, observer.disturbance)
        accel = ar.add(accel, ar.rmpy(error_x, planned["by_position"], _GAP_TO_ACCEL))
        accel = ar.add(accel, ar.rmpy(error_v, planned["by_speed"], _SPEED_BY_UNIT_TO_ACCEL))
        error_f = ar.sub(ar.sub(planned["planned_force"], observer.disturbance), force)
        accel = ar.add(accel, ar.rmpy(error_f, self._by_force, _UNIT_TO_UNIT))
        outputs = self._outputs(accel, observer.gain, planned)
        new_state = IpfcPlusState(observer, ar.convert(outputs.notch, NOTCH_Q, UNIT_Q), state.notch, balises)
        return new_state, outputs
