"""What a fault, the panel and three units cost: the same run with and without, in turns."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.figures import Figure, Setting, median
from benchmarks.processes import RunCommand

TITLE = "runs with more"
METHOD = (
    "`railhil run` in lockstep on the bus that it chooses by itself, three runs each, in turns. Fault: a tenth of the "
    "telegrams TRN_SPEED is lost for a second. Panel: it is served, nobody looks. Three units: the first part of the "
    "journey of a high-speed train (law pid, float64), beside the same with one unit."
)
_FAULT = "TRN_SPEED loss 10% @2s for 1s"
#: Name, scenario (empty: that of the setting), arithmetic, options, and what it is compared with.
_RUNS = (
    ("plain", "", "iq", (), ""),
    ("with a fault", "", "iq", ("--fault", _FAULT), "plain"),
    ("with the panel", "", "iq", ("--panel", "0"), "plain"),
    ("one unit", "hst_short", "float64", (), ""),
    ("three units", "emu3_short", "float64", (), "one unit"),
)


def measure(setting: Setting) -> list[Figure]:
    """Speed factors (quick: one run of each, without the high-speed trains).

    :raises MeasurementError: a run failed.
    """
    kinds = _RUNS[: setting.count(len(_RUNS), 3)]
    factors: dict[str, list[float]] = {name: [] for name, *_ in kinds}
    for number in range(setting.count(3, 1)):
        for index, (name, scenario, arithmetic, words, _) in enumerate(kinds):
            chosen = replace(setting, scenario_name=scenario or setting.scenario_name)
            out = setting.folder / f"{index}-{number}"
            with RunCommand(chosen, arithmetic, out, [*words, "--no-report"]) as running:
                factors[name].append(running.finish().score["run"]["speed_factor"])
    figures = []
    for name, *_, other in kinds:
        value = median(factors[name])
        compared = (value / median(factors[other]), f"to {other}") if other else (None, "")
        spread = {"min": min(factors[name]), "max": max(factors[name])}
        figures.append(Figure(f"{name}: speed factor, median", value, "sim s/s", *compared, spread))
    return figures
