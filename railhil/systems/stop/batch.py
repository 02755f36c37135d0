"""Runs of the system ``stop``, many at once: the trains move in a compiled loop, the law steps on arrays.

:func:`run_together` is the system's part ``sequence_batch``, :func:`run_stops` its part ``batch``. A run in which the
train's watch acts, or in which the train moves again after its stop, is repeated without arrays. All runs of a scenario
with faults, or with other periods of the ports than in the port table, are made without arrays, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.batch.case import Batch, Case, SequenceRun
from railhil.batch.columns import Columns
from railhil.batch.coupled import digest_of, direct_sequence_run, run_coupled
from railhil.batch.stacked import StackedLaw
from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import count_of
from railhil.common.output import Output
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.controller_node.laws.failure import describe_failure
from railhil.controller_node.vector.controller import VectorController, VectorLoop
from railhil.judge.judging import judging_of
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.stop.plant import DOORS_NS, ODO_MAX, TICK_NS
from railhil.plant_sim.timed_run import due_tick_of
from railhil.record.telemetry import kept_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.stop.kernel import DRIVE, POSITION, SPEED, advance_stops, made
from railhil.wire.stop import AtoState, BrakeCommand, BrakeStatus, StopReport, TrainState, Truth
from railhil.wire.stop_counts import CONTRACT, MM, START_PER_S, TRUE_PER_UNIT

#: Runs computed together; each takes about 0.4 MB.
CHUNK = 256
COUNTS = {"wraps": WRAP, "saturations": SATURATION, "zero_divisions": DIVISION_BY_ZERO}
_STATE_TICKS = TrainState.port().period_ns // TICK_NS
_REPORT_TICKS = StopReport.port().period_ns // TICK_NS
_STATUS_NS = AtoState.port().period_ns
_DOORS_TICKS = -(-DOORS_NS // TICK_NS)


def run_stops(case: Case, seeds: Sequence[int]) -> Batch:
    """Run the first run of each seed's sequence.

    :raises InputError: numba is missing, law, arithmetic or parameters do not fit, or a fault needs the nodes.
    :raises PlantError: the simulation failed.
    """
    if one_by_one(case.scenario):
        return run_coupled(case, seeds)
    found = run_together(case.scenario, [case.run(int(seed)) for seed in seeds])
    return Batch.of_results(case.scenario, seeds, found, [one.digest for one in found])


def run_together(
    scenario: AnyScenario,
    specs: Sequence[RunSpec],
    *,
    chunk: int = CHUNK,
    say: Callable[[str], None] | None = None,
) -> list[SequenceRun]:
    """Runs of one scenario and one law that differ in seed, number and memory, in their order.

    :param chunk: number of runs computed together; the results do not depend on it.
    :param say: called if laws cannot be computed together; None: standard error. The caller reports that all runs of a
        scenario are made one by one (:func:`one_by_one`).
    :raises InputError: as :func:`run_stops`.
    :raises PlantError: the simulation failed.
    """
    if not specs:
        return []
    # The law is refused here as on the bench.
    VectorController(scenario, specs[0].law)
    found: list[SequenceRun] = []
    alone_all = bool(one_by_one(scenario))
    for first in range(0, len(specs), chunk):
        some = specs[first : first + chunk]
        runs = None if alone_all else _Runs(scenario, some)
        whole = runs is not None and runs.run()
        if runs is not None and not whole:
            (say or Output(stderr=True).say)(
                f"{specs[0].law.controller}: {count_of(len(some), 'run is', 'runs are')} made one by one: "
                f"with their memories the law differs in its {runs.differs}"
            )
        for train, spec in enumerate(some):
            alone = runs is None or not whole or runs.left[train]
            found.append(direct_sequence_run(scenario, spec) if alone or runs is None else runs.found(train))
    return found


def one_by_one(scenario: AnyScenario) -> str:
    """The system's part ``one_by_one``: reason for which its runs are made without arrays; empty: arrays are used."""
    timing = scenario.timing
    if scenario.faults:
        return "the scenario has faults"
    usual = timing.base_tick_ns == TICK_NS and not timing.port_period_ns and timing.control_period_ns % TICK_NS == 0
    return "" if usual else "its ports have other periods than those of the port table"


class _Runs:
    """Some runs together. ``left`` is 1 for runs that have to be repeated without arrays."""

    def __init__(self, scenario: Any, specs: Sequence[RunSpec]) -> None:
        task = scenario.task
        self._scenario, self._task, self._specs = scenario, task, specs
        self._every = scenario.timing.control_period_ns // TICK_NS
        self._after_ticks = round(task.after_stop_s * 1e9 / TICK_NS)
        last = due_tick_of(task.duration_s, TICK_NS)
        ticks = last + self._after_ticks + 1
        self._common, self._fleet, self._drawn = made(task, specs, ticks)
        self.left = self._fleet.left
        #: Tick at which each run ends.
        self._due = np.full(len(specs), last, dtype=np.int64)
        self._commands = np.zeros((len(specs), ticks, 3), dtype=np.int64)
        self._laws = StackedLaw(scenario, [spec.law for spec in specs])
        self._counts = {kind: np.zeros(len(specs), dtype=np.int64) for kind in COUNTS.values()}
        self._ended_counts = {kind: np.zeros(len(specs), dtype=np.int64) for kind in COUNTS.values()}
        #: Tick of the first wrap of each train, -1: none.
        self._first_wrap = np.full(len(specs), -1, dtype=np.int64)
        #: Readings of the slow telegrams: standstill, doors; run and error of the report.
        self._state: tuple[Any, Any] = (0, 0)
        self._report: tuple[Any, Any] = (0, 0)
        self._load = np.array([round(run.load_percent) for run in self._drawn], dtype=np.int64)
        self._wet = np.array([run.wet for run in self._drawn], dtype=np.int64)
        self._seen = np.array([run.slide_seen for run in self._drawn], dtype=np.int64)
        self._mark_m = np.array([run.mark_error_m for run in self._drawn])
        self._numbers = np.array([spec.run_number for spec in specs], dtype=np.int64)

    @property
    def differs(self) -> str:
        """The difference of the laws for which they cannot be computed together."""
        return self._laws.differs

    def run(self) -> bool:
        """Run all of them; False: their laws cannot be computed together.

        :raises PlantError: the state of a train is no longer finite.
        """
        loop = self._laws.loop
        if loop is None:
            return False
        number: Any = loop.arithmetic
        number.per_train = self._counts
        fleet = self._fleet
        accel, after = np.zeros(len(self._specs)), np.zeros(len(self._specs))
        advance_stops(self._common, fleet, accel, after, -1)
        tick = 0
        while True:
            if tick % self._every == 0:
                self._step(loop, tick)
            else:
                self._commands[:, tick] = self._commands[:, tick - 1]
            self._end(loop, tick)
            if fleet.over.all():
                break
            fleet.left[(self._commands[:, tick, 2] == 0) & (fleet.over == 0)] = 1
            np.divide(self._commands[:, tick, 0], MM, out=accel)
            np.divide(self._commands[:, tick, 1], START_PER_S, out=after)
            advance_stops(self._common, fleet, accel, after, tick)
            tick += 1
            stops = fleet.first_stop == tick
            self._due[stops] = tick + self._after_ticks
        if not np.isfinite(fleet.going[:, :4]).all():
            raise PlantError("speed is not finite")
        return True

    def _end(self, loop: VectorLoop[Any], tick: int) -> None:
        """Runs that end at a tick: their laws have come to their last step."""
        for train in np.flatnonzero((self._due <= tick) & (self._fleet.over == 0)):
            self._fleet.over[train] = 1
            self._laws.end(int(train), loop.state)
            for kind, counted in self._counts.items():
                self._ended_counts[kind][train] = counted[train]

    def _readings(self, tick: int) -> list[Any]:
        """One array of raw integers for each reading of the interface."""
        fleet, common = self._fleet, self._common
        count = len(self._specs)
        position_m, speed_mps = fleet.going[:, 1], fleet.going[:, 2]
        if tick % _STATE_TICKS == 0:
            doors = (fleet.stop_tick >= 0) & (tick - fleet.stop_tick >= _DOORS_TICKS)
            self._state = (speed_mps == 0.0).astype(np.int64), doors.astype(np.int64)
        if tick % _REPORT_TICKS == 0:
            stopped = fleet.stop_tick >= 0
            error = np.rint((position_m - self._task.stop_m + self._mark_m) * MM).astype(np.int64)
            self._report = np.where(stopped, self._numbers, 0), np.where(stopped, error, 0)
        odometer = np.clip((position_m - self._task.start_m) * (1.0 + fleet.wheel) * MM, 0.0, ODO_MAX)
        balise = np.where(fleet.passed > 0, fleet.passed + common.first_balise, 0)
        constant = [np.full(count, value, dtype=np.int64) for value in (tick & 0xFFFF, 1, 0)]
        counted, one, zero = constant
        return [
            *np.ascontiguousarray(fleet.samples.T),
            counted,
            one,
            fleet.slides * self._seen,
            odometer.astype(np.int64),
            balise,
            (fleet.passed_m * MM).astype(np.int64),
            self._load,
            self._wet,
            *self._state,
            self._numbers,
            *self._report,
            zero,
        ]

    def _step(self, loop: VectorLoop[Any], tick: int) -> None:
        """The law's commands for all trains at a tick."""
        try:
            _, answer = loop.step(self._readings(tick))
        except Exception as error:
            # A law is plug-in code and may raise anything.
            raise describe_failure(loop.name, type(loop.law), error, "step", "") from error
        for column, (item, value) in enumerate(zip(loop.interface.commands, answer.commands, strict=True)):
            self._commands[:, tick, column] = loop.arithmetic.raw(value, item.q)
        self._first_wrap[(self._counts[WRAP] > 0) & (self._first_wrap < 0)] = tick

    def found(self, train: int) -> SequenceRun:
        """Result of one run."""
        due = int(self._due[train])
        score = judging_of(self._scenario).score(self._scenario, self._trace(train, due))
        counts = {name: int(self._ended_counts[kind][train]) for name, kind in COUNTS.items()}
        digest = digest_of(self._commands[train, : due + 1 : self._every])
        kept = self._laws.own[train].kept()
        memory = None if kept is None else kept_of(kept)
        return SequenceRun(self._scenario, self._specs[train], score, counts, "", digest, memory)

    def _trace(self, train: int, due: int) -> Columns:
        """The data that the score needs of a run's record."""
        instants = np.arange(due + 1, dtype=np.int64) * TICK_NS
        record = self._fleet.record[train, : due + 1]

        def raw(column: int) -> NDArray[np.int64]:
            return np.asarray(np.rint(record[:, column] * TRUE_PER_UNIT), dtype=np.int64)

        last_ns = due * TICK_NS
        status_ns = np.arange(0, last_ns + 1, _STATUS_NS, dtype=np.int64)
        if last_ns % _STATUS_NS:
            status_ns = np.append(status_ns, last_ns)
        wrapped_ns = self._first_wrap[train] * TICK_NS if self._first_wrap[train] >= 0 else last_ns + 1
        motion = {"TruePos": raw(POSITION), "TrueSpeed": raw(SPEED), "TrueDrive": raw(DRIVE)}
        return Columns(
            CONTRACT,
            {
                Truth.PORT: (instants, motion),
                BrakeStatus.PORT: (instants, {}),
                BrakeCommand.PORT: (instants, {"CmdAccel": self._commands[train, : due + 1, 0]}),
                AtoState.PORT: (status_ns, {"LawFlags": np.where(status_ns >= wrapped_ns, WRAP, 0)}),
                RunEvent.PORT: self._events(train, due),
            },
        )

    def _events(self, train: int, due: int) -> Any:
        """RUN_EVENT: the stop, and the end."""
        fleet = self._fleet
        stop = int(fleet.first_stop[train])
        rows = [(due, int(Event.ENDED_COMPLETE if stop >= 0 else Event.ENDED_NOT_STOPPED), 0)]
        if stop >= 0:
            rows.insert(0, (stop, int(Event.STOPPED), round(float(fleet.first_stop_s[train]) * 1e4)))
        columns = np.array(rows, dtype=np.int64).T
        return columns[0] * TICK_NS, {"RunEvent": columns[1], "EventTime": columns[2]}
