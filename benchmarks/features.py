"""Cost of a fault, the panel, learning and three units: the same run with and without, in turns."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

from benchmarks.figures import Figure, Setting, median
from benchmarks.processes import RunCommand, learning_sequence

TITLE = "runs with more"
METHOD = (
    "`railhil run` in lockstep on the bus that it chooses by itself, three runs each, in turns. Fault: a tenth of the "
    "telegrams TRN_SPEED is lost for a second. Panel: it is served, nobody looks. Learning sequence: `railhil sequence "
    "run`, three stops of the law ilc_stop, each with what it has learned in those before (three sequences, all runs "
    "together), beside the same stops one by one with `railhil run`, each with nothing learned. Whole command: from "
    "its start to its exit, with all files; of a sequence, divided by its runs. Three units: the first part of the "
    "journey of a high-speed train (law pid, float64), beside the same with one unit."
)
_FAULT = "TRN_SPEED loss 10% @2s for 1s"
_LEARNING = "ilc_stop"
_STOP = "yizhuang_stop"
_ONE_STOP, _SEQUENCE = "one stop", "learning sequence"
#: Name, scenario (empty: the setting's), arithmetic, options, and the name of the run to compare with.
_RUNS = (
    ("plain", "", "iq", (), ""),
    ("with a fault", "", "iq", ("--fault", _FAULT), "plain"),
    ("with the panel", "", "iq", ("--panel", "0"), "plain"),
    (_ONE_STOP, _STOP, "iq", ("--controller", _LEARNING), ""),
    ("one unit", "hst_short", "float64", (), ""),
    ("three units", "emu3_short", "float64", (), "one unit"),
)


def _factor_figure(name: str, factors: dict[str, list[float]], other: str) -> Figure:
    value = median(factors[name])
    compared = (value / median(factors[other]), f"to {other}") if other else (None, "")
    spread = {"min": min(factors[name]), "max": max(factors[name])}
    return Figure(f"{name}: speed factor, median", value, "sim s/s", *compared, spread)


def _command_figures(walls_s: dict[str, list[float]]) -> list[Figure]:
    """Wall time of the commands, per run."""
    alone_s, together_s = median(walls_s[_ONE_STOP]), median(walls_s[_SEQUENCE])
    return [
        Figure(f"{_ONE_STOP}: whole command, median", alone_s, "s"),
        Figure(f"{_SEQUENCE}: whole command, per run", together_s, "s", together_s / alone_s, f"to {_ONE_STOP}"),
    ]


def measure(setting: Setting) -> list[Figure]:
    """Speed factors (quick: one run of each, a sequence of two, without the high-speed trains).

    :raises MeasurementError: a run failed.
    """
    kinds = _RUNS[: setting.count(len(_RUNS), 4)]
    factors: defaultdict[str, list[float]] = defaultdict(list)
    walls_s: defaultdict[str, list[float]] = defaultdict(list)
    for number in range(setting.count(3, 1)):
        for index, (name, scenario, arithmetic, words, _) in enumerate(kinds):
            chosen = replace(setting, scenario_name=scenario or setting.scenario_name)
            out = setting.folder / f"{index}-{number}"
            # The runs of a stop differ: the single runs are the first ones of the sequence.
            counted = ("--run-number", str(number + 1)) if scenario == _STOP else ()
            with RunCommand(chosen, arithmetic, out, [*words, *counted, "--no-report"]) as running:
                done = running.finish()
            factors[name].append(done.score["run"]["speed_factor"])
            walls_s[name].append(done.wall_s)
        runs = setting.count(3, 2)
        made, wall_s = learning_sequence(_STOP, _LEARNING, runs, setting.folder / f"sequence-{number}")
        factors[_SEQUENCE] += made
        walls_s[_SEQUENCE].append(wall_s / runs)
    figures = [_factor_figure(name, factors, other) for name, *_, other in kinds]
    return [*figures, _factor_figure(_SEQUENCE, factors, _ONE_STOP), *_command_figures(walls_s)]
