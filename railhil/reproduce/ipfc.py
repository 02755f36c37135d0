"""The paper of IPFC: Tables 1 and 2 and figures 6 to 9, measured on the published scenario.

Protocol: the five laws of the paper on its scenario. Statements and figures are about the controller's fixed point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from math import fsum

import numpy as np

from railhil.charts.figure import Figure
from railhil.common.digits import percent
from railhil.library import Outcome
from railhil.report.styles import styles
from railhil.reproduce.comparison import Line, Statement, Table, divide, find_least, rank_names, render
from railhil.reproduce.paper import Entry, Paper, Results, read_text
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato import panels
from railhil.systems.ato.judge.criteria import CRITERIA, STOP_ERROR, TIME_ERROR
from railhil.systems.ato.judge.curves import Curves
from railhil.systems.ato.judge.curves import curves as recorded_curves
from railhil.systems.ato.judge.judging import deviations
from railhil.systems.ato.judge.measures import KMH
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
TEXT = replace(read_text("ipfc"), source=deviations()[0], readings=deviations()[1])
#: What the paper prints.
PRINTED = TEXT.published
#: Percentage by which IPFC is better than each law in use, by score.
_BETTER = PRINTED["better_percent"]
#: The laws that the paper calls widely used.
_IN_USE = ("tdmc", "fuzzy_pid")
#: Printed percentages have one decimal.
_ROUNDING = 0.1
#: Largest errors of Table 1 by score, m and s.
_LIMITS = {STOP_ERROR: PRINTED["stop_error_max_m"], TIME_ERROR: PRINTED["time_error_max_s"]}


@cache
def load_scenario() -> Scenario:
    """The scenario of every run."""
    return load(SCENARIO)


@cache
def list_laws() -> tuple[str, ...]:
    """The laws of Table 2 in its order."""
    return tuple(row.controller for row in load_scenario().published)


def name_run(law: str, arithmetic: str, seed: int) -> str:
    """Name of a run."""
    return f"{law}-{arithmetic}-{seed}"


def find_median(results: Results, law: str, arithmetic: str, name: str) -> float | None:
    """A figure of a law: the median over the seeds, which is the figure itself for one seed."""
    return results.reduce([name_run(law, arithmetic, seed) for seed in results.seeds], name)


def plan(seeds: Sequence[int]) -> list[Entry]:
    """Every law in every arithmetic with every seed."""
    return [
        Entry(
            name_run(law, arithmetic, seed),
            RunSpec(SCENARIO, law=LawSpec(law, arithmetic), seed=seed, bus="local"),
            drawn=arithmetic == USUAL and seed == seeds[0],
        )
        for seed in seeds
        for arithmetic in ARITHMETICS
        for law in list_laws()
    ]


def curves(outcome: Outcome) -> panels.Drawn:
    """The curves of a run in the figures, in the style of its law."""
    law = str(outcome.certificate["controller"])
    style = styles(list_laws())[list_laws().index(law)]
    return panels.Drawn(law, style, _curves(outcome), outcome.score)


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


def find_printed(law: str, name: str) -> float | None:
    """A value of Table 2."""
    return next(row.values.get(name) for row in load_scenario().published if row.controller == law)


def compare(results: Results) -> list[Table]:
    """Tables 1 and 2, the improvements that the text reads from Table 2, and figures 7 and 8 in numbers."""
    return [
        TEXT.table("table_1", ("scenario",), _make_given_lines()),
        TEXT.table("table_2", ARITHMETICS, _make_score_lines(results)),
        TEXT.table("improvements", ARITHMETICS, _make_improvement_lines(results), with_ratio=False),
        TEXT.table("figure_8_numbers", ARITHMETICS, _make_error_lines(results)),
    ]


def _make_given_lines() -> Iterator[Line]:
    plan, train = load_scenario().plan, load_scenario().train
    chosen = "the scenario has a limit of its own, by which the runs are judged"
    for title, unit, name, value, digits in (
        ("mass", "t", "mass_t", train.mass_kg / 1e3, 0),
        ("speed limit", "km/h", "speed_limit_kmh", train.speed_limit_mps * KMH, 0),
        ("distance", "m", "distance_m", plan.distance_m, 0),
        ("running time", "s", "running_time_s", plan.running_time_s, 0),
        ("stop error, at most", "m", "stop_error_max_m", plan.stop_error_max_m, 1),
        ("time error, at most", "s", "time_error_max_s", plan.time_error_max_s, 1),
    ):
        remark = "" if round(value, 6) == PRINTED[name] else chosen
        yield Line("", title, unit, digits, PRINTED[name], (value,), remark=remark)


def _find_medians(results: Results, law: str, name: str) -> tuple[float | None, ...]:
    return tuple(find_median(results, law, arithmetic, name) for arithmetic in ARITHMETICS)


def _make_score_lines(results: Results) -> Iterator[Line]:
    for criterion in CRITERIA:
        for law in list_laws():
            measured = _find_medians(results, law, criterion.key)
            last = measured[-1]
            remark = f"{last / KMH:.0f} with m/s" if criterion.key == "itae" and last is not None else ""
            yield Line(
                law, criterion.title, criterion.unit, criterion.digits, find_printed(law, criterion.key), measured,
                criterion.published_digits, remark,
            )  # fmt: skip


def compute_improvement(results: Results, arithmetic: str, name: str, other: str) -> float | None:
    """Percentage by which a score of IPFC is less than another law's."""
    return _compute_reduction(*(find_median(results, law, arithmetic, name) for law in ("ipfc", other)))


def _compute_reduction(value: float | None, other: float | None) -> float | None:
    share = divide(value, other)
    return None if share is None else 100 * (1 - share)


def _make_improvement_lines(results: Results) -> Iterator[Line]:
    for criterion in CRITERIA:
        for other in _IN_USE:
            printed = _BETTER[criterion.key][other]
            own = _compute_reduction(find_printed("ipfc", criterion.key), find_printed(other, criterion.key))
            measured = tuple(
                compute_improvement(results, arithmetic, criterion.key, other) for arithmetic in ARITHMETICS
            )
            assert own is not None
            remark = f"its own Table 2 gives {own:.1f}" if abs(own - printed) > _ROUNDING else ""
            yield Line(f"over {other}", criterion.title, "%", 1, printed, measured, remark=remark)


def _make_error_lines(results: Results) -> Iterator[Line]:
    names = (("speed error, RMS", RMS_ERROR), ("speed error, largest", WIDEST_ERROR), ("chatter", CHATTER))
    for title, name in names:
        for law in list_laws():
            yield Line(law, title, "km/h", 3, None, _find_medians(results, law, name))


def judge(results: Results) -> list[Statement]:
    """All statements, in the order of the paper."""
    return [
        _judge_adaptation(results),
        *_judge_orders(results),
        _judge_improvement(results),
        _judge_comfort(results),
        _judge_limits(results),
        *_judge_curves(results),
    ]


def _own_runs(results: Results) -> list[str]:
    return [name_run("ipfc", USUAL, seed) for seed in results.seeds]


def _all_runs(results: Results) -> list[str]:
    return [name_run(law, USUAL, seed) for law in list_laws() for seed in results.seeds]


def _find_values(results: Results, name: str) -> dict[str, float | None]:
    return {law: find_median(results, law, USUAL, name) for law in list_laws()}


def _rank_laws(values: dict[str, float | None], shown: Callable[[float | None], str]) -> str:
    """The laws from the best to the worst with their figures."""
    return ", ".join(f"{law} {shown(values[law])}" for law in rank_names(values))


def _judge_orders(results: Results) -> Iterator[Statement]:
    """Each column of Table 2 has the same order of the laws."""
    for criterion in CRITERIA:
        values = _find_values(results, criterion.key)
        # Two laws without a value have no order.
        known = sum(value is not None for value in values.values()) >= len(values) - 1
        same = known and rank_names(values) == rank_names(
            {law: find_printed(law, criterion.key) for law in list_laws()}
        )
        name = f"order_{criterion.title.lower().replace(' ', '_')}"
        said = f"{_rank_laws(values, criterion.shown)}."
        yield TEXT.judge(name, results, _all_runs(results), said, [same], is_explained=not same)


def _judge_improvement(results: Results) -> Statement:
    """The sentence of the abstract on the laws in use."""
    better = {
        law: [c.title for c in CRITERIA if (compute_improvement(results, USUAL, c.key, law) or 0.0) > 0]
        for law in _IN_USE
    }
    text = "; ".join(
        f"than {law} in {len(found)} of {len(CRITERIA)} columns ({', '.join(found)})" for law, found in better.items()
    )
    counts = [len(found) for found in better.values()]
    holds = [min(counts) == len(CRITERIA), any(counts)]
    said = f"better {text}; by how much: in the table above."
    return TEXT.judge("improvement", results, _all_runs(results), said, holds)


def _judge_adaptation(results: Results) -> Statement:
    share = find_median(results, "ipfc", USUAL, ADAPTED) or 0.0
    text = f"the satisfaction is above 0 in {percent(share)} of the controller's reports."
    holds = [] if share > 0 else [False]
    return TEXT.judge("adaptation", results, _own_runs(results), text, holds, is_explained=share <= 0)


def _judge_comfort(results: Results) -> Statement:
    comfort = next(criterion for criterion in CRITERIA if criterion.key == "comfort")
    printed, value = find_printed("ipfc", "comfort"), find_median(results, "ipfc", USUAL, "comfort")
    assert printed is not None
    reached = value is not None and value > printed / 2
    text = f"{comfort.shown(value)} {comfort.unit}{f', {printed / value:.1f} times less' if value else ''}."
    holds = [] if reached else [False]
    return TEXT.judge("comfort", results, _own_runs(results), text, holds, is_explained=not reached)


def _judge_limits(results: Results) -> Statement:
    missed = {law: ", ".join(_find_missed(results, law)) for law in list_laws()}
    late = [f"{law}: {text}" for law, text in missed.items() if text]
    said = f"outside are {'; '.join(late)}." if late else "so does every law."
    return TEXT.judge("limits", results, _all_runs(results), said, [not late])


def _find_missed(results: Results, law: str) -> Iterator[str]:
    for criterion, limit in _LIMITS.items():
        value = find_median(results, law, USUAL, criterion.key)
        if value is None or value > limit:
            yield f"{criterion.title} {criterion.shown(value)} {criterion.unit}"


def _judge_curves(results: Results) -> Iterator[Statement]:
    """Statements that the text reads from figures 7 to 9."""

    def show(value: float | None) -> str:
        return "-" if value is None else f"{render(value, 3)} km/h"

    for name, figure, title in (("following", RMS_ERROR, "speed error, RMS"), ("chatter", CHATTER, "chatter")):
        values = _find_values(results, figure)
        said = f"{title}: {_rank_laws(values, show)}."
        yield TEXT.judge(name, results, _all_runs(results), said, [find_least(values) == "ipfc"])
    distances = {law: _compute_distance(results, law) for law in list_laws()}
    stops = _find_values(results, STOP_ERROR.key)
    text = ", ".join(f"{law} {STOP_ERROR.shown(stops[law])} m" for law in rank_names(distances))
    said = f"in the order of the distance in units of Table 1's limits: {text}."
    yield TEXT.judge("stop", results, _all_runs(results), said, [find_least(distances) == "ipfc"])


def _compute_distance(results: Results, law: str) -> float | None:
    """Distance of the stop from its target in time and place, in units of the limits of Table 1."""
    shares = [divide(find_median(results, law, USUAL, one.key), limit) for one, limit in _LIMITS.items()]
    known = [share for share in shares if share is not None]
    return fsum(share**2 for share in known) ** 0.5 if len(known) == len(shares) else None


def draw(results: Results) -> list[Figure]:
    """Figures 6 to 9 in the style of the report, of the first seed; none if none of its runs was made."""
    keys = results.list_made(name_run(law, USUAL, results.seeds[0]) for law in list_laws())
    drawn = [results.runs[one].curves for one in keys if results.runs[one].curves is not None]
    if not drawn:
        return []
    # The curves of the paper's figure 6 cannot be read from its text.
    charts = [panels.speed_over_distance(load_scenario(), []), panels.grade(load_scenario())]
    caption = "Grades and target curve are chosen: the paper has them only as a picture. The limit is that of Table 1."
    figures = {
        6: Figure("figure_6", "Grade and speed limit", caption, charts),
        7: panels.speed(load_scenario(), drawn),
        8: panels.error(load_scenario(), drawn),
        9: panels.stop(load_scenario(), drawn),
    }
    return [
        replace(one, name=f"figure_{number}", title=f"Figure {number}: {one.title[:1].lower()}{one.title[1:]}")
        for number, one in figures.items()
    ]


PAPER = Paper("ipfc", TEXT, plan, measure, compare, judge, draw, curves)
