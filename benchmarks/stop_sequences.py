"""Many sequences of stops at once, without a bus: ``python -m benchmarks.stop_sequences`` prints the tables.

The law is the real one in double precision over arrays, one element for each sequence; the train is written here with
arrays (delay and lag exact for commands that change at the beginning of a cycle). It is the quick look beside the runs
of the bench, and independent of the bench's train.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.bus.stopping import SAMPLE_S, SAMPLES
from railhil.controller_node.arithmetic.float64 import Float64Batch
from railhil.controller_node.laws.memory import NOTHING
from railhil.controller_node.laws.stopping.ilc_stop import IlcStop, IlcStopParameters
from railhil.controller_node.laws.stopping.interface import STOP
from railhil.controller_node.laws.stopping.reaim import Reaim, ReaimParameters
from railhil.scenarios.stopping.task import StopTask

Floats = NDArray[np.float64]

TICK_S = SAMPLES * SAMPLE_S
_G = 9.81
#: The default scenario, and that of the closed loop.
DEFAULT: dict[str, Any] = {
    "duration_s": 60.0,
    "platform": "board",
    "direction": "up",
    "stop_m": 2631.0,
    "start_m": 2181.0,
    "start_kmh": 60.0,
    "cruise_sigma_mps": 0.15,
    "wander_sigma_mps": 0.003,
    "grade": ((0.0, 3.0), (2500.0, -2.0)),
    "true": {"delay_s": 0.64, "lag_s": 0.42, "gain": 0.985},
    "sensors": {"speed_noise_mps": 0.01},
}
CLOSED: dict[str, Any] = {
    **DEFAULT,
    "map_error_sigma_permil": 0.5,
    "balises_m": (100.0, 64.0, 36.0, 16.0),
    "brake": {"delay_s": 0.64, "lag_s": 0.4},
    "true": {
        "delay_s": 0.7,
        "lag_s": 0.45,
        "gain_train_sigma": 0.05,
        "gain_run_sigma": 0.02,
        "delay_run_sigma_s": 0.02,
    },
    "sensors": {"speed_noise_mps": 0.01, "wheel_sigma": 0.002},
}


def changed(base: Mapping[str, Any], **changes: Any) -> dict[str, Any]:
    """The scenario with other keys; a section is merged."""
    found = dict(base)
    for key, value in changes.items():
        found[key] = {**found.get(key, {}), **value} if isinstance(value, dict) else value
    return found


@dataclass
class _Trains:
    """Draws of the sequences: (N,) each."""

    gain: Floats
    delay_s: Floats
    wheel: Floats
    map_permil: Floats


class Sequences:
    """``count`` sequences of runs of one law.

    :param law, parameters: of the real law.
    """

    def __init__(self, keys: Mapping[str, Any], law: Any, parameters: Any, count: int, seed: int = 1) -> None:
        self.task = task = StopTask.model_validate(dict(keys))
        self.count = count
        self.random = np.random.default_rng(seed)
        self.scenario = SimpleNamespace(task=task, timing=SimpleNamespace(control_period_ns=16_000_000))
        self.law = law(Float64Batch(), self.scenario, parameters, NOTHING)
        normal, true = self.random.standard_normal, task.true
        self.trains = _Trains(
            true.gain * (1.0 + true.gain_train_sigma * normal(count)),
            true.delay_s + true.delay_train_sigma_s * normal(count),
            task.sensors.wheel_sigma * normal(count),
            task.map_error_sigma_permil * normal((count, len(task.grade))),
        )
        #: Records by slot, each field (slots, N).
        first = self.law.start([np.zeros(count)] * len(STOP.readings)).learned.before
        self.records = [np.tile(np.broadcast_to(value, count), (6, 1)) for value in first]
        self.last: dict[str, Floats] = {}

    def run(self, number: int) -> Floats:
        """True stop errors of the next run, m, shape (N,)."""
        task, count, random = self.task, self.count, self.random
        true, normal = task.true, random.standard_normal
        low, high = task.load_percent
        load = np.round(low + (high - low) * random.random(count))
        rail = task.rail
        slides = random.random(count) < rail.slide_share
        least, most = rail.adhesion_mps2
        limit = np.where(slides, least + (most - least) * random.random(count), np.inf)
        seen = slides & (random.random(count) < rail.seen_share)
        wet = slides & (random.random(count) < rail.announced_share)
        gain = self.trains.gain * (1.0 + true.gain_run_sigma * normal(count))
        gain = gain * (1.0 + (true.full_load_gain - 1.0) * load / 100.0)
        delay = self.trains.delay_s + true.delay_run_sigma_s * normal(count)
        speed = task.start_kmh / 3.6 + task.cruise_sigma_mps * normal(count)
        speed = speed + task.start_spread_kmh / 3.6 * (2.0 * random.random(count) - 1.0)
        train = _Train(task, self.trains, gain, delay, speed, limit, random)
        readings = [np.zeros(count) for _ in STOP.readings]
        state: Any = None
        stopped_ticks = 0
        mark = task.sensors.mark_sigma_m * normal(count)
        error = np.full(count, np.nan)
        for tick in range(int(task.duration_s / TICK_S)):
            readings[:5] = [np.clip(np.round(s * 1e3), 0, 65535) for s in train.samples]
            readings[5:8] = [np.full(count, tick & 0xFFFF), np.ones(count), train.sliding & seen]
            readings[8:11] = [np.floor(train.odometer() * 1e3), train.balise, np.floor(train.at_balise * 1e3)]
            own = np.full(count, float(number))
            readings[11:16] = [load, wet, train.stands, train.stands & False, own]
            if stopped_ticks:
                readings[16:18] = [
                    own,
                    np.round((error + mark) * 1e3),
                ]
            if state is None:
                state = self.law.start(readings)
                slot = (np.minimum(load // (100 / 3), 2) + 3 * wet).astype(int)
                where = (slot, np.arange(count))
                record = type(state.learned.before)(*(field[where] for field in self.records))
                state = state._replace(learned=state.learned._replace(before=record, after=record))
            state, answer = self.law.step(state, readings)
            train.advance(np.round(answer.commands[0]) / 1e3, np.round(answer.commands[1]) / 1e4)
            if train.stands.all():
                if not stopped_ticks:
                    error = train.position - task.stop_m
                stopped_ticks += 1
                if stopped_ticks > 4:
                    break
        for field, value in zip(self.records, state.learned.after, strict=True):
            field[where] = value
        self.last = {"slides": slides, "wet": wet, "load": load}
        return np.where(train.stands, train.position - task.stop_m, np.nan)

    def runs(self, count: int) -> Floats:
        """Errors of ``count`` runs, shape (runs, N)."""
        return np.array([self.run(number) for number in range(1, count + 1)])


class _Train:
    """N trains, advanced by cycles of 16 ms in five sub-steps."""

    def __init__(
        self, task: Any, trains: _Trains, gain: Floats, delay: Floats, speed: Floats, limit: Floats, random: Any
    ) -> None:
        self.task, self.trains, self.gain, self.limit, self.random = task, trains, gain, limit, random
        self.count = len(speed)
        self.position = np.full(self.count, task.start_m)
        self.speed = speed
        self.stands = speed < 0.0
        self.sliding = self.stands
        self._edges = [place for place, _ in task.grade[1:]]
        permil = np.array([grade for _, grade in task.grade])[None, :] + trains.map_permil
        self._grades = -_G * permil / 1000.0
        steady = -self._grade()
        self.drive = steady
        self._history = [steady] * 200
        self._delay(np.maximum(delay, 0.0))
        self._braking = np.zeros(self.count, dtype=bool)
        self._keep = np.exp(-TICK_S / task.wander_time_s)
        self._add = task.wander_sigma_mps * np.sqrt(1.0 - self._keep**2)
        self._wander = task.wander_sigma_mps * self._normal()
        self.samples = [self._read() for _ in range(SAMPLES)]
        self.balise, self.at_balise = np.zeros(self.count), np.zeros(self.count)

    def _normal(self) -> Floats:
        return np.asarray(self.random.standard_normal(self.count))

    def _delay(self, delay: Floats) -> None:
        self.delay = delay
        self._whole = np.floor(delay / TICK_S + 1e-9).astype(int)
        rest = np.maximum(delay - self._whole * TICK_S, 0.0)
        self._parts = []
        for step in range(SAMPLES):
            older = np.clip(rest - step * SAMPLE_S, 0.0, SAMPLE_S)
            self._parts.append(((older, 1), (SAMPLE_S - older, 0)))

    def _grade(self) -> Floats:
        piece = sum((self.position >= edge).astype(int) for edge in self._edges)
        return np.asarray(self._grades[np.arange(self.count), piece])

    def _read(self) -> Floats:
        noise = self.task.sensors.speed_noise_mps * self._normal()
        return np.where(self.stands, 0.0, self.speed * (1.0 + self.trains.wheel) + noise)

    def odometer(self) -> Floats:
        """m since the start."""
        return (self.position - self.task.start_m) * (1.0 + self.trains.wheel)

    def advance(self, accel: Floats, start: Floats) -> None:
        """One cycle with a new command."""
        if np.any(start > 0.0):
            # The one command that begins inside a cycle is the brake's: from then on the delay is longer by it.
            self._delay(self.delay + start)
        self._braking = self._braking | (accel < 0.0)
        self._history = [np.broadcast_to(accel, (self.count,)), *self._history[:-1]]
        queue = np.array(self._history[: int(self._whole.max()) + 2])
        one = np.arange(self.count)
        targets = [queue[self._whole, one], queue[self._whole + 1, one]]
        targets = [np.where(target < 0.0, self.gain * target, target) for target in targets]
        after = self._keep * self._wander + self._add * self._normal()
        wander = np.where(self._braking, 0.0, (after - self._wander) / TICK_S)
        self._wander = after
        self.samples = []
        before = self.position
        for parts in self._parts:
            for duration, which in parts:
                self._move(targets[which], duration, wander)
            self.samples.append(self._read())
        for index, distance in enumerate(self.task.balises_m, 1):
            place = self.task.stop_m - distance
            passed = (before < place) & (self.position >= place)
            if passed.any():
                error = self.task.sensors.balise_sigma_m * self._normal()
                self.balise = np.where(passed, index, self.balise)
                read = (place - self.task.start_m + error) * (1.0 + self.trains.wheel)
                self.at_balise = np.where(passed, read, self.at_balise)

    def _move(self, target: Floats, time: Floats, wander: Floats) -> None:
        lag = self.task.true.lag_s
        decay = np.exp(-time / lag)
        lagging = self.drive - target
        fades = (self.drive < 0.0) & (self.speed <= self.task.true.low_speed_mps)
        factor = np.where(fades, 1.0 - self.task.true.low_speed_loss, 1.0)
        outside = self._grade() + wander
        self.sliding = -factor * self.drive > self.limit
        outside = np.where(self.sliding, outside - np.where(self.sliding, self.limit, 0.0), outside)
        factor = np.where(self.sliding, 0.0, factor)
        steady = factor * target + outside
        gone = lag * (1.0 - decay)
        speed = self.speed + steady * time + factor * lagging * gone
        moved = self.speed * time + 0.5 * steady * time * time + factor * lagging * lag * (time - gone)
        mean = np.where(time > 0.0, (speed - self.speed) / np.maximum(time, 1e-12), -1.0)
        stops = (speed <= 0.0) & ~self.stands
        moved = np.where(stops, self.speed**2 / np.maximum(-2.0 * mean, 1e-6), moved)
        self.position = np.where(self.stands, self.position, self.position + moved)
        self.stands = self.stands | stops
        self.speed = np.where(self.stands, 0.0, speed)
        self.drive = target + lagging * decay


# -- tables -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Row:
    """One line of a table: a law on a scenario."""

    title: str
    keys: Mapping[str, Any]
    law: Any
    parameters: Any
    runs: int = 15
    #: Runs that are left out of the figures: the first ones, in which the law learns.
    tail: int = 10


def _filters() -> list[Row]:
    names = ("none", "packet", "packet_newest", "packet_antireflect", "mean16", "fir65", "iir", "kalman")
    return [Row(name, DEFAULT, IlcStop, IlcStopParameters(filter=name)) for name in names]


def _gammas() -> list[Row]:
    gammas = (0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 0.0)
    return [Row(f"gamma {g:g}" if g else "rule 1/j", DEFAULT, IlcStop, IlcStopParameters(gamma=g)) for g in gammas]


def _scatter() -> list[Row]:
    def keys(sigma: float) -> dict[str, Any]:
        return changed(DEFAULT, true={"gain_run_sigma": sigma, "delay_run_sigma_s": 0.02})

    rows = [
        Row(f"gain {100 * s:g} %, packet", keys(s), IlcStop, IlcStopParameters()) for s in (0.001, 0.005, 0.01, 0.02)
    ]
    return [*rows, Row("gain 1 %, none", keys(0.01), IlcStop, IlcStopParameters(filter="none"))]


def _epsilons() -> list[Row]:
    exact = changed(DEFAULT, grade=((0.0, 0.0),), true={"delay_s": 0.6, "lag_s": 0.4, "gain": 1.0})
    rows = []
    for epsilon_m in (0.1, 0.2, 0.4, 0.6, 0.8):
        learned = IlcStopParameters(epsilon_m=epsilon_m)
        fixed = IlcStopParameters(epsilon_m=epsilon_m, learning="none")
        rows.append(Row(f"A eps {epsilon_m:g}, learned", DEFAULT, IlcStop, learned))
        rows.append(Row(f"C eps {epsilon_m:g}, exact model", exact, IlcStop, fixed, 3, 0))
    return rows


def _closed() -> list[Row]:
    loss = changed(CLOSED, true={"low_speed_loss": 0.15})
    slide = changed(CLOSED, rail={"slide_share": 0.1, "seen_share": 0.9})

    def row(title: str, keys: Mapping[str, Any], runs: int = 15, tail: int = 10, **given: Any) -> Row:
        return Row(title, keys, Reaim, ReaimParameters(**given), runs, tail)

    return [
        Row("paper's brake", CLOSED, IlcStop, IlcStopParameters()),
        row("re-aim", CLOSED, 3, 0, learning=False, observer=False, balises=False),
        row("+ balises", CLOSED, 3, 0, learning=False, observer=False),
        row("+ observer, no balises", CLOSED, 3, 0, learning=False, balises=False),
        row("+ observer + balises", CLOSED, 3, 0, learning=False),
        row("the same, learned", CLOSED),
        row("no balises, learned", CLOSED, balises=False),
        row("low-speed loss", loss, 3, 0, learning=False),
        row("low-speed loss, learned", loss),
        row("10 % slide runs, learned", slide),
    ]


TABLES: dict[str, Callable[[], list[Row]]] = {
    "filters": _filters,
    "gammas": _gammas,
    "scatter": _scatter,
    "epsilons": _epsilons,
    "closed": _closed,
}


def converged(errors: Floats, within_m: float = 0.3) -> Floats:
    """Run at which each sequence has converged: the first of three in a row within the limit; inf if there is none.

    :param errors: (runs, N), m.
    """
    good = np.abs(errors) <= within_m
    three = good[:-2] & good[1:-1] & good[2:]
    return np.where(three.any(axis=0), three.argmax(axis=0) + 1.0, np.inf)


def measured(row: Row, sequences: int) -> str:
    """The line of the table; slide runs are left out of its figures."""
    many = Sequences(row.keys, row.law, row.parameters, sequences)
    errors, slides = [], []
    for number in range(1, row.runs + 1):
        errors.append(many.run(number))
        slides.append(many.last["slides"])
    every = np.array(errors)
    tail = every[row.tail :][~np.array(slides)[row.tail :]]
    size = np.abs(tail)
    shares = [100.0 * float((size <= within_m).mean()) for within_m in (0.1, 0.3)]
    runs = converged(every) if row.runs > 2 else np.array([np.inf])
    return (
        f"{row.title:28s} {size.mean():7.3f} {np.sqrt(np.square(tail).mean()):7.3f} {np.percentile(size, 95):7.3f}"
        f" {shares[0]:5.0f} {shares[1]:5.0f} {np.median(runs):6.1f} {np.percentile(runs, 90, method='lower'):5.1f}"
        f" {np.abs(every[0]).mean():8.3f}"
    )


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.stop_sequences", description="Sequences of stops.")
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)}; all by default")
    parser.add_argument("--sequences", type=int, default=150)
    given = parser.parse_args()
    print(f"{'':28s} mean|e|     rms     p95  <=0.1 <=0.3   runs   P90  first run")
    for name in given.tables or TABLES:
        print(name)
        for row in TABLES[name]():
            print(measured(row, given.sequences), flush=True)


if __name__ == "__main__":
    main()
