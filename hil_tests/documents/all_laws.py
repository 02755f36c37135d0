"""Figures of docs/reference/all_laws.md."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from benchmarks.stopping import floors_m
from hil_tests.documents import figures
from hil_tests.documents.figures import LAWS, LVSHUN, WORN, batch, median, p95, passed, percent, row, within
from hil_tests.documents.laws import constants
from hil_tests.support.paths import ROOT
from railhil.batch.statistics import estimate
from railhil.bench import coupled_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.laws.base import BaliseReading
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec

#: A percentile of 200 runs would not stand well beside one of 10 000.
MANY = range(1000, 11000)
#: Of the noise alone, on the nominal train.
NOISE = range(2000)


def picture() -> Sequence[str]:
    """What the law does in the control period of the picture in which the notch jumps to its limit."""
    arithmetic = make("iq")
    seen: dict[str, float] = {}

    class Noting(type(arithmetic)):  # type: ignore[misc]
        def note(self, name: str, a: int, q: int, unit: str = "") -> int:
            seen[name] = a / 2**q
            return a

        def note_all(self, name: str, values: Sequence[int], q: int, unit: str = "") -> tuple[int, ...]:
            seen.update({f"{name}[{i}]": value / 2**q for i, value in enumerate(values)})
            return tuple(values)

    loop = ControlLoop(load(LVSHUN), LawSpec("ipfc", "iq"), Noting())
    steps: list[tuple[float, dict[str, float]]] = []

    def law(k: int, speed: int, position: int, balise: BaliseReading[int]) -> int:
        _, found = loop.step(k, speed, position, balise)
        steps.append((k * load(LVSHUN).timing.control_period_ns / 1e9, dict(seen)))
        return int(found.notch)

    coupled_run(load(LVSHUN), law)
    # The start of the run, where the set-point is steep as well, is not meant.
    time_s, now = max(steps[len(steps) // 2 :], key=lambda step: step[1]["notch_raw"])
    gains = constants("ipfc", "gains_wavelet")
    deviations = [now[f"d[{i}]"] for i in range(len(gains))]
    raw = now["notch_raw"]
    assert abs(sum(g * d for g, d in zip(gains, deviations, strict=True)) - raw) < 1e-3
    return (
        f"The {now['notch']:+.0f} notch just before",
        f"at {time_s:.1f} s",
        "gains at the four fitting points are {:.1f}, {:.1f}, {:.1f} and {:.1f}.".format(*gains),
        f"still {now['tracking_error']:.1f} km/h too slow",
        "deviations at these points are {:+.1f}, {:+.1f}, {:+.1f} and {:+.1f} km/h".format(*deviations),
        f"of gain times deviation, {raw:+.1f}, is clipped to {now['notch']:+.0f}.",
    )


def noise() -> Sequence[str]:
    """The published law with the paper's parameters: the noise alone, and the perturbed runs."""
    alone, many = batch("ipfc", seeds=NOISE, perturbed=False), batch("ipfc")
    low, high = np.percentile(-alone.signed["stop_error_m"], (1, 99))
    plan = load(LVSHUN).plan
    return (
        f"{low:.2f} to {high:.2f} m short",
        f"98 % of {len(NOISE)} seeds), and {within(alone, 0.3):.0f} % of them within {plan.stop_error_max_m:g} m",
        f"Of the perturbed runs, {within(many, 0.3):.0f} % stop within 0.3 m",
        f"{within(many, 0.2):.0f} % within 0.2 m.",
    )


def laws() -> Sequence[str]:
    """Every law with its own and with tuned parameters."""
    published = {one.controller: one.values for one in load(LVSHUN).published}
    rows = []
    for law in LAWS:
        ours = law.startswith("ipfc_plus")
        for result, name in (
            (batch(law), f"**{law}**" if ours else law),
            (batch(law, file=figures.tuned(law)), f"{law} tuned"),
        ):
            paper = published.get(law) if name == law else None
            rows.append(
                row(
                    name,
                    f"{median(result, 'itae'):.0f}",
                    f"{median(result, 'energy_kj'):.0f}",
                    f"{median(result, 'punctuality_s'):.3f}",
                    f"{median(result, 'stop_error_m'):.3f}, {p95(result, 'stop_error_m'):.3f}",
                    f"{median(result, 'comfort'):.2f}",
                    percent(result),
                    ", ".join(f"{within(result, limit):g}" for limit in (0.1, 0.2, 0.3)) + " %",
                    ""
                    if paper is None
                    else f"{paper['itae']:.0f}, {paper['energy_kj']:.0f}, {paper['punctuality_s']:.3f}, "
                    f"{paper['stop_error_m']:.3f}, {paper['comfort']:.2f}",
                )
            )
    return rows


def worn_wheels() -> Sequence[str]:
    """IPFC+ with and without end phase, IPFC, and what the balises allow, on the same runs."""
    plus, stop = (batch(law, WORN, "float64", seeds=MANY) for law in ("ipfc_plus", "ipfc_plus_stop"))
    ipfc = batch("ipfc", WORN, "float64", seeds=MANY)
    assert passed(plus) == passed(stop) == len(MANY)
    floor = np.abs(floors_m(load(WORN), MANY)[1])
    return (
        f"{len(MANY) // 1000} 000 perturbed runs",
        f"IPFC+ stops within {median(plus, 'stop_error_m'):.3f} m (95 %: {p95(plus, 'stop_error_m'):.3f} m)",
        f"IPFC misses the stopping point by {median(ipfc, 'stop_error_m'):.1f} m",
        f"with its end phase within {median(stop, 'stop_error_m'):.3f} m (95 %: {p95(stop, 'stop_error_m'):.3f} m)",
        f"better than within {estimate(floor, 0.5).value:.3f} m (95 %: {estimate(floor, 0.95).value:.3f} m)",
    )


def high_speed() -> Sequence[str]:
    """From the page that ``railhil reproduce ngpc`` writes."""
    document = json.loads((ROOT / "docs/reproduce/ngpc/results.json").read_text("utf-8"))
    lines = next(table["lines"] for table in document["tables"] if table["name"] == "tracking")
    found = {(line["quantity"], line["item"]): line["measured"]["mean"] for line in lines}
    normal, emergency, mutation = "normal, RMSE", "emergency, RMSE", "mutation, RMSE in the windows"
    three = [f"{found[where, 'delay_gpc']:.3f}" for where in (normal, emergency, mutation)]
    others = [f"`{law}` {found[normal, law]:.3f}" for law in ("elm_ngpc", "mm_gpc", "pid")]
    return (
        "`delay_gpc` {}, {} and {} km/h".format(*three),
        "{}, {}, {} km/h".format(*others),
    )
