"""The train of the system ``ato`` on the bus: plant, telegrams, gate for commands, and the end of its run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from railhil.bus.codes import Event
from railhil.bus.layout import Telegram
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.any_plant import BRAKING_MAX_NS
from railhil.plant_sim.ato.gate import NOTCH_STEP, CommandGate
from railhil.plant_sim.ato.plant import NOTCH_LSB_PER_NOTCH, Plant
from railhil.plant_sim.ato.safe_command import SafeCommand
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import find_actual
from railhil.wire.ato import CtlStat, NotchCmd, NotchSdt, WatchCause


@mypyc_attr(allow_interpreted_subclasses=True)
class TrainOnBus(Plant):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`.

    :param drawn: draw the scenario's perturbations with the seed.
    :param rate: pace of the run, simulated seconds per wall second; 0: lockstep.
    """

    statuses: Sequence[str] = (CtlStat.PORT,)

    def __init__(self, scenario: Scenario, seed: int, drawn: bool = False, rate: float = 0.0) -> None:
        actual = find_actual(scenario, seed, drawn)
        super().__init__(actual, seed)
        self.gate = CommandGate(
            round(actual.train.notch_max * NOTCH_LSB_PER_NOTCH),
            round(actual.watch.notch_step_max * NOTCH_LSB_PER_NOTCH),
            actual.watch.two_sources_max,
        )
        self._telegrams = TrainTelegrams(actual, self, rate)
        self.makers = self._telegrams.makers
        self.ending = RunEnd(actual, self)
        self.commands: Mapping[str, type[Telegram]] = {NotchCmd.PORT: NotchCmd}
        self._safe: SafeCommand | None = None
        if actual.safety.sdt:
            self._safe = SafeCommand(actual)
            self.commands = {NotchCmd.PORT: NotchCmd, NotchSdt.PORT: NotchSdt}
        self._abandoned_ns = actual.watch.emergency_ms * 1_000_000

    @property
    def refused(self) -> Mapping[str, int]:
        """Counters of the gate, and of the safe channel if there is one."""
        return self.gate.counters if self._safe is None else {**self.gate.counters, **self._safe.counters}

    @property
    def judged(self) -> dict[str, tuple[int, Mapping[str, int]]]:
        """For each port with commands: the number accepted, and the counters of its check.

        A command whose step is too large is not refused: the train follows it in part.
        """
        counters = {cause: count for cause, count in self.gate.counters.items() if cause != NOTCH_STEP}
        found: dict[str, tuple[int, Mapping[str, int]]] = {NotchCmd.PORT: (self.gate.counters["accepted"], counters)}
        if self._safe is not None:
            found[NotchSdt.PORT] = (self._safe.accepted, self._safe.counters)
        return found

    def take(self, telegram: Telegram) -> None:
        """Take NOTCH_CMD if it passes the gate, and pass the gate's suspicion to the watch. With a safe channel, take
        it only if NOTCH_SDT confirms it."""
        gate, safe = self.gate, self._safe
        if isinstance(telegram, NotchSdt):
            assert safe is not None
            command = safe.confirmed(telegram, self.tick)
            if command is not None:
                self.command(gate.notch_256th, gate.emergency(command))
            return
        assert isinstance(telegram, NotchCmd)
        if gate.accept(telegram):
            emergency = gate.emergency(telegram)
            if safe is None or emergency:
                self.command(gate.notch_256th, emergency)
            else:
                safe.hold(telegram, self.tick)
        if gate.suspicion:
            self.suspect(gate.suspicion)

    def _cause(self) -> WatchCause:
        cause = super()._cause()
        unsafe = cause is WatchCause.COMMAND_AGE and self._safe is not None and self._safe.refuses
        return WatchCause.SAFETY_CODE if unsafe else cause

    def telegram_of(self, event: Any) -> Telegram | None:
        """BALISE for a balise passing, TRN_WATCH for a new level of the watch."""
        if event.kind == "watch":
            return self._telegrams.watch()
        if event.balise is None:
            return None
        return self._telegrams.balise(event.balise.number, event.balise.surveyed_m, event.odometer_mm)

    def is_abandoned(self, command_age_ns: int) -> bool:
        """Whether the train's watch had reached the emergency age."""
        return command_age_ns > self._abandoned_ns


#: Recording continues for this long after the stop, so that it shows the standstill.
AFTER_STOP_S: Final = 1.0


@mypyc_attr(allow_interpreted_subclasses=True)
class RunEnd:
    """Determines when a train's run is over: some time after the train has stopped, or after the timetable's end if it
    has not.

    A train whose controller is lost may still be braking at the end of the timetable; once it stands, it will not move
    again.

    :param plant: its standstill counts in that case; None if the controller cannot be lost.
    """

    def __init__(self, scenario: Scenario, plant: Plant | None = None) -> None:
        plan, tick_ns = scenario.plan, scenario.timing.base_tick_ns
        #: Last tick at which a stop is awaited.
        self.last_tick = round((plan.running_time_s + plan.overtime_max_s) * 1e9 / tick_ns)
        self.after_stop_ticks = max(1, round(AFTER_STOP_S * 1e9 / tick_ns))
        #: No run with a live controller ends before this tick.
        self.due_tick = self.last_tick + 1
        self._braking_ticks = BRAKING_MAX_NS // tick_ns
        self._has_stopped = False
        self._plant = plant

    def happened(self, kind: str, tick: int) -> None:
        """Note a stop before this tick; only the first stop counts."""
        if kind == "stopped" and not self._has_stopped:
            self._has_stopped, self.due_tick = True, tick + self.after_stop_ticks

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""
        if self._has_stopped:
            return Event.ENDED_COMPLETE if tick >= self.due_tick else None
        over = tick >= self.due_tick
        if controller_lost:
            over = (
                self._plant is None or self._plant.true_speed_01mmps == 0 or tick > self.last_tick + self._braking_ticks
            )
        return Event.ENDED_NOT_STOPPED if over else None
