"""The process of a trunk: one run on the one-process bus that stands still at an instant and forks its branches.

A branch is a fork of this process. It takes its faults at the instant, writes its log from the beginning on into its
own folder, runs to its end and gives its result to the process that has asked for it. Only a process with one thread
forks: locks of other threads would stay locked in the fork.

:class:`railhil.run.branch.Trunk` starts it with a connection, over which it is told what to do.
"""

from __future__ import annotations

import gc
import hashlib
import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NoReturn

from railhil.bus.can_settings import LOCAL
from railhil.bus.errors import BusError
from railhil.common.errors import InputError, Words
from railhil.common.python_process import end_with_parent
from railhil.faults.capability import looks_back
from railhil.judge.fault_report import check_faults
from railhil.judge.result import Result
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.faults.plants import faults_inside
from railhil.record.run_folder import write_inputs
from railhil.record.statements import restate
from railhil.run.local import LocalRun, local_plan
from railhil.run.make import complete, placed, write_results
from railhil.run.memory import with_memory
from railhil.run.run import Plan
from railhil.scenarios.fault_list import draw_faults
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

_NS_PER_S = 1_000_000_000
#: One entry for each thread of this process; Linux only.
_THREADS = Path("/proc/self/task")


@dataclass(frozen=True, slots=True)
class Advance:
    """Run until the instants before this time have passed. Answered by None.

    :ivar time_s: simulation time.
    """

    time_s: float


@dataclass(frozen=True, slots=True)
class Branch:
    """Fork a branch. Answered by its :class:`~railhil.judge.result.Result`, or by a :class:`NoFork`.

    :ivar faults: all of its run besides the scenario's own.
    :ivar folder: its empty run folder.
    :ivar keep: whether the folder is to be complete; else it has only what the result needs.
    :ivar settings: all of its scenario.
    """

    faults: tuple[str, ...]
    folder: Path
    keep: bool
    settings: tuple[str, ...]

    def of(self, trunk: RunSpec) -> RunSpec:
        """The run of the branch."""
        return replace(trunk, faults=self.faults, settings=self.settings)


@dataclass(frozen=True, slots=True)
class NoFork:
    """The reason why a branch must be a straight run."""

    why: str


class Standing:
    """The run of a trunk.

    Its log has no name in the file system: nothing is left of a trunk that is killed.

    :raises InputError: the run cannot be made.
    :raises BusError: its nodes refuse it.
    """

    def __init__(self, spec: RunSpec) -> None:
        self.scenario = spec.load()
        check_faults(self.scenario, [LOCAL], spec.pace)
        with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
            plan = _plan(spec, self.scenario, Path(folder))
            self.spec = plan.spec
            self.run = LocalRun(plan, branches=True)
            self._written = self.run.log.path.open("rb")
        self._tick_ns = self.scenario.timing.base_tick_ns
        self._ticks: Iterator[None] = iter(())
        self.run.plant.handshake()
        self._ticks = self.run.plant.ticks()
        next(self._ticks)

    @property
    def instant_ns(self) -> int:
        """The next instant."""
        return (self.run.plant.plant.tick + 1) * self._tick_ns

    def advance(self, time_s: float) -> None:
        """Run until the instants before a time have passed.

        :raises InputError: the run ends before, or it has passed this time.
        """
        wanted_ns = round(time_s * _NS_PER_S)
        if wanted_ns <= self.instant_ns - self._tick_ns:
            found = Words(f"{time_s:g} s")
            raise InputError("branch", "instant", found, f"a time after {(self.instant_ns - self._tick_ns) / 1e9:g} s")
        self.run.plant.resume()
        try:
            while self.instant_ns < wanted_ns:
                if self.run.plant.ended is not None or self.run.plant.controller_lost:
                    raise _ends(time_s, self.run)
                next(self._ticks)
        except (StopIteration, BusError, PlantError):
            raise _ends(time_s, self.run) from None

    def close(self) -> None:
        """Close its log."""
        self._written.close()
        self.run.log.abandon()

    def why_not(self, scenario: AnyScenario) -> str:
        """Reason why the run with these faults cannot be a fork; empty: it can.

        :param scenario: that of the branch.
        """
        if _THREADS.is_dir() and (count := len(list(_THREADS.iterdir()))) != 1:
            return f"the process has {count} threads"
        own, seed = draw_faults(self.scenario, self.spec.seed), self.spec.seed
        if self.run.plant.faults.inside is None and faults_inside(scenario, seed):
            return f"the plant of system {scenario.system} takes its faults only at the start"
        for number, fault in enumerate(draw_faults(scenario, seed)):
            is_never = fault.trigger.kind == "manual"
            if looks_back(fault) and not is_never and fault not in own[number : number + 1]:
                return f"fault {number + 1} depends on what was before it began"
        return ""

    def become(self, asked: Branch) -> Result:
        """Be the branch, in a fork of this process: run to its end, and write its folder.

        :raises InputError: one of its faults cannot be injected, or has begun.
        """
        spec = asked.of(self.spec)
        plan = _plan(spec, spec.load(), asked.folder)
        check_faults(plan.scenario, [LOCAL], spec.pace)
        run, instant_ns = self.run, self.instant_ns
        run.log.flush()
        # All branches share the place of the file.
        self._written.seek(0)
        prefix = self._written.read()
        self._written.close()
        run.adopt(plan)
        run.log.move(asked.folder, restate(prefix, plan.scenario))
        run.plant.resume()
        result = run.finish(*run.let_end(self._ticks))
        sha256 = hashlib.sha256(prefix).hexdigest()
        result.branched_from = {"sha256": sha256, "lines": prefix.count(b"\n"), "instant_s": instant_ns / 1e9}
        complete(result)
        if asked.keep:
            write_results(result)
        return result


def _ends(time_s: float, run: LocalRun) -> InputError:
    found = Words(f"{time_s:g} s")
    return InputError("branch", "instant", found, f"a time before the end of the run at {run.session.sim_time_s:g} s")


def _plan(spec: RunSpec, scenario: AnyScenario, folder: Path) -> Plan:
    """A run in a folder, with its inputs written."""
    spec = with_memory(placed(spec, folder), folder)
    write_inputs(folder, scenario, spec.law.parameters)
    return local_plan(scenario, spec, folder)


def serve(pipe: Connection, spec: RunSpec) -> None:
    """Do what comes over a connection, until it is closed at its other end."""
    try:
        trunk = Standing(spec)
    except Exception as error:
        pipe.send(error)
        return
    pipe.send(None)
    while True:
        try:
            asked: Advance | Branch = pipe.recv()
        except EOFError:
            return
        if isinstance(asked, Branch):
            _fork(pipe, trunk, asked)
            continue
        try:
            trunk.advance(asked.time_s)
            pipe.send(None)
        except InputError as error:
            pipe.send(error)


def _fork(pipe: Connection, trunk: Standing, asked: Branch) -> None:
    """Make a branch, which answers by itself; a branch that has died ends the trunk."""
    try:
        why = trunk.why_not(asked.of(trunk.spec).load())
    except InputError as error:
        pipe.send(error)
        return
    if why:
        pipe.send(NoFork(why))
        return
    trunk.run.log.flush()
    parent = os.getpid()
    gc.freeze()
    pid = os.fork()
    if not pid:
        _answer(pipe, trunk, asked, parent)
    gc.unfreeze()
    _, status = os.waitpid(pid, 0)
    if status:
        raise SystemExit(1)


def _answer(pipe: Connection, trunk: Standing, asked: Branch, parent: int) -> NoReturn:
    """In the fork: give the result, or the error, and end."""
    code = 1
    try:
        end_with_parent()
        if os.getppid() == parent:
            try:
                found: object = trunk.become(asked)
            except Exception as error:
                found = error
            pipe.send(found)
            code = 0
    finally:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
        # Never return into the trunk's code.
        os._exit(code)


def main() -> None:
    """The process; its words are the numbers of the connection's descriptor and of the parent."""
    end_with_parent()
    # A Ctrl-C of the terminal ends the process that has started this one, and the kernel ends this one with it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    descriptor, parent = map(int, sys.argv[1:])
    if os.getppid() != parent:
        return
    with Connection(descriptor) as pipe:
        serve(pipe, pipe.recv())
