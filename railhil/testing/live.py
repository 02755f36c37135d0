"""A run whose clock is held by the test: it advances only while the test waits for something."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from railhil.bus.can_settings import LOCAL
from railhil.bus.codes import Event
from railhil.bus.errors import BusError
from railhil.bus.frame import Frame
from railhil.bus.store import TrafficStore
from railhil.common.errors import InputError, did_you_mean
from railhil.common.exit_codes import INVALID, PASS
from railhil.dbc import Contract, Signal
from railhil.faults.language import fault_text, parse, with_condition
from railhil.judge.fault_report import check_faults
from railhil.plant_sim.any_plant import PlantError
from railhil.record.run_folder import write_inputs
from railhil.run.local import LocalRun, local_plan
from railhil.run.make import complete, placed, write_results
from railhil.run.memory import with_memory
from railhil.run.report import as_recorded
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.testing.result import Run, fold_word

if TYPE_CHECKING:
    from railhil.run.branch import Trunk

#: Wanted value of a signal: a number, a word of its value table, or a function of its value.
Wanted = float | str | Callable[[float], object]


class NewestTelegrams:
    """Newest telegram of every port, and conditions on its signals."""

    def __init__(self, contract: Contract) -> None:
        self._contract = contract
        self._store = TrafficStore(contract.ports)

    def take(self, frame: Frame, now_ns: int) -> None:
        """Take a frame in bus order."""
        self._store.feed(frame, now_ns)

    def count(self, port: str) -> int:
        """Telegrams of a port so far."""
        return self._store.accepted(port)

    def signals(self, port: str, names: Mapping[str, Any] | None = None) -> dict[str, Signal]:
        """Signals of a port.

        :param names: only these.
        :raises ValueError: there is no such port or signal.
        """
        ports = {one.name: one for one in self._contract.ports}
        if port not in ports:
            raise ValueError(_unknown("port", port, list(ports)))
        signals = {signal.name: signal for signal in ports[port].signals}
        for name in names or ():
            if name not in signals:
                raise ValueError(_unknown(f"signal of {port}", name, list(signals)))
        return signals if names is None else {name: signals[name] for name in names}

    def values(self, port: str) -> dict[str, float]:
        """Physical values of the newest telegram of a port; empty before the first.

        :raises ValueError: there is no such port.
        """
        signals = self.signals(port)
        data = self._store.raw(port)
        return {name: raw_of(signal, data) * signal.scale for name, signal in signals.items()} if data else {}

    def shown(self, port: str, names: Mapping[str, Any]) -> str:
        """Signals of the newest telegram in words."""
        data = self._store.raw(port)
        signals = self.signals(port, names)
        said = [f"{name} {_word(signal, raw_of(signal, data))}" for name, signal in signals.items()] if data else []
        return ", ".join(said) or "no telegram yet"

    def meets(self, port: str, wanted: Mapping[str, Wanted]) -> bool:
        """Whether the newest telegram of a port is as wanted; False before the first."""
        data = self._store.raw(port)
        signals = self.signals(port, wanted)
        return bool(data) and all(_meets(signals[name], raw_of(signals[name], data), wanted[name]) for name in wanted)


def raw_of(signal: Signal, data: bytes) -> int:
    """Raw value of a signal in the process data of its telegram."""
    raw = int.from_bytes(data) >> (len(data) * 8 - signal.first_bit - signal.length) & ((1 << signal.length) - 1)
    return raw - (1 << signal.length) if raw > signal.raw_range[1] else raw


def _meets(signal: Signal, raw: int, wanted: Wanted) -> bool:
    if callable(wanted):
        return bool(wanted(raw * signal.scale))
    if isinstance(wanted, str):
        words = list(signal.values.values())
        if fold_word(wanted) not in map(fold_word, words):
            raise ValueError(_unknown(f"value of {signal.name}", wanted, words))
        return fold_word(signal.values.get(raw, "")) == fold_word(wanted)
    return raw * signal.scale == wanted


def _word(signal: Signal, raw: int) -> str:
    unit = "" if signal.unit in ("", "1") else f" {signal.unit}"
    return signal.values.get(raw, f"{raw * signal.scale:.6g}{unit}")


def _unknown(what: str, name: str, allowed: list[str]) -> str:
    hint = did_you_mean(name, allowed)
    return f"no {what} {name!r}" + (f" ({hint})" if hint else f", allowed {', '.join(allowed)}")


#: A truth of the run to wait for: a value to be reached from either side, or a function of it.
Truth = float | Callable[[float], object]


class Live:
    """One run on the bench in this process, used as a context manager.

    Leaving the block before the run has ended ends it there: its verdict is then INVALID, and its record can be read.
    :meth:`finish` lets it run to its own end.

    :param folder: empty run folder.
    :param on_end: called once with the result.
    """

    def __init__(self, spec: RunSpec, scenario: AnyScenario, folder: Path, on_end: Callable[[Run], object]) -> None:
        self.folder = folder
        #: The result, after the end.
        self.result: Run | None = None
        self._on_end = on_end
        self._begun = False
        # The same run in a process of its own, for branches, and how many it has made.
        self._trunk: Trunk | None = None
        self._branches = 0
        self.spec = with_memory(placed(spec, folder), folder)
        self._prepare(self.spec, scenario)

    def _prepare(self, spec: RunSpec, scenario: AnyScenario) -> None:
        """Nodes and recorder of a run that has not begun."""
        check_faults(scenario, [LOCAL], spec.pace)
        self.spec, self.scenario = spec, scenario
        write_inputs(self.folder, scenario, spec.law.parameters)
        self._heard = NewestTelegrams(scenario.installed_system.contract)
        self._run = LocalRun(local_plan(scenario, spec, self.folder), hear=self._heard.take)
        self._plant = self._run.plant
        self._tick_ns = scenario.timing.base_tick_ns
        self._ticks: Iterator[None] = iter(())
        self._incomplete = "", PASS

    # -- beginning and end --------------------------------------------------------------------------------------------

    def __enter__(self) -> Self:
        """Handshake and first tick.

        :raises BusError: the nodes refuse the run.
        """
        self._begin()
        return self

    def _begin(self) -> None:
        self._plant.handshake()
        self._begun = True
        self._ticks = self._plant.ticks()
        self._advance()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the run if it has not ended; write its folder."""
        self.close()

    def close(self) -> None:
        """End the run here, unless it has ended; a run that has not begun leaves no record."""
        self._end_trunk()
        if not self._begun:
            self._run.log.close()
        elif self.result is None:
            if not self.ended:
                self._incomplete = f"ended by the test at simulation time {self.time_s:.2f} s", INVALID
                self._plant.end(Event.ENDED_BY_SUPERVISOR)
            self._write()

    def finish(self) -> Run:
        """Let the run go on to its own end; returns its result."""
        while self._advance():
            pass
        if self.result is None:
            self._write()
        assert self.result is not None
        return self.result

    def _end_trunk(self) -> None:
        if self._trunk is not None:
            self._trunk.close()
            self._trunk = None

    def _write(self) -> None:
        result = self._run.finish(*self._incomplete)
        complete(result)
        write_results(result)
        self.result = Run(as_recorded(result))
        self._on_end(self.result)

    # -- looking ------------------------------------------------------------------------------------------------------

    @property
    def time_s(self) -> float:
        """Simulation time of the current tick, whose telegrams have all been sent."""
        return self._plant.plant.tick * self._tick_ns / 1e9

    @property
    def ended(self) -> bool:
        """True when the run has ended."""
        return self._plant.ended is not None or bool(self._incomplete[0])

    def read(self, port: str) -> dict[str, float]:
        """Signals of the newest telegram of a port, in the units of ``railhil ports``; empty before the first.

        :raises ValueError: there is no such port.
        """
        return self._heard.values(port)

    # -- faults -------------------------------------------------------------------------------------------------------

    def inject(self, fault: str) -> None:
        """Inject a fault from the next tick on, or when its own condition is met.

        The run is made again up to now with the fault. Its record therefore equals the record of a run that has all its
        faults from the start, and ``railhil rerun`` repeats it.

        :param fault: in the fault language, ``"pantograph off"``, ``"TRN_SPEED loss 30% for 5s"``; with ``@WHEN`` for a
            later instant, place or event.
        :raises InputError: it is not in the language, or cannot be injected here.
        """
        if self.ended:
            raise AssertionError(f"inject: the run has ended, at {self.time_s:.2f} s")
        now = self._plant.plant.tick
        text = fault_text(parse(with_condition(fault, f"{(now + 1) * self._tick_ns / 1e9:.10g}s"), "inject"))
        spec = replace(self.spec, faults=(*self.spec.faults, text))
        scenario = spec.load()
        self._run.log.close()
        self._end_trunk()
        self._prepare(spec, scenario)
        self._begin()
        while self._plant.plant.tick < now:
            if not self._advance():
                raise AssertionError(f"inject: with {text!r} the run ends at {self.time_s:.2f} s")

    def branch(self, *faults: str) -> Run:
        """The run as it goes on to its end with further faults from the next tick on; this one stays as it is.

        Its record equals that of a run that has all these faults from the start. It has a folder of its own beside this
        run's.

        :param faults: as for :meth:`inject`; none: as it goes on without more.
        :raises InputError: one is not in the language, or cannot be injected here.
        """
        if self.ended:
            raise AssertionError(f"branch: the run has ended, at {self.time_s:.2f} s")
        from railhil.run.branch import Trunk, faults_from

        next_s = (self._plant.plant.tick + 1) * self._tick_ns / 1e9
        if self._trunk is None:
            self._trunk = Trunk(self.spec)
        if next_s > self._trunk.time_s:
            self._trunk.advance(next_s)
        self._branches += 1
        folder = self.folder.with_name(f"{self.folder.name}-branch-{self._branches}")
        result = self._trunk.branch((*self.spec.faults, *faults_from(faults, next_s)), folder)
        return Run(as_recorded(result))

    # -- advancing ----------------------------------------------------------------------------------------------------

    def _advance(self) -> bool:
        """One tick; False when the run has ended."""
        if self.ended and self.result is not None:
            return False
        try:
            next(self._ticks)
            if self._plant.ended is not None:
                self._plant.ending()
        except StopIteration:
            return False
        except (BusError, PlantError, InputError) as error:
            self._incomplete = self._run.incomplete(error)
        return not self.ended

    def step(self, ticks: int = 1) -> bool:
        """Advance by so many ticks; False when the run has ended."""
        return all(self._advance() for _ in range(ticks))

    def advance(self, seconds: float) -> bool:
        """Advance by at least so much simulation time; False when the run has ended."""
        return self.step(-(-round(seconds * 1e9) // self._tick_ns))

    def wait_until(
        self,
        port: str = "",
        *,
        timeout_s: float,
        speed: Truth | None = None,
        position: Truth | None = None,
        **signals: Wanted,
    ) -> float:
        """Advance until all given conditions are true; returns the simulation time.

        :param port: wait for its signals to be as wanted: a number, a word of the port table, or a function.
        :param speed: true speed in m/s, ``position`` in m: reached from either side, or a function.
        :param timeout_s: simulation time.
        :raises AssertionError: not within that time, or the run has ended before.
        :raises ValueError: there is no such port, signal or word, or nothing to wait for.
        """
        conditions = [
            self._truth(name, wanted)
            for name, wanted in (("speed", speed), ("position", position))
            if wanted is not None
        ]
        if port:
            self._heard.signals(port, signals)
            conditions.append(
                (lambda: self._heard.meets(port, signals), lambda: f"{port}: {self._heard.shown(port, signals)}")
            )
        if not conditions or (signals and not port):
            raise ValueError("wait_until: a port with its signals, speed or position")
        return self._until(conditions, timeout_s, "wait_until")

    def expect(self, port: str, *, within_s: float, **signals: Wanted) -> float:
        """Advance until a telegram that comes from now on is as wanted; returns the simulation time.

        :param signals: each a number, a word of the port table, or a function; none: any telegram.
        :raises AssertionError: none within that simulation time.
        :raises ValueError: there is no such port, signal or word.
        """
        self._heard.signals(port, signals)
        before = self._heard.count(port)

        def come() -> bool:
            return self._heard.count(port) > before and self._heard.meets(port, signals)

        return self._until([(come, lambda: f"{port}: {self._heard.shown(port, signals)}")], within_s, "expect")

    def _until(
        self, conditions: list[tuple[Callable[[], bool], Callable[[], str]]], timeout_s: float, what: str
    ) -> float:
        end_ns = self._plant.plant.tick * self._tick_ns + round(timeout_s * 1e9)
        while not all(is_true() for is_true, _ in conditions):
            late = (self._plant.plant.tick + 1) * self._tick_ns > end_ns
            if late or not self._advance():
                why = f"not within {timeout_s:g} s of simulation time" if late else "the run has ended"
                seen = "; ".join(shown() for _, shown in conditions)
                raise AssertionError(f"{what}: {why}, at {self.time_s:.2f} s: {seen}")
        return self.time_s

    def _truth(self, name: str, wanted: Truth) -> tuple[Callable[[], bool], Callable[[], str]]:
        """Whether a truth is reached, and its present value in words."""
        truth = self.scenario.installed_system.truth
        signal = str(getattr(truth, name)) if truth is not None else ""
        if truth is None or not signal:
            raise ValueError(f"{name}: system {self.scenario.system} does not say where it is sent; wait for a port")

        def now() -> float:
            return self._heard.values(truth.port).get(signal, 0.0)

        if callable(wanted):
            test = wanted
            return lambda: bool(test(now())), lambda: f"true {name} {now():.6g}"
        goal, rising = wanted, now() <= wanted
        return lambda: now() >= goal if rising else now() <= goal, lambda: f"true {name} {now():.6g}, wanted {goal:.6g}"
