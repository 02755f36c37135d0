"""One run of three processes on a real bus, with the nodes forked instead of started as commands.

In the virtual machine that gives the kernel (:mod:`railhil.machines.vcan_vm`) it takes seconds to
import the nodes once; a fork has them already. Everything else is as with ``railhil run --attach``.
"""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from railhil.bus.administrator import REPLY_NS
from railhil.bus.link import Link, Timeouts, open_link
from railhil.bus.link.base import TIMEOUTS
from railhil.bus.local import LocalBus
from railhil.bus.select import BusChoice
from railhil.common.exit_codes import run_guarded
from railhil.common.patience import Lifelines
from railhil.common.python_process import kill_this_process, stop_this_process
from railhil.common.scheduling import cycle
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.controller import make_controller_node, write_fault_log
from railhil.controller_node.process_loop import run_controller
from railhil.controller_node.telemetry_file import write_telemetry
from railhil.judge.result import Result
from railhil.plant_sim.node import make_plant_node
from railhil.record.run_folder import TELEMETRY
from railhil.record.session import make_session
from railhil.run.bus_run import BusRun
from railhil.run.memory import learned
from railhil.run.run import Observer, Plan
from railhil.scenarios.load import load_any
from railhil.scenarios.memory import no_memory
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec, StartUp
from railhil.sequences.evidence import Evidence, Made, run_name
from railhil.sequences.plan import run_specs
from railhil.sequences.record import record
from railhil.systems.ato.scenario.model import Scenario

#: Simulation time of the beginning of a run.
_BEGINNING_S = 10.0
#: The first run of a sequence of :func:`short_stop`.
STOPS = RunSpec("yizhuang_stop", law=LawSpec("ilc_stop", "float64"), seed=7)
#: Hash of its first two runs; tests over the hub and in one process give it, too.
STOPS_SHA256 = "6f26282811c029c38aa178774783d047376568539460f6f3f34b143809f9c2b5"
#: A node that has not ended this long after the record is killed.
_NODE_END_S = 20.0


def socketcan(channel: str = "vcan0") -> dict[str, Any]:
    """Arguments of ``can.Bus`` for a kernel interface."""
    return {"interface": "socketcan", "channel": channel}


def run_on(
    config: Mapping[str, Any],
    scenario: AnyScenario,
    folder: Path,
    *,
    seed: int = 1,
    pace: str = "lockstep",
    rate: float = 1.0,
    controller: str = "ipfc",
    arithmetic: str = "iq",
    spec: RunSpec | None = None,
    controller_config: Mapping[str, Any] | None = None,
    controller_command: Sequence[str] | None = None,
    on_progress: Callable[[float], None] | None = None,
    appear_s: float = 25.0,
    reply_ns: int = REPLY_NS,
    timeouts: Timeouts = TIMEOUTS,
    open_recorder: Callable[[dict[str, Any], str], Link] = open_link,
) -> tuple[Result, list[int | None]]:
    """One run: plant and controller in processes of their own, the supervisor in this one.

    What the nodes say is in ``folder/plant.txt`` and ``controller.txt`` afterwards, what they counted comes from
    :func:`counters_of`.

    As with ``railhil run``, the plant notices at once when the controller's process has ended.

    :param config: arguments of ``can.Bus`` for plant and supervisor.
    :param folder: existing run folder.
    :param rate: simulated seconds per wall second; only with ``pace="realtime"``.
    :param spec: the run, instead of what ``seed`` to ``arithmetic`` say of it.
    :param controller_config: bus of the controller, when it is another one (gateway, adapter).
    :param controller_command: a program to start in place of our controller node; it finds the bus by itself.
    :param on_progress: called in this process at each SUP_CMD poll (160 ms of simulation time) with that time in s;
        the place to disturb the bus from.
    :param open_recorder: makes the supervisor's link.
    :param timeouts: of plant and controller with their interfaces.
    :param reply_ns: realtime: reply time-out of the polls, where 5 ms are too short for an emulated machine.
    :returns: the result, and the exit codes of controller and plant (None: it had to be killed).
    """
    asked = spec or RunSpec(scenario.name, law=LawSpec(controller, arithmetic), seed=seed, pace=pace, rate=rate)
    # The write end closes with the controller's process.
    controller_alive, controller_open = os.pipe()

    def run_the_controller() -> int:
        os.close(controller_alive)
        node = make_controller_node(scenario, asked, folder=folder, kill=kill_this_process, pause=stop_this_process)
        link = open_link(
            dict(config if controller_config is None else controller_config), "controller", timeouts=timeouts
        )
        try:
            return run_controller(node, link)
        finally:
            _write_counters(folder, "controller", {**link.counters, **node.counters})
            write_telemetry(node, folder / TELEMETRY)
            write_fault_log(node)

    def run_the_plant() -> int:
        link = open_link(dict(config), "plant", timeouts=timeouts)
        if controller_command is None:
            link.lifelines = Lifelines({"controller": controller_alive})
        node = make_plant_node(scenario, asked, link, appear_s=appear_s, reply_ns=reply_ns, fault_log=folder)
        try:
            node.run()
        finally:
            link.close()
            _write_counters(folder, "plant", {**link.counters, **node.counters, **node.plant.refused})
            node.faults.write_logs()
        return 0

    nodes: list[_Forked | _Program] = []
    try:
        if controller_command is None:
            nodes.append(_Forked("controller", run_the_controller, folder))
        else:
            nodes.append(_Program("controller", controller_command, folder))
        os.close(controller_open)
        nodes.append(_Forked("plant", run_the_plant, folder))
        choice = BusChoice(dict(config), "the test's")
        asked = replace(asked, start_up=StartUp(attach=True, appear_s=appear_s))
        plan = Plan(asked, scenario, choice, folder)
        result = BusRun(plan, _Progress(on_progress), open_bus=open_recorder).execute()
        return result, [node.exit_code(_NODE_END_S) for node in nodes]
    finally:
        os.close(controller_alive)
        for node in nodes:
            node.kill()


class _Progress(Observer):
    """Passes the progress of a run on to a test."""

    def __init__(self, take: Callable[[float], None] | None) -> None:
        self._take = take

    def on_progress(self, sim_time_s: float) -> None:
        if self._take is not None:
            self._take(sim_time_s)


def short_stop() -> AnyScenario:
    """The shortest run of the system ``stop``: from 11 km/h, 11 m before the stopping point; it lasts 6 s."""
    slow = ("task.start_m=2620", "task.start_kmh=10.8", "task.approach_kmh=10.8", "task.after_stop_s=1.5")
    return load_any("yizhuang_stop", slow)


def sequence_on(
    config: Mapping[str, Any], scenario: AnyScenario, folder: Path, first: RunSpec, runs: int
) -> list[Made]:
    """A sequence of runs of a law that learns, each as with :func:`run_on` in a folder of its own.

    :param first: its first run.
    """
    memory = no_memory(first.law.controller, folder)
    made = []
    for number, spec in enumerate(run_specs(first, scenario, first.seed, runs), 1):
        place = folder / run_name(number)
        place.mkdir()
        spec = replace(spec, law=replace(spec.law, memory=memory))
        result, exit_codes = run_on(config, scenario, place, spec=spec)
        assert (result.trusted, exit_codes) == (True, [0, 0])
        found = learned(replace(result, spec=spec))
        assert found is not None
        assert found.record is not None
        one = Made(
            run=number,
            verdict=result.verdict,
            memory_before_sha256=memory.sha256,
            frames_sha256=result.frames_sha256,
            memory_after_sha256=found.record.sha256,
        )
        memory = memory.add_run(found.record, found.kept.used, found.kept.refused)
        made.append(one)
    return made


def local_sequence(scenario: AnyScenario, folder: Path, first: RunSpec, runs: int) -> list[Made]:
    """The same sequence in this process, as ``railhil sequence`` records it."""
    first = replace(first, bus="local")
    done = record(folder, Evidence(first, runs, ()), scenario, first, lambda number, result: None)
    return list(done.made)


class _Enough(Exception):
    """The run has lasted as long as it is looked at."""


def beginning(config: Mapping[str, Any], scenario: Scenario, folder: Path) -> tuple[list[str], list[str]]:
    """The first 10 s of the record of a run on a bus, seed 0, and of the same run in this process; neither goes on."""

    def enough(now_s: float) -> None:
        if now_s > _BEGINNING_S + 1:
            raise _Enough

    expected: list[str] = []
    session = make_session(scenario, expected.append, RunSpec(), on_progress=enough)
    with contextlib.suppress(_Enough):
        controller = ControllerNode(scenario, LawSpec())
        make_plant_node(scenario, RunSpec(), LocalBus([controller.handle, session.handle])).run()
    with contextlib.suppress(_Enough):
        run_on(config, scenario, folder, seed=0, on_progress=enough)
    recorded = (folder / "frames.log").read_text().splitlines(keepends=True)
    return _before_its_end(recorded), _before_its_end(expected)


def _before_its_end(lines: Sequence[str]) -> list[str]:
    return [line for line in lines if float(line[1 : line.index(")")]) < _BEGINNING_S]


def counters_of(folder: Path, role: str) -> dict[str, int]:
    """What the node ``role`` of a run in ``folder`` has counted, its link's counters among it."""
    document: dict[str, int] = json.loads((folder / f"{role}_counters.json").read_text())
    return document


def say_into(file: Path) -> None:
    """Send what this process says, also through pytest's own streams, into a file."""
    output = file.open("w", buffering=1)
    os.dup2(output.fileno(), 1)
    os.dup2(output.fileno(), 2)
    sys.stdout = sys.stderr = output


def _write_counters(folder: Path, role: str, counters: Mapping[str, int]) -> None:
    (folder / f"{role}_counters.json").write_text(json.dumps(counters))


class _Forked:
    """A node in a fork of this process, as its command would run it."""

    def __init__(self, role: str, main: Callable[[], int], folder: Path) -> None:
        def process() -> None:
            say_into(folder / f"{role}.txt")
            # As the supervisor places the nodes that it starts itself (Nodes.keep_together).
            os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
            with cycle(role, 0):
                code = run_guarded(role, main)
            raise SystemExit(code)

        self._process: BaseProcess = multiprocessing.get_context("fork").Process(target=process, name=role)
        self._process.start()

    def exit_code(self, timeout_s: float) -> int | None:
        self._process.join(timeout_s)
        return self._process.exitcode

    def kill(self) -> None:
        self._process.kill()
        self._process.join()


class _Program:
    """A program in place of a node."""

    def __init__(self, role: str, command: Sequence[str], folder: Path) -> None:
        with (folder / f"{role}.txt").open("wb") as output:
            self._process = subprocess.Popen(
                list(command), stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
            )

    def exit_code(self, timeout_s: float) -> int | None:
        try:
            return self._process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return None

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()
