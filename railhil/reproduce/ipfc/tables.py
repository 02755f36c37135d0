"""Tables 1 and 2, the improvements that the text reads from Table 2, and figures 8 and 9 in numbers."""

from __future__ import annotations

from collections.abc import Iterator

from railhil.judge.criteria import ATO_CRITERIA, Criterion
from railhil.judge.measures import KMH
from railhil.reproduce.ipfc.runs import ARITHMETICS, CHATTER, RMS_ERROR, WIDEST_ERROR, laws, middle, scenario
from railhil.reproduce.paper import Line, Results, Table

#: Table 1, as printed.
_MASS_T, _LIMIT_KMH, _DISTANCE_M, _TIME_S = 211.0, 78.0, 2940.0, 195.0
STOP_ERROR_MAX_M, TIME_ERROR_MAX_S = 0.2, 0.3
#: Sect. 4.5: by how many percent IPFC is better than these laws, as the text says.
_BETTER = {
    "energy_kj": (5.0, 7.8),
    "punctuality_s": (62.9, 84.5),
    "stop_error_m": (58.8, 69.7),
    "comfort": (33.7, 36.9),
    "itae": (49.0, 55.1),
}
#: The laws that the paper calls widely used.
IN_USE = ("tdmc", "fuzzy_pid")
#: Printed percentages have one decimal.
_ROUNDING = 0.1


def tables(results: Results) -> list[Table]:
    """All tables."""
    return [_given(), _scores(results), _improvements(results), _errors(results)]


def published(law: str, key: str) -> float | None:
    """A value of Table 2."""
    return next(row.values.get(key) for row in scenario().published if row.controller == law)


def _given() -> Table:
    plan, train = scenario().plan, scenario().train
    chosen = "the scenario has a limit of its own, by which the runs are judged"
    rows = (
        ("mass", "t", _MASS_T, train.mass_kg / 1e3, 0),
        ("speed limit", "km/h", _LIMIT_KMH, train.speed_limit_mps * KMH, 0),
        ("distance", "m", _DISTANCE_M, plan.distance_m, 0),
        ("running time", "s", _TIME_S, plan.running_time_s, 0),
        ("stop error, at most", "m", STOP_ERROR_MAX_M, plan.stop_error_max_m, 1),
        ("time error, at most", "s", TIME_ERROR_MAX_S, plan.time_error_max_s, 1),
    )
    lines = (
        Line("", name, unit, digits, printed, (value,), remark="" if round(value, 6) == printed else chosen)
        for name, unit, printed, value, digits in rows
    )
    return Table("table_1", "Table 1: the run", ("scenario",), tuple(lines))


def _scores(results: Results) -> Table:
    lines = (_score(results, criterion, law) for criterion in ATO_CRITERIA for law in laws())
    note = (
        "The paper gives no unit of ITAE; the remark has the measured one in m/s in place of km/h. Its heading of the "
        "stop error prints s. Time and stop error without sign."
    )
    return Table("table_2", "Table 2: the five laws", ARITHMETICS, tuple(lines), note)


def _score(results: Results, criterion: Criterion, law: str) -> Line:
    measured = tuple(middle(results, law, arithmetic, criterion.key) for arithmetic in ARITHMETICS)
    remark = ""
    if criterion.key == "itae" and (last := measured[-1]) is not None:
        remark = f"{last / KMH:.0f} with m/s"
    return Line(
        law, criterion.title, criterion.unit, criterion.digits, published(law, criterion.key), measured,
        criterion.published_digits, remark,
    )  # fmt: skip


def better_percent(results: Results, arithmetic: str, key: str, other: str) -> float | None:
    """By how many percent a score of IPFC is less than that of another law."""
    return _percent_less(*(middle(results, law, arithmetic, key) for law in ("ipfc", other)))


def _percent_less(value: float | None, other: float | None) -> float | None:
    return None if value is None or not other else 100 * (1 - value / other)


def _improvements(results: Results) -> Table:
    return Table(
        "improvements", "Improvement of IPFC over the laws in use (sect. 4.5)", ARITHMETICS,
        tuple(_improvement_lines(results)),
        "In percent of the other law's value; negative: IPFC is worse. The abstract's \"more than 55 %\" is the stop "
        "and time error.", with_ratio=False,
    )  # fmt: skip


def _improvement_lines(results: Results) -> Iterator[Line]:
    for criterion in ATO_CRITERIA:
        for other, printed in zip(IN_USE, _BETTER[criterion.key], strict=True):
            own = _percent_less(published("ipfc", criterion.key), published(other, criterion.key))
            measured = tuple(better_percent(results, arithmetic, criterion.key, other) for arithmetic in ARITHMETICS)
            assert own is not None
            remark = f"its own Table 2 gives {own:.1f}" if abs(own - printed) > _ROUNDING else ""
            yield Line(f"over {other}", criterion.title, "%", 1, printed, measured, remark=remark)


def _errors(results: Results) -> Table:
    names = (("speed error, RMS", RMS_ERROR), ("speed error, largest", WIDEST_ERROR), ("chatter", CHATTER))
    lines = (
        Line(law, title, "km/h", 3, None, tuple(middle(results, law, arithmetic, name) for arithmetic in ARITHMETICS))
        for title, name in names
        for law in laws()
    )
    note = (
        "The paper prints curves and no numbers. Error: set-point minus true speed, until the end of the timetable. "
        "Chatter: root mean square of its change from one control period to the next."
    )
    return Table("figure_8_numbers", "Figures 7 and 8 in numbers", ARITHMETICS, tuple(lines), note)
