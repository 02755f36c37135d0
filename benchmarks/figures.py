"""Results of a benchmark: figures with units, and the statistics of their samples."""

from __future__ import annotations

import timeit
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import process_time

import numpy as np

from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario

#: Scenario of the full measurement: the published run, 2940 m in 195 s.
FULL_SCENARIO = "lvshun_tieshan"
#: Same train and line, 8 m in 8 s: shows that a benchmark works, not how fast the bench is.
QUICK_TOML = """\
extends = "lvshun_tieshan"
name = "benchmark_quick"
title = "8 m in 8 s"
[target]
nodes_s_mps2 = [[0, 0.5], [3.9, 0.5], [4.1, -0.5], [8, -0.5]]
[plan]
distance_m = 7.9983
running_time_s = 8
overtime_max_s = 1
"""


class MeasurementError(Exception):
    """A benchmark could not make its measurement; one line."""

    exit_code = 3


@dataclass(frozen=True, slots=True)
class Figure:
    """One measured value.

    ``ratio`` is a pure number and ``against`` names the other quantity; both are absent if nothing is compared.
    ``spread``: further values of the same samples in the same unit, such as ``{"p99": 12.5}``.
    """

    name: str
    value: float
    unit: str
    ratio: float | None = None
    against: str = ""
    spread: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Missing:
    """A figure that this machine cannot provide: it is shown in the table with the reason."""

    name: str
    why: str


@dataclass(frozen=True, slots=True)
class Setting:
    """Arguments of a benchmark: whether it is quick, the scenario, and an empty folder of its own.

    ``scenario_name``: as the command line takes it (shipped name or TOML file). ``multicast``: the permitted multicast
    group; empty: none.
    """

    quick: bool
    scenario_name: str
    folder: Path
    multicast: str = ""

    @classmethod
    def make(cls, quick: bool, folder: Path, multicast: str = "") -> Setting:
        """Setting of a full or a quick measurement; the quick one has the short scenario."""
        full = cls(quick, FULL_SCENARIO, folder, multicast)
        return full.short() if quick else full

    def short(self) -> Setting:
        """The same setting with the scenario of 8 s."""
        path = self.folder / "quick.toml"
        path.write_text(QUICK_TOML, encoding="utf-8")
        return replace(self, scenario_name=str(path))

    @property
    def scenario(self) -> Scenario:
        """The scenario, loaded."""
        return load(self.scenario_name)

    def count(self, full: int, quick: int) -> int:
        """Number of repetitions."""
        return quick if self.quick else full


def median(samples: Sequence[float]) -> float:
    """Median."""
    return float(np.median(samples))


def p99(samples: Sequence[float]) -> float:
    """99th percentile, linear interpolation."""
    return float(np.percentile(samples, 99))


def spread_of(samples: Sequence[float], *percents: float) -> dict[str, float]:
    """The smallest sample, percentiles under their usual names (``p99.9``), and the largest sample."""
    found = {f"p{percent:g}": float(np.percentile(samples, percent)) for percent in percents}
    return {"min": min(samples)} | found | {"max": max(samples)}


def cpu_ns(setting: Setting, *functions: Callable[[], object], calls: int = 500, blocks: int = 60) -> list[float]:
    """CPU time of a call of each function in ns, best of ``blocks`` blocks of ``calls`` calls.

    The best block counts, because a disturbance can only increase the time. The functions alternate, so that a busy
    period affects all of them.
    """
    timers = [timeit.Timer(function, timer=process_time) for function in functions]
    number = setting.count(calls, min(calls, 20))
    blocks_s = [[timer.timeit(number) for timer in timers] for _ in range(setting.count(blocks, 3))]
    return [min(taken_s) / number * 1e9 for taken_s in zip(*blocks_s, strict=True)]
