"""``report.html`` of a probability: the levels, the repetitions with the interval, and the causes; a function of the
folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from railhil.batch.decision import decision_figure
from railhil.charts.figure import Area, Chart, Curve, Figure, Look, Point
from railhil.probability.plan import Plan
from railhil.probability.show import lines
from railhil.report.study_page import study_page
from railhil.study.execute import Outcome

_HEIGHT_PX, _BAR_PX = 200, 22
#: Causes with a smaller share have no bar.
_CAUSE_MIN = 0.005


def page(plan: Plan, made: Outcome, recorded: str) -> str:
    """The report as one HTML document; ``recorded`` as in :func:`~railhil.report.study_page.study_page`."""
    summary = made.summary
    decided = (summary["least"] or {}).get("decided")
    first, *told = (line.strip() for line in lines(plan, summary, Path()))
    figures = [
        one
        for one in (_levels(summary), _repetitions(summary), _causes(summary), decision_figure(decided, "decision"))
        if one is not None
    ]
    title = f"Probability on {plan.scenario.title}"
    lead = f"{first}: {plan.requirement.says}"
    return study_page(title, lead, [*told[:-1], *figures], warnings=told[-1:], recorded=recorded)


def _levels(summary: Mapping[str, Any]) -> Figure | None:
    """The probability of a margin below each bound, by sides; None: runs were counted."""
    curves = []
    for side in dict.fromkeys(one["side"] for one in summary["levels"]):
        own = [one for one in summary["levels"] if one["side"] == side and one["share"] > 0]
        exponents = np.cumsum(np.log10([one["share"] for one in own]))
        curves.append(Curve(side, np.array([one["bound"] for one in own]), exponents))
    if not any(len(curve.x) for curve in curves):
        return None
    lowest = int(np.floor(min(float(curve.y.min()) for curve in curves if len(curve.y))))
    names = {float(power): f"1e{power}" if power else "1" for power in range(lowest, 1)}
    caption = "Each level begins with the runs that the one before has reached. Below 0 a run violates the requirement."
    chart = Chart(curves, "margin of the requirement", "probability of a smaller margin", y_bounds=(lowest, 0.0),
                  y_names=names, x_lines={0.0: "violated"}, height_px=_HEIGHT_PX)  # fmt: skip
    return Figure("levels", "Levels", caption, [chart])


def _repetitions(summary: Mapping[str, Any]) -> Figure | None:
    """The estimate of each repetition as a multiple of their mean, with the interval; None: there is none."""
    p, found = summary["p"], summary["repetitions"]
    if not found or not p:
        return None
    look = Look("0", marker="o", is_full=True)
    points = [
        Point("a repetition", number, one / p, look, text=f"repetition {number}: {one:.2g}")
        for number, one in enumerate(found, 1)
    ]
    areas = [Area(None, (1.0, 1.0), "line", f"P = {p:.2g}")]
    if summary["low"] is not None:
        interval = f"{summary['level']:.0%} interval: {summary['low']:.2g} to {summary['high']:.2g}"
        areas.insert(0, Area(None, (summary["low"] / p, summary["high"] / p), "allowed", interval, label=interval))
    most = max(*found, summary["high"] or 0.0) / p
    chart = Chart([], "repetition", "estimate as a multiple of P", (0.0, len(found) + 1.0), (0.0, 1.1 * most), areas,
                  points, height_px=_HEIGHT_PX)  # fmt: skip
    caption = f"The repetitions have other random numbers; their mean is P = {summary['p']:.2g}."
    return Figure("repetitions", "Repetitions", caption, [chart])


def _causes(summary: Mapping[str, Any]) -> Figure | None:
    """Shares of draws and noise in the variance of the margin; None: none is large enough."""
    causes = summary["causes"]
    shares = {name: one["share"] for name, one in causes["draws"].items()} | {"noise": causes["noise"] or 0.0}
    shown = sorted(((name, one) for name, one in shares.items() if one >= _CAUSE_MIN), key=lambda item: -item[1])
    if not shown:
        return None
    bars = [
        Area((0.0, 100 * share), (-place - 0.32, -place + 0.32), "block", f"{name}: {share:.1%}", colour="0")
        for place, (name, share) in enumerate(shown)
    ]
    names = {float(-place): name for place, (name, _) in enumerate(shown)}
    chart = Chart([], "share of the variance (%)", "", (0.0, 100 * max(shares.values()) * 1.05), (0.5 - len(bars), 0.5),
                  bars, y_names=names, height_px=_BAR_PX * len(bars))  # fmt: skip
    caption = "Shares in the variance of the margin over all runs. What they leave is the interplay of draws."
    return Figure("causes", "Causes", caption, [chart])
