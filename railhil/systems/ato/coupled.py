"""The train without a bus: speed, position and balises as raw integers into a law, its notch into the train. It is the
part ``coupling`` (:mod:`railhil.run.coupled`)."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

from railhil.bus.schedule import Schedule
from railhil.common.errors import InputError, Words
from railhil.controller_node.ato.control_loop import NO_BALISE, limited_01mm
from railhil.controller_node.laws.base import BaliseReading
from railhil.dbc import Port, wire_contract
from railhil.plant_sim.ato.faults.mismatch import constant_mismatches
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.plant_sim.ato.train import RunEnd
from railhil.run.coupled import Coupling
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import find_actual
from railhil.wire.ato import NotchCmd, SimTruth, TrnPos, TrnSpeed


def couple(scenario: Scenario, law: Callable[..., Any], spec: RunSpec, ports: Collection[str] | None) -> Coupling:
    """A run of the train: as on the bus, the law has the position of the last TRN_POS. There is no reaction ladder.

    :param law: control period k, speed in 0.1 mm/s, position in 0.1 mm, last balise -> notch code (1/256), or a
        :class:`~railhil.controller_node.ato.controller.ControlOutput`.
    :param ports: not used: the plant publishes SIM_TRUTH alone.
    :raises InputError: as :func:`coupled_schedule`; a fault that does not last from the start to the end.
    """
    actual = find_actual(scenario, spec.seed, spec.perturbed)
    if scenario.faults:
        actual = constant_mismatches(scenario, [spec.seed])[0].applied(actual)
    plant = Plant(actual, spec.seed)
    coupled = NotchCoupling(scenario, plant, law)
    coupled.identify(spec.identity)
    truth = TrainTelegrams(actual, plant, 0.0).makers[SimTruth.PORT]
    makers = {SimTruth.PORT: truth, TrnPos.PORT: coupled.read_position}
    coupled.run(RunEnd(scenario, plant), coupled_schedule(scenario), makers, [NotchCmd.port()], TrnSpeed.PORT)
    return coupled


def coupled_schedule(scenario: Scenario) -> Schedule:
    """Periods of the ports for a run without a bus.

    :raises InputError: the speed is sent less often than NOTCH_CMD is polled: the law would then see an old speed, and
        the controller's watch, which only the nodes have, would act. Or the scenario has a safe channel: it takes two
        telegrams to begin, which only the nodes exchange.
    """
    if scenario.safety.sdt:
        raise InputError(scenario.name, "safety.sdt", True, "false, or the run over a bus (railhil run)")
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, wire_contract())
    speed, notch = schedule.ticks(TrnSpeed.PORT), schedule.ticks(NotchCmd.PORT)
    if speed > notch:
        found = Words(f"TRN_SPEED every {speed} ticks, NOTCH_CMD polled every {notch}")
        allowed = "TRN_SPEED at least as often as NOTCH_CMD, or the run over a bus (railhil run)"
        raise InputError(scenario.name, "timing.port_period_ms", found, allowed)
    return schedule


class NotchCoupling(Coupling):
    """The law drives the train itself, not its gate: no telegram can be wrong."""

    def __init__(self, scenario: Scenario, plant: Plant, law: Callable[..., Any]) -> None:
        super().__init__(scenario, plant, law)
        self._position_01mm = 0
        self._balise: BaliseReading[int] = NO_BALISE

    def read_position(self) -> None:
        """TRN_POS is due: read the position; the telegram itself is not needed."""
        self._position_01mm = limited_01mm(self.plant.odometer_mm)

    def report(self, event: Any) -> None:
        """Note a balise; the bench's milestones. There is no ladder here that could need the watch's level."""
        if event.kind == "watch":
            return
        if event.balise is not None:
            surveyed_mm = round(event.balise.surveyed_m * 1000)
            reading = limited_01mm(surveyed_mm), limited_01mm(event.odometer_mm)
            self._balise = BaliseReading(event.balise.number, *reading)
        else:
            super().report(event)

    def compute(self, period: int) -> int:
        """The law's notch code."""
        found: Any = self.law(period, self.plant.speed_01mmps, self._position_01mm, self._balise)
        code: int = getattr(found, "notch_code", found)
        return code

    def poll(self, port: Port) -> None:
        """NOTCH_CMD."""
        code = self.output()
        self.plant.command(code, False)
        self.publish(NotchCmd(code))
