"""The picture of one run: speed over distance, tracking error and notch over time."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from bus.telegrams import NotchCmd, SimTruth
from scenarios.model import Scenario
from scenarios.target import Target
from supervisor.score import limits_under_train
from supervisor.trace import Trace

_KMH = 3.6


def draw(scenario: Scenario, trace: Trace, out: Path) -> None:
    """Draw the run into a file whose bytes depend on the record alone (fixed ids, no date)."""
    time_s = trace.times_s(SimTruth.PORT)
    position_m = trace.values(SimTruth.PORT, "TruePos")
    speed_kmh = trace.values(SimTruth.PORT, "TrueSpeed") * _KMH
    target = Target(scenario.target)
    planned_s = np.linspace(0.0, scenario.plan.running_time_s, 800)
    wanted_kmh = np.maximum(np.asarray(target.speed_mps(time_s)), 0.0) * _KMH
    limit_kmh = limits_under_train(scenario.line.speed_limit_mps, position_m, scenario.train.length_m) * _KMH

    with mpl.rc_context({"svg.hashsalt": "railhil", "svg.fonttype": "path", "font.size": 9}):
        figure = Figure(figsize=(8.5, 7.0), layout="constrained")
        track, error, notch = figure.subplots(3, 1, height_ratios=(2.2, 1, 1))
        track.plot(position_m, limit_kmh, color="0.3", linestyle=":", label="speed limit")
        track.plot(
            np.asarray(target.position_m(planned_s)),
            np.asarray(target.speed_mps(planned_s)) * _KMH,
            color="0.55",
            linestyle="--",
            label="target",
        )
        track.plot(position_m, speed_kmh, color="C0", label="train")
        track.set(xlabel="position (m)", ylabel="speed (km/h)", title=scenario.title)
        track.set_ylim(bottom=0)
        track.legend(loc="lower center", ncols=3, frameon=False)
        error.plot(time_s, wanted_kmh - speed_kmh, color="C3", linewidth=0.8)
        error.axhline(0, color="0.7", linewidth=0.6)
        error.set(ylabel="speed error\n(km/h)")
        notch_s = trace.times_s(NotchCmd.PORT)
        notch.step(notch_s, trace.values(NotchCmd.PORT, "NotchCmd"), where="post", color="C2", linewidth=0.8)
        notch.axhline(0, color="0.7", linewidth=0.6)
        notch.set(xlabel="time (s)", ylabel="notch")
        for axes in (track, error, notch):
            axes.grid(color="0.9", linewidth=0.5)
            axes.spines[["top", "right"]].set_visible(False)
        figure.align_ylabels([track, error, notch])
        metadata = {"Date": None} if out.suffix == ".svg" else None
        figure.savefig(out, metadata=metadata)
