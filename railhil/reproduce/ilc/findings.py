"""Figure 6 and tables 2 and 3 of the paper, and tables of railhil's specification; statements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import fsum
from typing import Any

from railhil.common.digits import percent
from railhil.controller_node.stop.filters import taps
from railhil.reproduce.comparison import (
    Line,
    Statement,
    Table,
    bounded_line,
    check_bounds,
    divide,
    find_least,
    is_less,
    rank_names,
    render,
)
from railhil.reproduce.ilc.memory_faults import (
    DETECTED,
    ERROR,
    FAULTS,
    RECOVERED,
    RECOVERED_P90,
    SEEN,
    WORST,
    WORST_AT_ONCE,
    name_fault_figure,
)
from railhil.reproduce.ilc.runs import (
    CONVERGED,
    CONVERGED_P90,
    FIGURES,
    MEAN,
    MEMORY,
    NO_FILTER,
    NOT_STOPPED,
    PAPER_CASE,
    RMS,
    RUNS,
    TEXT,
    WITHIN_10,
    WITHIN_30,
    is_learned,
    name_last_figure,
    name_run_figure,
    name_whole_figure,
)
from railhil.reproduce.paper import Results

PRINTED = TEXT.published
_BENCH = ("bench",)
_RUNS_TITLE = "runs until converged"
#: A law is better than another only if its mean error is this much less.
_MARGIN = 0.1
#: Tolerances of table 2, m, and the entries of each reading in their order.
EPSILONS_M, READINGS = (0.2, 0.4, 0.6, 0.8), TEXT.tables["table_2"]["entries"]
_LAST_MEAN, _LAST_RMS, _LAST_WITHIN = name_last_figure(MEAN), name_last_figure(RMS), name_last_figure(WITHIN_30)
#: Ours with learning: title, entry, entry and figure without it.
_LEARNED = (
    ("with balises", "reaim-learned", "reaim-observer-balises", name_whole_figure(RMS)),
    ("without", "reaim-no-balises-learned", "reaim-no-balises-learned", name_run_figure(RMS, 1)),
    ("with 15 % loss below 2 m/s", "reaim-loss-learned", "reaim-loss", name_whole_figure(RMS)),
)


def _find_scaled(results: Results, key: str, name: str, unit: str) -> float | None:
    """A figure, shares in percent."""
    value = results.find(key, name)
    return None if value is None else 100 * value if unit == "%" else value


def find_mean_errors(results: Results, reading: str) -> list[float | None]:
    """Mean error of each tolerance of table 2, m: of the last runs where something is learned, else of all."""
    return [results.find(key, _LAST_MEAN if is_learned(key) else name_whole_figure(MEAN)) for key in READINGS[reading]]


def compare(results: Results) -> list[Table]:
    """All tables."""
    return [
        TEXT.table("figure_6", list(list_entries("figure_6")), _make_figure_6_lines(results), with_ratio=False),
        TEXT.table("table_2", list(READINGS), _make_table_2_lines(results), with_ratio=False),
        TEXT.table("table_3", _BENCH, _make_table_3_lines(results)),
        *(
            TEXT.table(name, list(list_entries(name)), _make_entry_lines(results, list(list_entries(name).values())))
            for name in ("filters", "gains", "scatter")
        ),
        TEXT.table("ours", ("run 1", "last 5 of 15 runs", "all runs"), _make_closed_lines(results)),
        TEXT.table("bars", _BENCH, _make_bound_lines(results, "bars")),
        TEXT.table("memory", _BENCH, _make_memory_lines(results)),
        TEXT.table("acceptance", _BENCH, _make_bound_lines(results, "acceptance")),
    ]


def list_entries(table: str) -> Mapping[str, str]:
    """The entries of a table by their titles there."""
    found: Mapping[str, str] = TEXT.tables[table]["entries"]
    return found


def _make_bound_lines(results: Results, name: str) -> Iterator[Line]:
    for one in TEXT.bounds[name]:
        needs = [one[key] for key in ("entry", "by") if key in one]
        yield bounded_line(
            one["item"], one["at"], one["unit"], one["digits"], (one.get("least"), one.get("most")),
            (_find_bounded(results, one),), unmade="" if results.has(needs) else "not made",
        )  # fmt: skip


def _find_bounded(results: Results, one: Mapping[str, Any]) -> float | None:
    """The figure of a bound."""
    figure = one["figure"]
    if figure == "noise_power":
        # Share of the power of white noise that the packet lets pass, from the weights that the law has.
        return fsum(weight * weight for weight in taps("packet_symmetric_63"))
    if one["entry"] == MEMORY:
        # The worst of the faults that can be detected.
        values = [_find_scaled(results, MEMORY, name_fault_figure(fault, figure), one["unit"]) for fault in DETECTED]
        known = [value for value in values if value is not None]
        worst = min if "least" in one else max
        return worst(known) if len(known) == len(values) else None
    value = _find_scaled(results, one["entry"], figure, one["unit"])
    return divide(value, results.find(one["by"], one.get("by_figure", figure))) if "by" in one else value


def _make_figure_6_lines(results: Results) -> Iterator[Line]:
    for figure in (MEAN, WITHIN_10, WITHIN_30):
        title, unit, digits = FIGURES[figure]
        for number in range(1, RUNS + 1):
            is_printed = figure == MEAN and number == PRINTED["iterations"]
            keys = list_entries("figure_6").values()
            found = tuple(_find_scaled(results, key, name_run_figure(figure, number), unit) for key in keys)
            yield Line(f"run {number}", title, unit, digits, PRINTED["error_m"] if is_printed else None, found, 1)


def _make_table_2_lines(results: Results) -> Iterator[Line]:
    printed = {float(epsilon_m): pair for epsilon_m, pair in PRINTED["table_2"].items()}
    columns = [find_mean_errors(results, reading) for reading in READINGS]
    for epsilon_m, *found in zip(EPSILONS_M, *columns, strict=True):
        value = printed[epsilon_m][0] if epsilon_m in printed else None
        yield Line(f"eps {epsilon_m:g} m", "mean error", "m", 3, value, tuple(found), 1)
    for epsilon_m, *keys in zip(EPSILONS_M, *READINGS.values(), strict=True):
        value = float(printed[epsilon_m][1]) if epsilon_m in printed else None
        needed = tuple(results.find(key, CONVERGED) if is_learned(key) else None for key in keys)
        yield Line(f"eps {epsilon_m:g} m", _RUNS_TITLE, "", 0, value, needed, 0)


def _make_table_3_lines(results: Results) -> Iterator[Line]:
    for place, (title, figure, unit, digits) in enumerate(
        (("mean error", _LAST_MEAN, "m", 3), (_RUNS_TITLE, CONVERGED, "", 0))
    ):
        for name, key in (("none", NO_FILTER), ("packet", PAPER_CASE)):
            printed, found = float(PRINTED["table_3"][name][place]), results.find(key, figure)
            yield Line(name, title, unit, digits, printed, (found,), 0 if place else 2)


def _make_entry_lines(results: Results, keys: Sequence[str]) -> Iterator[Line]:
    """Figures after learning, a column for each entry."""
    for figure, (title, unit, digits) in FIGURES.items():
        found = tuple(_find_scaled(results, key, name_last_figure(figure), unit) for key in keys)
        yield Line("", title, unit, digits, None, found)
    for title, figure in (("median", CONVERGED), ("90 %", CONVERGED_P90)):
        found = tuple(results.find(key, figure) for key in keys)
        yield Line("", f"{_RUNS_TITLE}, {title}", "", 0, None, found)


def _make_closed_lines(results: Results) -> Iterator[Line]:
    for figure in (RMS, WITHIN_10, WITHIN_30):
        title, unit, digits = FIGURES[figure]
        for item, key in list_entries("ours").items():
            first = _find_scaled(results, key, name_run_figure(figure, 1), unit)
            name = name_last_figure(figure) if is_learned(key) else name_whole_figure(figure)
            later = _find_scaled(results, key, name, unit)
            found = (first, later, None) if is_learned(key) else (first, None, later)
            yield Line(item, title, unit, digits if unit == "%" else 4, None, found)


def _make_memory_lines(results: Results) -> Iterator[Line]:
    for title, figure, unit, digits in (
        ("mean error of the next run, overshoot positive", ERROR, "m", 2),
        ("largest error of the next run", WORST_AT_ONCE, "m", 2),
        ("largest error of ten runs", WORST, "m", 2),
        ("runs until recovered, median", RECOVERED, "", 0),
        ("runs until recovered, 90 %", RECOVERED_P90, "", 0),
        ("the law has seen it", SEEN, "%", 0),
    ):
        for fault in FAULTS:
            found = _find_scaled(results, MEMORY, name_fault_figure(fault, figure), unit)
            yield Line(fault, title, unit, digits, None, (found,))


def judge(results: Results) -> list[Statement]:
    """All statements, in the order of the paper."""
    return [
        _judge_figure_6(results),
        _judge_limit(results),
        _judge_best_epsilon(results),
        _judge_epsilon_and_cycle(results),
        _judge_filter(results),
        _judge_best_filter(results),
        _judge_window(results),
        _judge_scatter(results),
        _judge_learning(results),
        *(
            TEXT.judge(name, results, [], *check_bounds(list(_make_bound_lines(results, name)), lambda line: line.item))
            for name in ("acceptance", "bars")
        ),
    ]


def _format_percent(value: float | None) -> str:
    return "-" if value is None else percent(value, 0)


def _is_best(errors: Mapping[str, float | None], name: str) -> bool:
    """Whether one has the least error, by a margin."""
    own = errors[name]
    others = [error for other, error in errors.items() if other != name]
    return own is not None and all(is_less(own, None if error is None else (1 - _MARGIN) * error) for error in others)


def _judge_figure_6(results: Results) -> Statement:
    number = PRINTED["iterations"]
    error, later = (results.find(PAPER_CASE, name) for name in (name_run_figure(MEAN, number), _LAST_MEAN))
    shares = [_format_percent(results.find(PAPER_CASE, name_run_figure(WITHIN_10, one))) for one in (number, RUNS)]
    near, near_later = (value is not None and value <= 1.5 * PRINTED["error_m"] for value in (error, later))
    said = (
        f"mean error {render(error, 3)} m in run {number} ({shares[0]} of the sequences within 0.1 m), "
        f"{render(later, 3)} m in the last 5 runs ({shares[1]} within 0.1 m in run {RUNS})."
    )
    return TEXT.judge("figure_6", results, [PAPER_CASE], said, [near, near or near_later])


def _judge_limit(results: Results) -> Statement:
    needed, share = results.find(PAPER_CASE, CONVERGED), results.find(PAPER_CASE, _LAST_WITHIN)
    held = needed is not None and needed <= PRINTED["iterations"] + 1
    first = render(needed, 0)
    said = f"three runs in a row within it from run {first} on (median); {_format_percent(share)} of the last 5 runs."
    return TEXT.judge("limit", results, [PAPER_CASE], said, [held])


def _name_errors(results: Results, reading: str) -> dict[str, float | None]:
    """Mean errors by their tolerance in words."""
    names = [f"{epsilon_m:g}" for epsilon_m in EPSILONS_M]
    return dict(zip(names, find_mean_errors(results, reading), strict=True))


def _judge_best_epsilon(results: Results) -> Statement:
    errors = {reading: _name_errors(results, reading) for reading in READINGS}
    best = [_is_best(one, "0.4") for one in errors.values()]
    said = "; ".join(
        f"{reading}: {', '.join(render(error, 3) for error in one.values())} m" for reading, one in errors.items()
    )
    text = f"mean errors with {', '.join(f'{one:g}' for one in EPSILONS_M)} m, {said}."
    needs = [key for keys in READINGS.values() for key in keys]
    return TEXT.judge("best_epsilon", results, needs, text, [all(best[:2]), any(best)])


def _judge_epsilon_and_cycle(results: Results) -> Statement:
    fixed = {cycle: f"not learned, {cycle}" for cycle in ("16 ms", "48 ms")}
    found = {cycle: find_least(_name_errors(results, reading)) for cycle, reading in fixed.items()}
    said = " and ".join(f"{best} m in cycles of {cycle}" for cycle, best in found.items())
    text = f"without learning the best of the four is {said}."
    needs = [key for reading in fixed.values() for key in READINGS[reading]]
    return TEXT.judge("epsilon_and_cycle", results, needs, text, [list(found.values()) == ["0.2", "0.4"]])


def _judge_filter(results: Results) -> Statement:
    error, bare = (results.find(key, _LAST_MEAN) for key in (PAPER_CASE, NO_FILTER))
    needed, bare_needed = (results.find(key, CONVERGED) for key in (PAPER_CASE, NO_FILTER))
    fewer = needed is not None and (bare_needed is None or needed < bare_needed)
    said = (
        f"mean error {render(bare, 3)} to {render(error, 3)} m, "
        f"runs {render(bare_needed, 0)} to {render(needed, 0)} (median)."
    )
    return TEXT.judge("filter", results, [PAPER_CASE, NO_FILTER], said, [is_less(error, bare), fewer])


def _judge_best_filter(results: Results) -> Statement:
    filters = list_entries("filters")
    errors = {name: results.find(key, _LAST_MEAN) for name, key in filters.items()}
    said = ", ".join(f"{name} {render(errors[name], 3)}" for name in rank_names(errors))
    holds = [_is_best(errors, "packet")]
    return TEXT.judge("best_filter", results, filters.values(), f"mean errors in m, {said}.", holds)


def _judge_window(results: Results) -> Statement:
    key = "window-0.1"
    share = results.find(key, NOT_STOPPED)
    said = f"with eps = 0.1 m, {_format_percent(share)} of the trains never brake by themselves."
    return TEXT.judge("window", results, [key], said, [share == 0])


def _judge_scatter(results: Results) -> Statement:
    keys = ["scatter-0.01", "scatter-0.01-none"]
    error, bare = (results.find(key, _LAST_MEAN) for key in keys)
    held = error is not None and bare is not None and error <= PRINTED["limit_m"]
    said = (
        f"with a brake whose gain differs by 1 % from run to run the mean error is {render(error, 2)} m with the "
        f"filter and {render(bare, 2)} m without."
    )
    return TEXT.judge("scatter", results, keys, said, [held])


def _judge_learning(results: Results) -> Statement:
    less, said = [], []
    for title, key, before, name in _LEARNED:
        first, last = results.find(before, name), results.find(key, _LAST_RMS)
        less.append(is_less(last, first))
        said.append(f"{title} {render(first, 4)} to {render(last, 4)} m")
    needs = [key for _, *both, _ in _LEARNED for key in both]
    return TEXT.judge("learning", results, needs, f"rms, {', '.join(said)}.", less)
