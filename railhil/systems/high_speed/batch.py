"""Runs of the systems ``hst1`` and ``emu3`` with many seeds at once: the part ``batch`` of both.

The trains move in a compiled loop (:mod:`.kernel`), the law steps on arrays, the scores equal the bench's.
:func:`railhil.batch.coupled.run_coupled` repeats a run in which a unit's watch acts, and makes all runs of a scenario
with other periods of the ports than in the port table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from railhil.batch.case import Batch, Case
from railhil.batch.columns import Columns
from railhil.batch.coupled import digest_of, run_coupled
from railhil.bus.codes import Event
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.controller_node.laws.failure import describe_failure
from railhil.controller_node.vector.controller import VectorController, VectorLoop
from railhil.judge.judging import judging_of
from railhil.judge.score import Score
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.high_speed.plant import ARRIVED_MPS
from railhil.plant_sim.high_speed.train import SPEED_RAW_MAX
from railhil.plant_sim.timed_run import due_tick_of
from railhil.systems.high_speed import EVENTS
from railhil.systems.high_speed.kernel import (
    COUPLER_MAX,
    DRIVE,
    SPEED,
    STANDS,
    UNITS,
    Waysides,
    advance_fleet,
    made,
    noise_normals,
    wind_normals,
)
from railhil.wire.power_units import ACCEL_PER_MPS2, SPEED_PER_MPS, TRUE_PER_UNIT, wire

#: Runs computed together; a journey of an hour takes about 1 MB for each, three units twice that.
CHUNK = 64
_KINDS = {"wraps": WRAP, "saturations": SATURATION, "zero_divisions": DIVISION_BY_ZERO}
Ints: TypeAlias = NDArray[np.int64]


def run_high_speed(case: Case, seeds: Sequence[int], *, chunk: int = CHUNK) -> Batch:
    """Run a case with each seed, any number of them.

    :param chunk: number of runs computed together; the results do not depend on it.
    :raises InputError: numba is missing, law, arithmetic or parameters do not fit, or a fault needs the nodes.
    :raises PlantError: the simulation failed.
    """
    if one_by_one(case.scenario):
        return run_coupled(case, seeds)
    # The law is refused here as on the bench.
    VectorController(case.scenario, case.law)
    found: list[_Found] = []
    for first in range(0, len(seeds), chunk):
        some = [int(seed) for seed in seeds[first : first + chunk]]
        runs = _Runs(case, some)
        runs.run()
        for train, seed in enumerate(some):
            found.append(_coupled(case, seed) if runs.left[train] else runs.found(train))
    counts = {name: np.array([one.counts[name] for one in found], dtype=np.int64) for name in _KINDS}
    scores, digests = [one.score for one in found], [one.digest for one in found]
    return Batch.of(case.scenario, seeds, scores, counts, digests)


class _Found(NamedTuple):
    """Result of one run; ``counts``: events in the law's arithmetic."""

    score: Score
    counts: Mapping[str, int]
    digest: str


def _coupled(case: Case, seed: int) -> _Found:
    """One run without arrays."""
    run = run_coupled(case, [seed])
    return _Found(run.scores[0], {name: int(getattr(run, name)[0]) for name in _KINDS}, run.digest[0])


def one_by_one(scenario: Any) -> str:
    """The system's part ``one_by_one``: reason for which its runs are made without arrays; empty: arrays are used."""
    if scenario.faults:
        return "the scenario has faults"
    return "" if _usual_periods(scenario) else "its ports have other periods than those of the port table"


def _usual_periods(scenario: Any) -> bool:
    """Whether the truth is published and commands are polled at every tick, and the law's readings with its periods."""
    ports = wire(len(scenario.task.unit))
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, ports.contract)
    control_ticks, rest = divmod(timing.control_period_ns, timing.base_tick_ns)
    every = [ports.truth.PORT, *(kind.PORT for kind in (*ports.feedback, *ports.commands))]
    return (
        rest == 0
        and all(schedule.ticks(port) == 1 for port in every)
        and all(control_ticks % schedule.ticks(kind.PORT) == 0 for kind in (ports.reference, ports.event))
        and schedule.ticks(ports.status.PORT) == control_ticks
    )


class _Runs:
    """Runs of some seeds together. ``left`` is 1 for runs in which a watch has acted."""

    def __init__(self, case: Case, seeds: Sequence[int]) -> None:
        scenario = case.scenario
        task, timing = scenario.task, scenario.timing
        self._scenario = scenario
        self._tick_ns: int = timing.base_tick_ns
        tick_s = self._tick_ns / 1e9
        self._due_tick = due_tick_of(task.duration_s, self._tick_ns)
        self._every = timing.control_period_ns // timing.base_tick_ns
        self._wire = wire(len(task.unit))
        self._common, self._fleet = made(task, seeds, tick_s, self._due_tick + 1)
        self.left = self._fleet.left
        self._waysides = Waysides(task, tick_s, len(seeds))
        self._wind = wind_normals(seeds, self._due_tick)
        self._noise = noise_normals(seeds, len(task.unit), self._due_tick + 1, self._every)
        self._noise *= task.noise_sigma_mps
        self._number = cast(Any, make(case.law.arithmetic, batch=True))
        self._counts = {kind: np.zeros(len(seeds), dtype=np.int64) for kind in _KINDS.values()}
        self._number.per_train = self._counts
        #: Control period of the first wrap of each train, -1: none.
        self._first_wrap = np.full(len(seeds), -1, dtype=np.int64)
        self._loop: VectorLoop[Any] = VectorLoop(scenario, case.law, self._number)
        self._seeds = seeds
        periods = self._due_tick // self._every + 1
        self._commands = np.zeros((len(seeds), periods, len(self._loop.interface.commands)), dtype=np.int64)

    def run(self) -> None:
        """Run all of them.

        :raises PlantError: the state of a train is no longer finite.
        """
        fleet, due_tick = self._fleet, self._due_tick
        commands_mps2 = np.zeros(fleet.motion.shape[:2])
        advance_fleet(self._common, fleet, commands_mps2, self._wind, -1, 0)
        self._waysides.look(0, fleet.position_m[:, :1])
        for period in range(self._commands.shape[1]):
            tick = period * self._every
            self._step(period, tick)
            # Acceleration and mode of each unit by turns.
            np.divide(self._commands[:, period, ::2], ACCEL_PER_MPS2, out=commands_mps2)
            after = min(tick + self._every, due_tick)
            advance_fleet(self._common, fleet, commands_mps2, self._wind, tick, after)
            self._waysides.look(tick + 1, fleet.position_m[:, tick + 1 : after + 1])
        finite = np.isfinite(fleet.motion[:, :, :2]).all(axis=(1, 2))
        if not finite.all():
            raise PlantError(f"speed is not finite with seed {self._seeds[int(np.argmin(finite))]}")
        couplers = fleet.truth[:, :, UNITS + fleet.motion.shape[1] :]
        beyond = (np.abs(couplers) >= COUPLER_MAX).any(axis=(1, 2))
        if beyond.any():
            seed = self._seeds[int(np.argmax(beyond))]
            raise PlantError(f"{self._wire.truth.PORT}: the wire cannot carry the force of a coupler, with seed {seed}")
        self._targets_mps = self._waysides.targets_mps(due_tick + 1)

    def _step(self, period: int, tick: int) -> None:
        """The law's commands for all trains in a control period."""
        read_mps = self._fleet.motion[:, :, 1] + self._noise[:, period]
        speeds = np.clip(np.rint(read_mps * SPEED_PER_MPS), 0, SPEED_RAW_MAX).astype(np.int64)
        raws = [*np.ascontiguousarray(speeds.T), *self._waysides.readings(tick)]
        try:
            _, answer = self._loop.step(raws)
        except Exception as error:
            # A law is plug-in code and may raise anything.
            raise describe_failure(self._loop.name, type(self._loop.law), error, "step", "") from error
        for column, (item, value) in enumerate(zip(self._loop.interface.commands, answer.commands, strict=True)):
            self._commands[:, period, column] = self._number.raw(value, item.q)
        self._first_wrap[(self._counts[WRAP] > 0) & (self._first_wrap < 0)] = period

    def found(self, train: int) -> _Found:
        """Result of one run."""
        score = judging_of(self._scenario).score(self._scenario, self._record(train))
        counts = {name: int(self._counts[kind][train]) for name, kind in _KINDS.items()}
        return _Found(score, counts, digest_of(self._commands[train]))

    def _record(self, train: int) -> Columns:
        """The data that the score needs of a run's record: commands only where they may change."""
        ports, truth, position_m = self._wire, self._fleet.truth[train], self._fleet.position_m[train]
        targets_mps = self._waysides.own_targets_mps(train, self._targets_mps)
        units = len(ports.commands)
        motion = {
            "TruePos": np.rint(position_m * 1000.0).astype(np.int64),
            "TrueSpeed": truth[:, SPEED],
            "TrueDrive": truth[:, DRIVE],
            "Target": np.rint(targets_mps * TRUE_PER_UNIT).astype(np.int64),
        }
        if units > 1:
            motion |= {f"TrueSpeed{unit + 1}": truth[:, UNITS + unit] for unit in range(units)}
            motion |= {f"Coupler{unit + 1}": truth[:, UNITS + units + unit] for unit in range(units - 1)}
        control = np.arange(self._commands.shape[1], dtype=np.int64)
        control_ns = control * (self._every * self._tick_ns)
        flags = np.where((self._first_wrap[train] >= 0) & (control >= self._first_wrap[train]), WRAP, 0)
        commands = {
            kind.PORT: (control_ns, {dict(kind.signals())["accel"].name: self._commands[train, :, 2 * unit]})
            for unit, kind in enumerate(ports.commands)
        }
        return Columns(
            ports.contract,
            {
                ports.truth.PORT: (np.arange(len(truth), dtype=np.int64) * self._tick_ns, motion),
                **commands,
                ports.status.PORT: (control_ns, {"LawFlags": flags}),
                RunEvent.PORT: self._events(train, targets_mps, truth[:, STANDS] == 1),
            },
        )

    def _events(self, train: int, targets_mps: NDArray[np.float64], stands: NDArray[np.bool_]) -> Any:
        """RUN_EVENT: the milestones of :class:`railhil.plant_sim.high_speed.plant.HighSpeedPlant`, and the end."""
        found = []
        if train in self._waysides.called:
            found.append((EVENTS["emergency_called"], self._waysides.called[train][0]))
        moves = ~stands
        if moves.any():
            arrived = np.flatnonzero(stands & (targets_mps < ARRIVED_MPS))
            arrived = arrived[arrived > np.argmax(moves)]
            found += [(EVENTS["arrived"], int(tick)) for tick in arrived[:1]]
        rows = [(event, tick * self._tick_ns // 100_000, self._position_01mm(train, tick)) for event, tick in found]
        rows.append((int(Event.ENDED_COMPLETE), 0, 0))
        columns = np.array(rows, dtype=np.int64).T
        instants = np.array([*(tick for _, tick in found), self._due_tick], dtype=np.int64) * self._tick_ns
        return instants, dict(zip(("RunEvent", "EventTime", "EventPos"), columns, strict=True))

    def _position_01mm(self, train: int, tick: int) -> int:
        return round(float(self._fleet.position_m[train, tick]) * 1e4)
