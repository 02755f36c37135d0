"""The protocol: the five laws of the paper on its scenario, and the figures that are read from a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from railhil.library import Outcome
from railhil.report.styles import styles
from railhil.reproduce.paper import Entry, Results, read_text
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.judge.curves import Curves
from railhil.systems.ato.judge.curves import curves as recorded_curves
from railhil.systems.ato.judge.judging import deviations
from railhil.systems.ato.panels import Drawn
from railhil.systems.ato.scenario.model import Scenario

SCENARIO = "lvshun_tieshan"
#: The equations in double precision, and the fixed point of the paper's TMS320F28335.
ARITHMETICS = ("float64", "iq")
#: The arithmetic of the figures and of the statements, as in the paper's controller.
USUAL = "iq"
#: Speed error over the run, in km/h: root mean square, largest, and root mean square of its change from one control
#: period to the next.
RMS_ERROR, WIDEST_ERROR, CHATTER = "rms_error_kmh", "widest_error_kmh", "chatter_kmh"
#: Share of the reports of a law with a satisfaction (eq. 26) above 0: only then is its softening factor adapted.
ADAPTED = "adapted_share"
TEXT = replace(read_text(__package__), source=deviations()[0], readings=deviations()[1])
#: What the paper prints.
PRINTED = TEXT.published


@cache
def load_scenario() -> Scenario:
    """The scenario of every run."""
    return load(SCENARIO)


@cache
def list_laws() -> tuple[str, ...]:
    """The laws of Table 2 in its order."""
    return tuple(row.controller for row in load_scenario().published)


def key(law: str, arithmetic: str, seed: int) -> str:
    """Name of a run."""
    return f"{law}-{arithmetic}-{seed}"


def find_median(results: Results, law: str, arithmetic: str, name: str) -> float | None:
    """A figure of a law: the median over the seeds, which is the figure itself for one seed."""
    return results.over([key(law, arithmetic, seed) for seed in results.seeds], name)


def plan(seeds: Sequence[int]) -> list[Entry]:
    """Every law in every arithmetic with every seed."""
    return [
        Entry(
            key(law, arithmetic, seed),
            RunSpec(SCENARIO, law=LawSpec(law, arithmetic), seed=seed, bus="local"),
            drawn=arithmetic == USUAL and seed == seeds[0],
        )
        for seed in seeds
        for arithmetic in ARITHMETICS
        for law in list_laws()
    ]


def curves(outcome: Outcome) -> Drawn:
    """The curves of a run in the figures, in the style of its law."""
    law = str(outcome.certificate["controller"])
    style = styles(list_laws())[list_laws().index(law)]
    return Drawn(law, style, _curves(outcome), outcome.score)


def _curves(outcome: Outcome) -> Curves:
    return recorded_curves(load_scenario(), outcome.trace, outcome.certificate.get("notes"))


def measure(outcome: Outcome) -> dict[str, float | None]:
    """The five scores, and the figures above; :data:`ADAPTED` only of a law that reports a satisfaction."""
    found: dict[str, float | None] = dict(outcome.scores)
    drawn = _curves(outcome)
    until_s = load_scenario().plan.running_time_s
    error_kmh = drawn.error_kmh[drawn.time_s <= until_s]
    period_s = load_scenario().timing.control_period_ns / 1e9
    at_s = np.arange(period_s, until_s + period_s / 2, period_s)
    change_kmh = np.diff(np.interp(at_s, drawn.time_s, drawn.error_kmh))
    found[RMS_ERROR] = float(np.sqrt(np.mean(error_kmh**2)))
    found[WIDEST_ERROR] = float(np.max(np.abs(error_kmh)))
    found[CHATTER] = float(np.sqrt(np.mean(change_kmh**2)))
    shares = [values for note, values in drawn.notes if note.name == "satisfaction"]
    found[ADAPTED] = float(np.mean(shares[0] > 0)) if shares else None
    return found
