"""IPFC+ with an end phase: the last seconds before the stop are aimed at the stopping point.

IPFC+ brings the errors of position and speed to zero at the planned stop until some 2 s before it, and cannot do both
afterwards. From a chosen speed on, this law weighs what is left: where the train stops counts most, when it does less.
Position and speed are those at which the commands still on their way will have put the train, and the observer's
disturbance is subtracted as in IPFC+. ``docs/ipfc_plus.md`` has the equations and what each element contributes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.balise_odometer import BaliseState, Place
from railhil.controller_node.ato.ipfc_plus_constants import (
    ACCEL_Q,
    GAP_Q,
    POSITION_GAIN_Q,
    UNIT_Q,
    WHEEL_Q,
)
from railhil.controller_node.ato.ipfc_plus_stop_constants import (
    DESIGN_SEEDS,
    STOP_GAIN_Q,
    STOP_TUNABLE,
    IpfcPlusStopParameters,
    stop_constants,
)
from railhil.controller_node.ato.stop_observer import StopObserver, StopObserverState
from railhil.controller_node.ato.survey_odometer import SurveyOdometer, WheelBounds
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, LawInputs, LawOutputs
from railhil.systems.ato.scenario.model import Scenario

_UNIT_TO_UNIT = UNIT_Q
_SPEED_BY_UNIT_TO_ACCEL = SPEED_Q + UNIT_Q - ACCEL_Q
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
        assert track, "the controller gives a law with track what it asks for"
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
