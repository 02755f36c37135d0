"""Tables, statements and figures of the paper; statements and figures are about the controller's fixed point."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from railhil.common.digits import percent
from railhil.judge.criteria import ATO_CRITERIA, STOP_ERROR, TIME_ERROR
from railhil.judge.measures import KMH
from railhil.reproduce.comparison import Finding, Line, Table, decimal, least, order, quotient
from railhil.reproduce.ipfc.runs import (
    ADAPTED,
    ARITHMETICS,
    CHATTER,
    PRINTED,
    RMS_ERROR,
    TEXT,
    USUAL,
    WIDEST_ERROR,
    Drawable,
    key,
    laws,
    middle,
    scenario,
)
from railhil.reproduce.paper import Results

if TYPE_CHECKING:
    from railhil.report.pictures import Picture

#: By how many percent IPFC is better than each law in use, by score.
_BETTER = PRINTED["better_percent"]
#: The laws that the paper calls widely used.
_IN_USE = ("tdmc", "fuzzy_pid")
#: Printed percentages have one decimal.
_ROUNDING = 0.1
#: Largest errors of Table 1 by score, m and s.
_LIMITS = {STOP_ERROR: PRINTED["stop_error_max_m"], TIME_ERROR: PRINTED["time_error_max_s"]}


def printed_score(law: str, name: str) -> float | None:
    """A value of Table 2."""
    return next(row.values.get(name) for row in scenario().published if row.controller == law)


def compare(results: Results) -> list[Table]:
    """Tables 1 and 2, the improvements that the text reads from Table 2, and figures 7 and 8 in numbers."""
    return [
        TEXT.table("table_1", ("scenario",), _given_lines()),
        TEXT.table("table_2", ARITHMETICS, _score_lines(results)),
        TEXT.table("improvements", ARITHMETICS, _improvement_lines(results), with_ratio=False),
        TEXT.table("figure_8_numbers", ARITHMETICS, _error_lines(results)),
    ]


def _given_lines() -> Iterator[Line]:
    plan, train = scenario().plan, scenario().train
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


def _in_each(results: Results, law: str, name: str) -> tuple[float | None, ...]:
    return tuple(middle(results, law, arithmetic, name) for arithmetic in ARITHMETICS)


def _score_lines(results: Results) -> Iterator[Line]:
    for criterion in ATO_CRITERIA:
        for law in laws():
            measured = _in_each(results, law, criterion.key)
            last = measured[-1]
            remark = f"{last / KMH:.0f} with m/s" if criterion.key == "itae" and last is not None else ""
            yield Line(
                law, criterion.title, criterion.unit, criterion.digits, printed_score(law, criterion.key), measured,
                criterion.published_digits, remark,
            )  # fmt: skip


def better_percent(results: Results, arithmetic: str, name: str, other: str) -> float | None:
    """By how many percent a score of IPFC is less than that of another law."""
    return _percent_less(*(middle(results, law, arithmetic, name) for law in ("ipfc", other)))


def _percent_less(value: float | None, other: float | None) -> float | None:
    share = quotient(value, other)
    return None if share is None else 100 * (1 - share)


def _improvement_lines(results: Results) -> Iterator[Line]:
    for criterion in ATO_CRITERIA:
        for other in _IN_USE:
            printed = _BETTER[criterion.key][other]
            own = _percent_less(printed_score("ipfc", criterion.key), printed_score(other, criterion.key))
            measured = tuple(better_percent(results, arithmetic, criterion.key, other) for arithmetic in ARITHMETICS)
            assert own is not None
            remark = f"its own Table 2 gives {own:.1f}" if abs(own - printed) > _ROUNDING else ""
            yield Line(f"over {other}", criterion.title, "%", 1, printed, measured, remark=remark)


def _error_lines(results: Results) -> Iterator[Line]:
    names = (("speed error, RMS", RMS_ERROR), ("speed error, largest", WIDEST_ERROR), ("chatter", CHATTER))
    for title, name in names:
        for law in laws():
            yield Line(law, title, "km/h", 3, None, _in_each(results, law, name))


def check(results: Results) -> Iterator[Finding]:
    """All findings, in the order of the paper."""
    own = [key("ipfc", USUAL, seed) for seed in results.seeds]
    every = [key(law, USUAL, seed) for law in laws() for seed in results.seeds]
    yield replace(_adaptation(results), needs=own)
    yield from (replace(one, needs=every) for one in (*_orders(results), _improvement(results)))
    yield replace(_comfort(results), needs=own)
    yield from (replace(one, needs=every) for one in (_limits(results), *_curve_findings(results)))


def _measured(results: Results, name: str) -> dict[str, float | None]:
    return {law: middle(results, law, USUAL, name) for law in laws()}


def _ranking(values: dict[str, float | None], shown: Callable[[float | None], str]) -> str:
    """The laws from the best to the worst with their figures."""
    return ", ".join(f"{law} {shown(values[law])}" for law in order(values))


def _orders(results: Results) -> Iterator[Finding]:
    """Each column of Table 2 has the same order of the laws."""
    for criterion in ATO_CRITERIA:
        values = _measured(results, criterion.key)
        # Two laws without a value have no order.
        known = sum(value is not None for value in values.values()) >= len(values) - 1
        same = known and order(values) == order({law: printed_score(law, criterion.key) for law in laws()})
        name = f"order_{criterion.title.lower().replace(' ', '_')}"
        yield Finding(name, f"{_ranking(values, criterion.shown)}.", [same], is_explained=not same)


def _improvement(results: Results) -> Finding:
    """The sentence of the abstract on the laws in use."""
    better = {
        law: [c.title for c in ATO_CRITERIA if (better_percent(results, USUAL, c.key, law) or 0.0) > 0]
        for law in _IN_USE
    }
    text = "; ".join(
        f"than {law} in {len(found)} of {len(ATO_CRITERIA)} columns ({', '.join(found)})"
        for law, found in better.items()
    )
    counts = [len(found) for found in better.values()]
    holds = [min(counts) == len(ATO_CRITERIA), any(counts)]
    return Finding("improvement", f"better {text}; by how much: in the table above.", holds)


def _adaptation(results: Results) -> Finding:
    share = middle(results, "ipfc", USUAL, ADAPTED) or 0.0
    text = f"the satisfaction is above 0 in {percent(share)} of the controller's reports."
    return Finding("adaptation", text, () if share > 0 else [False], is_explained=share <= 0)


def _comfort(results: Results) -> Finding:
    comfort = next(criterion for criterion in ATO_CRITERIA if criterion.key == "comfort")
    printed, value = printed_score("ipfc", "comfort"), middle(results, "ipfc", USUAL, "comfort")
    assert printed is not None
    reached = value is not None and value > printed / 2
    text = f"{comfort.shown(value)} {comfort.unit}{f', {printed / value:.1f} times less' if value else ''}."
    return Finding("comfort", text, () if reached else [False], is_explained=not reached)


def _limits(results: Results) -> Finding:
    missed = {law: ", ".join(_missed(results, law)) for law in laws()}
    late = [f"{law}: {text}" for law, text in missed.items() if text]
    return Finding("limits", f"outside are {'; '.join(late)}." if late else "so does every law.", [not late])


def _missed(results: Results, law: str) -> Iterator[str]:
    for criterion, limit in _LIMITS.items():
        value = middle(results, law, USUAL, criterion.key)
        if value is None or value > limit:
            yield f"{criterion.title} {criterion.shown(value)} {criterion.unit}"


def _curve_findings(results: Results) -> Iterator[Finding]:
    """What the text reads from figures 7 to 9."""

    def shown(value: float | None) -> str:
        return "-" if value is None else f"{decimal(value, 3)} km/h"

    for name, figure, title in (("following", RMS_ERROR, "speed error, RMS"), ("chatter", CHATTER, "chatter")):
        values = _measured(results, figure)
        yield Finding(name, f"{title}: {_ranking(values, shown)}.", [least(values) == "ipfc"])
    distances = {law: _distance(results, law) for law in laws()}
    stops = _measured(results, STOP_ERROR.key)
    text = ", ".join(f"{law} {STOP_ERROR.shown(stops[law])} m" for law in order(distances))
    said = f"in the order of the distance in units of Table 1's limits: {text}."
    yield Finding("stop", said, [least(distances) == "ipfc"])


def _distance(results: Results, law: str) -> float | None:
    """Distance of the stop from its target in time and place, in units of the limits of Table 1."""
    shares = [quotient(middle(results, law, USUAL, one.key), limit) for one, limit in _LIMITS.items()]
    known = [share for share in shares if share is not None]
    return sum(share**2 for share in known) ** 0.5 if len(known) == len(shares) else None


def draw(results: Results) -> Sequence[Picture]:
    """Figures 6 to 9 in the style of the report, of the first seed.

    :raises ImportError: the extra [report] is not installed.
    """
    from railhil.charts.figure import Figure
    from railhil.report.pictures import printed
    from railhil.report.styles import styles
    from railhil.systems.ato import panels as ato_panels

    drawn = []
    for law, style in zip(laws(), styles(laws()), strict=True):
        found = results.runs[key(law, USUAL, results.seeds[0])].curves
        assert isinstance(found, Drawable)
        drawn.append(ato_panels.Drawn(law, style, found.curves, found.score))
    # The curves of the paper's figure 6 cannot be read from its text.
    charts = [ato_panels.speed_over_distance(scenario(), []), ato_panels.grade(scenario())]
    caption = "Grades and target curve are chosen: the paper has them only as a picture. The limit is that of Table 1."
    figures = {
        6: Figure("figure_6", "Grade and speed limit", caption, charts),
        7: ato_panels.speed(scenario(), drawn),
        8: ato_panels.error(scenario(), drawn),
        9: ato_panels.stop(scenario(), drawn),
    }
    return printed(
        [
            replace(one, name=f"figure_{number}", title=f"Figure {number}: {one.title[:1].lower()}{one.title[1:]}")
            for number, one in figures.items()
        ]
    )
