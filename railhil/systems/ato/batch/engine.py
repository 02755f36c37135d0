"""Makes the runs of one case in chunks: the law on arrays, the plant compiled, then the score of each run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.batch.case import Case
from railhil.bus.codes import Event
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.controller_node.ato.control_loop import NO_BALISE, POSITION_MAX_01MM
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import NOTCH_Q, BaliseReading
from railhil.controller_node.laws.failure import describe_failure
from railhil.judge.score import Score
from railhil.plant_sim.any_plant import FaultTooLarge, PlantError
from railhil.record.notes import WRAP_FAILURE
from railhil.scenarios.streams import chain_of
from railhil.systems.ato.batch import lanes
from railhil.systems.ato.batch.emitted_law import loop_of
from railhil.systems.ato.batch.kernel import run_period, stand_to_the_end
from railhil.systems.ato.batch.layout import READ_ENDED
from railhil.systems.ato.batch.noise import renew_noise, standard_noise
from railhil.systems.ato.batch.setup import Times, Trains, Vectors, common, status_tick, trains
from railhil.systems.ato.judge import measures
from railhil.systems.ato.judge.journey import ErrorGrid, stop_of
from railhil.systems.ato.judge.score import Measured, judged
from railhil.wire.ato import SimTruth

Ints: TypeAlias = NDArray[np.int64]
#: Scale of instants (s) and positions (m) in RUN_EVENT, and of accelerations in SIM_TRUTH.
_LSB = 0.0001
#: Events counted by a batch arithmetic.
_KINDS = (WRAP, SATURATION, DIVISION_BY_ZERO)


@dataclass(frozen=True, slots=True)
class BatchRuns:
    """Runs of some seeds: their scores, the notch codes (steps, N), the number of codes of each run, and the events in
    the law's arithmetic (kind -> (N,))."""

    scores: list[Score]
    codes: NDArray[np.int16]
    steps: Ints
    counts: dict[int, Ints]


class Engine:
    """Makes the runs of one case.

    :param loop: a replacement for the control loop of the case's law, with its arithmetic; None: that loop itself.
    """

    def __init__(self, case: Case, loop: Any = None) -> None:
        self._case = case
        scenario = case.scenario
        self.times = Times.of(scenario)
        self.grid = ErrorGrid.of(scenario)
        self.common = common(scenario, case.law.over_distance, self.times)
        if loop is None:
            loop = loop_of(scenario, case.law)
        self._loop: Any = loop
        self._number = loop.arithmetic
        #: Whether the loop reads the last balise; a loop without this declaration gets it.
        self._track = getattr(loop, "track", True)

    def run(
        self, seeds: Sequence[int], vectors: Vectors | None = None, changes: Sequence[tuple[int, int]] = ()
    ) -> BatchRuns:
        """Run the seeds together.

        :param vectors: draws and noise of these runs, instead of those of their seeds.
        :param changes: of each run the first tick with the noise of another seed, and this seed; none: the scenario's.
        :raises PlantError: the state of a train is no longer finite.
        :raises InputError: the law has raised.
        """
        times, case = self.times, self._case
        fleet = trains(case.scenario, seeds, case.perturbed, times, len(self.grid.counts), vectors)
        ended = fleet.tables.readings[READ_ENDED]
        chains = [chain_of(seed, case.scenario.noise) for seed in seeds] if vectors is None else vectors.noise
        noise = standard_noise(chains, times.steps)
        if not changes and case.scenario.noise_change is not None:
            changes = [case.scenario.noise_change] * len(seeds)
        if changes:
            noise = renew_noise(noise, times.steps, changes)
        watch = _Watch(self._number, len(seeds))
        codes = np.zeros((times.steps.size, len(seeds)), dtype=np.int16)
        self._loop.state = None
        code = np.zeros(len(seeds), dtype=np.int64)
        run_period(self.common, fleet.tables, code, noise[0], -1, 0)
        for i, tick in enumerate(times.steps.tolist()):
            code = self._step(int(times.periods[i]), fleet)
            codes[i] = code
            watch.take(i, ended == 0)
            after = noise[min(i + 1, len(noise) - 1)]
            run_period(self.common, fleet.tables, code, after, tick, int(times.ends[i]))
            if ended.all():
                break
        # No longer needed, and as large as the data for the scores.
        self._loop.state = None
        finite = np.isfinite(sum(map(fleet.column, (lanes.POSITION, lanes.SPEED, lanes.ACTUATOR))))
        if not finite.all():
            named = _name_run(seeds, vectors, fleet.tables.order[np.argmin(finite)])
            raise PlantError(f"plant state is not finite {named}")
        low, high = SimTruth.port().signal("TrueAccel").raw_range
        held = (fleet.tables.control_accel_raw <= low) | (fleet.tables.control_accel_raw >= high)
        if (beyond := held.any(axis=1)).any():
            named = _name_run(seeds, vectors, fleet.tables.order[np.argmax(beyond)])
            if case.scenario.faults:
                raise FaultTooLarge(
                    f"{'; '.join(case.scenario.faults)}: {FaultTooLarge.SAID}: SIM_TRUTH.TrueAccel {named}"
                )
            raise PlantError(f"SIM_TRUTH.TrueAccel: the wire cannot carry it, {named}")
        steps = np.searchsorted(times.steps, fleet.column(lanes.END_TICK)[np.argsort(fleet.tables.order)], side="right")
        return BatchRuns(self._scores(fleet, watch), codes, steps, watch.counts)

    def _step(self, k: int, fleet: Trains) -> Ints:
        """The law's outputs for all trains in control period ``k``."""
        speed, odometer, passed, _ = fleet.tables.readings
        balise, lines = NO_BALISE, fleet.balises
        if self._track:
            row = np.arange(passed.size)
            balise = BaliseReading(
                *(part[row, passed] for part in (lines.number, lines.surveyed_01mm, lines.passing_01mm))
            )
        # A copy, because a loop may keep its arguments.
        position = np.minimum(np.maximum(odometer, -POSITION_MAX_01MM), POSITION_MAX_01MM)
        law = self._case.law.controller
        try:
            _, outputs = self._loop.step(k, speed.copy(), position, balise)
        except Exception as fault:
            # A law is code that somebody plugs in: whatever it raises is said of it, with file and line.
            raise describe_failure(law, load_law(law), fault, "step", "") from fault
        raw = np.asarray(self._number.raw(outputs.notch, NOTCH_Q), dtype=np.int64)
        return np.broadcast_to(raw, passed.shape).copy()

    def _scores(self, fleet: Trains, watch: _Watch) -> list[Score]:
        """Score of each run, from the sums computed in the compiled loop."""
        scenario, times = self._case.scenario, self.times
        stand_to_the_end(self.common, fleet.tables)
        itae = measures.itae_kmh_s2(
            fleet.tables.error_sums_kmh.T, self.grid.counts, self.grid.period_s, self.grid.shares
        )
        last_s = times.truth_s[fleet.column(lanes.SAMPLES).astype(np.int64) - 1]
        ticks = (last_s / (scenario.timing.control_period_ns / 1e9)).astype(np.int64)
        column = times.control_columns[np.minimum(np.arange(ticks.max() + 1), ticks[:, None])]
        accel = np.take_along_axis(fleet.tables.control_accel_raw, column, axis=1) * _LSB
        comfort = measures.comfort_mps2_per_km(accel, scenario.plan.distance_m)
        # Results are in the order of the seeds from here on.
        place = np.argsort(fleet.tables.order)

        def of(quantity: int) -> Any:
            return fleet.column(quantity)[place]

        itae, comfort, last_s = itae[place], comfort[place], last_s[place]
        stopped, stop_s = of(lanes.STOP_TICK) >= 0, of(lanes.STOP_01MS) * _LSB
        energy = measures.energy_kj(
            scenario.energy, of(lanes.TRACTION_J), of(lanes.BRAKE_J), np.where(stopped, stop_s, last_s)
        )
        ended, end_tick = (of(quantity).astype(np.int64) for quantity in (lanes.ENDED, lanes.END_TICK))
        emergency = of(lanes.EMERGENCY_01MS)
        columns = (itae, energy, comfort, stopped, stop_s, of(lanes.STOP_01MM) * _LSB, ended, of(lanes.OVERSPEED),
                   emergency, emergency * _LSB, end_tick)  # fmt: skip

        def one(i: int, row: Sequence[Any]) -> Score:
            itae, energy, comfort, stopped, stop_s, stop_m, ended, overspeed_mps, emergency, emergency_s, end_tick = row
            stop = stop_of(scenario.plan, [(stop_s, stop_m)] if stopped else [])
            values = {
                "itae": itae,
                "energy_kj": energy,
                "punctuality_s": stop.late_s,
                "stop_error_m": stop.error_m,
                "comfort": comfort,
            }
            return judged(
                scenario,
                Measured(
                    ended=Event(ended),
                    values=values,
                    overspeed_mps=overspeed_mps,
                    stop=stop,
                    emergency_s=emergency_s if emergency >= 0 else None,
                    wrap=self._wrap(watch, i, end_tick),
                ),
            )

        # Numbers of Python, all at once.
        rows = zip(*(column.tolist() for column in columns), strict=True)
        return [one(i, row) for i, row in enumerate(rows)]

    def _wrap(self, watch: _Watch, train: int, end_tick: int) -> str:
        step = int(watch.first_wrap[train])
        if step < 0:
            return ""
        tick = status_tick(self.times, int(self.times.steps[step]), end_tick)
        return f"{WRAP_FAILURE}, reported at {tick * self._case.scenario.timing.base_tick_ns / 1e9:.2f} s"


def _name_run(seeds: Sequence[int], vectors: Vectors | None, place: int) -> str:
    if vectors is None:
        return f"with seed {seeds[place]}"
    return f"with draws={vectors.draws[place].tolist()} and noise={[list(part) for part in vectors.noise[place]]}"


class _Watch:
    """Events in the law's arithmetic for each train, while it was running."""

    def __init__(self, arithmetic: Any, trains: int) -> None:
        self.counts: dict[int, Ints] = {kind: np.zeros(trains, dtype=np.int64) for kind in _KINDS}
        #: Step of the first wrap of each train, -1: none.
        self.first_wrap = np.full(trains, -1, dtype=np.int64)
        self._all: dict[int, Ints] = {kind: np.zeros(trains, dtype=np.int64) for kind in _KINDS}
        self._arithmetic = arithmetic
        arithmetic.per_train = self._all

    def take(self, step: int, running: NDArray[np.bool_]) -> None:
        """Take the counts of the last step, for running trains only: the law is also computed for trains that have
        finished."""
        if not self._arithmetic.counters.flags:
            return
        wrapped = running & (self._all[WRAP] > 0) & (self.first_wrap < 0)
        self.first_wrap[wrapped] = step
        for kind in _KINDS:
            self.counts[kind] += np.where(running, self._all[kind], 0)
            self._all[kind][:] = 0
