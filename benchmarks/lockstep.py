"""A complete lockstep run: three processes over pipes and over the hub, and the same run in one process."""

from __future__ import annotations

import resource
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks.figures import Figure, MeasurementError, Setting, median
from benchmarks.processes import RunCommand
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.bus.select import HUB_INTERFACE
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario

TITLE = "lockstep run"
METHOD = (
    "`railhil run` (law ipfc, recording on) as plant, controller and supervisor over pipes (the default) and over the "
    "hub on a Unix socket, in turns, three runs each. Processor time and context switches: of the whole command with "
    "all its processes, start and files included; they say more than wall times on a shared machine. Speed factor: "
    "simulated seconds per wall second from the first to the last frame. One process: same nodes and recorder, codec "
    "and stores included, frames handed over by function call; log hashes are checked to be equal. Whole command: "
    "Python's start, the run, the score and all files of the run folder. High-speed train (law pid, float64): three "
    "runs of the first two minutes of its journey, and one of all of it."
)
_ARITHMETICS = ("iq", "float64")
#: Ways between the three processes, and the options that select them; the last one is the default of the command.
_BUSES: dict[str, list[str]] = {"hub": ["-i", HUB_INTERFACE], "pipes": []}
#: Journey of a high-speed train: figure, scenario, number of runs.
_JOURNEYS = (("first 120 s", "hst_short", 3), ("all of 3757 s", "jinan_xuzhou", 1))
#: Options of such a journey.
_ASKED_FACTOR = 50.0
_QUICK_JOURNEY_TOML = """\
system = "hst1"
extends = "hst_short"
name = "benchmark_journey"
title = "8 s of a journey"
[task]
duration_s = 8
"""


@dataclass(frozen=True, slots=True)
class _Timed:
    speed_factor: float
    frames_sha256: str


@dataclass(frozen=True, slots=True)
class _Cost:
    """Processor time and context switches of a command and its processes."""

    cpu_s: float
    switches: int

    @classmethod
    def until_now(cls) -> _Cost:
        """The sums over all processes that this one has started and that have ended."""
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return cls(used.ru_utime + used.ru_stime, used.ru_nvcsw + used.ru_nivcsw)


def _in_one_process(scenario: Scenario, arithmetic: str, folder: Path) -> _Timed:
    """The run without sockets; times of its first and last frame are those at which the controller gets them."""
    folder.mkdir()
    first_ns = last_ns = 0

    def wire(frame: Frame) -> list[Frame]:
        nonlocal first_ns, last_ns
        last_ns = time.perf_counter_ns()
        first_ns = first_ns or last_ns
        return [frame]

    run = local_run(scenario, folder, RunSpec(law=LawSpec(arithmetic=arithmetic)), wire=wire)
    sim_time_s = float(run.trace.times_s("TRN_SPEED")[-1])
    return _Timed(sim_time_s / ((last_ns - first_ns) / 1e9), run.frames_sha256)


def measure(setting: Setting) -> list[Figure]:
    """Figures of both arithmetics (quick: IQ alone).

    :raises MeasurementError: a run failed, or its frame log differs from the log of the run in one process.
    """
    figures: list[Figure] = []
    scenario = setting.scenario
    for arithmetic in _ARITHMETICS[: setting.count(2, 1)]:
        found: defaultdict[str, list[float]] = defaultdict(list)
        for number in range(setting.count(3, 1)):
            hashes = set()
            for bus, words in _BUSES.items():
                out = setting.folder / f"{arithmetic}{number}.{bus}"
                before = _Cost.until_now()
                with RunCommand(setting, arithmetic, out, words) as running:
                    done = running.finish()
                after = _Cost.until_now()
                found[f"{bus} factor"].append(done.score["run"]["speed_factor"])
                found[f"{bus} cpu"].append(after.cpu_s - before.cpu_s)
                found[f"{bus} switches"].append(after.switches - before.switches)
                hashes.add(done.frames_sha256)
            run = done.score["run"]
            found["first frame"].append(run["first_frame_s"])
            found["wall"].append(done.wall_s)
            found["factor"].append(run["speed_factor"])
            found["frames/s"].append(run["frames"] / run["wall_time_s"])
            # Alternating, so that a busy period of the machine affects both.
            alone = _in_one_process(scenario, arithmetic, out.with_suffix(".local"))
            found["alone"].append(alone.speed_factor)
            if hashes != {alone.frames_sha256}:
                raise MeasurementError(f"{arithmetic}: the runs compared have different frame logs")
        factor, alone_factor = median(found["factor"]), median(found["alone"])
        figures += _beside_the_hub(arithmetic, found)
        figures += [
            Figure(
                f"{arithmetic}: speed factor, median",
                factor,
                "sim s/s",
                factor / alone_factor,
                "three processes to one process",
            ),
            Figure(f"{arithmetic}: speed factor, best", max(found["factor"]), "sim s/s"),
            Figure(f"{arithmetic}: speed factor in one process, median", alone_factor, "sim s/s"),
            Figure(f"{arithmetic}: frames recorded, median", median(found["frames/s"]), "frames/s"),
            Figure(f"{arithmetic}: command to first frame, median", median(found["first frame"]), "s"),
            Figure(f"{arithmetic}: whole command, median", median(found["wall"]), "s"),
        ]
    return figures + _journeys(setting)


def _beside_the_hub(arithmetic: str, found: Mapping[str, list[float]]) -> list[Figure]:
    """Speed, processor time and context switches over the hub and over pipes."""
    kinds = (
        ("factor", "speed factor", "sim s/s"),
        ("cpu", "processor time", "s"),
        ("switches", "context switches", "switches"),
    )
    figures = []
    for key, what, unit in kinds:
        values = {bus: median(found[f"{bus} {key}"]) for bus in _BUSES}
        for bus, value in values.items():
            compared = (None, "") if bus == "hub" else (value / values["hub"], "pipes to hub")
            figures.append(Figure(f"{arithmetic}: {what} over {bus}, median", value, unit, *compared))
    return figures


def _journeys(setting: Setting) -> list[Figure]:
    """Speed factors of a high-speed train (quick: 8 s of its journey)."""
    journeys = _JOURNEYS
    if setting.quick:
        path = setting.folder / "journey.toml"
        path.write_text(_QUICK_JOURNEY_TOML, encoding="utf-8")
        journeys = (("first 8 s", str(path), 1),)
    figures = []
    for part, scenario, runs in journeys:
        factors = []
        for number in range(runs):
            out = setting.folder / f"journey{len(figures)}-{number}"
            with RunCommand(replace(setting, scenario_name=scenario), "float64", out) as running:
                factors.append(running.finish().score["run"]["speed_factor"])
        factor = median(factors)
        name, against = f"high-speed train, {part}: speed factor, median", f"to {_ASKED_FACTOR:g}"
        figures.append(Figure(name, factor, "sim s/s", factor / _ASKED_FACTOR, against, {"min": min(factors)}))
    return figures
