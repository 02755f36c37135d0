"""Figure 6 and tables 2 and 3 of the paper, and tables of railhil's specification; bands; statements."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from railhil.common.digits import percent
from railhil.controller_node.stop.filters import taps
from railhil.reproduce.comparison import (
    Band,
    Finding,
    Line,
    Table,
    check_bands,
    decimal,
    is_less,
    least,
    order,
    quotient,
)
from railhil.reproduce.ilc import runs
from railhil.reproduce.ilc.memory_faults import (
    DETECTED,
    ERROR,
    FAULTS,
    RECOVERED,
    RECOVERED_P90,
    SEEN,
    WORST,
    WORST_AT_ONCE,
    fault_figure,
)
from railhil.reproduce.ilc.runs import (
    CONVERGED,
    CONVERGED_P90,
    CYCLES_MS,
    EPSILON_M,
    EPSILONS_M,
    FIGURES,
    MEAN,
    PAPER_CASE,
    RMS,
    TEXT,
    WITHIN_10,
    WITHIN_30,
    epsilon_key,
    filter_key,
    gamma_key,
    of_all,
    of_last,
    of_run,
    scatter_key,
)
from railhil.reproduce.paper import Results

PRINTED = TEXT.published
_BENCH = ("bench",)
_RUNS_TITLE = "runs until converged"
_NONE = filter_key(runs.NONE)
#: A law is better than another only if its mean error is this much less.
_MARGIN = 0.1
#: The trains with scatter: title, key, whether something is learned.
_CLOSED = (
    ("paper's law, nothing learned", runs.OPEN_FIXED, False),
    ("paper's law, offset learned", runs.OPEN_LEARNED, True),
    ("re-aim", runs.REAIM, False),
    ("re-aim, balises", runs.REAIM_BALISES, False),
    ("re-aim, observer", runs.REAIM_OBSERVER, False),
    ("re-aim, observer, balises", runs.OURS_FIXED, False),
    ("re-aim, observer, balises, learned", runs.OURS, True),
    ("re-aim, observer, learned, no balises on the line", runs.NO_BALISES, True),
    ("15 % loss below 2 m/s", runs.LOSS_FIXED, False),
    ("15 % loss below 2 m/s, learned", runs.LOSS, True),
    ("slides in 10 % of the runs, learned", runs.SLIDE, True),
)
#: Ours with learning: title, entry, entry and figure without it.
_LEARNED = (
    ("with balises", runs.OURS, runs.OURS_FIXED, of_all(RMS)),
    ("without", runs.NO_BALISES, runs.NO_BALISES, of_run(RMS, 1)),
    ("with 15 % loss below 2 m/s", runs.LOSS, runs.LOSS_FIXED, of_all(RMS)),
)
#: The four readings of table 2: whether something is learned, cycle of the controller, title.
READINGS = tuple(
    (learned, cycle_ms, f"{'learned' if learned else 'not learned'}, {cycle_ms} ms")
    for learned in (True, False)
    for cycle_ms in CYCLES_MS
)


def find_mean_errors(results: Results, learned: bool, cycle_ms: int) -> dict[float, float | None]:
    """Mean error of each tolerance of table 2, m: of the last runs where something is learned, else of all."""
    name = of_last(MEAN) if learned else of_all(MEAN)
    return {one: results.value(epsilon_key(one, cycle_ms, learned=learned), name) for one in EPSILONS_M}


def _find_scaled(results: Results, key: str, name: str, unit: str) -> float | None:
    """A figure, shares in percent."""
    value = results.value(key, name)
    return None if value is None else 100 * value if unit == "%" else value


def _make_band(
    at: str, what: str, unit: str, digits: int, bounds: tuple[float | None, float | None], key: str, name: str,
    by: tuple[str, str] | None = None,
) -> Band:  # fmt: skip
    """Bounds of a figure of an entry, or of its quotient by another.

    :param by: entry and name of the divisor.
    """

    def measured(results: Results) -> tuple[float | None]:
        if by is not None:
            return (quotient(results.value(key, name), results.value(*by)),)
        return (_find_scaled(results, key, name, unit),)

    needs = [key] if by is None else [key, by[0]]
    return Band(at, what, unit, digits, *bounds, lambda results: needs, measured)


def _make_memory_band(
    what: str, unit: str, bounds: tuple[float | None, float | None], name: str, worst: Callable[[list[float]], float]
) -> Band:
    """Bounds of a figure of the fault that is the worst in it, of those that can be detected."""

    def measured(results: Results) -> tuple[float | None]:
        values = [_find_scaled(results, runs.MEMORY, fault_figure(fault, name), unit) for fault in DETECTED]
        known = [value for value in values if value is not None]
        return (worst(known) if len(known) == len(values) else None,)

    return Band("7", what, unit, 0, *bounds, lambda results: [runs.MEMORY], measured)


def _compute_noise_power(results: Results) -> tuple[float]:
    """Share of the power of white noise that the packet lets pass, from the weights that the law has."""
    return (sum(weight * weight for weight in taps("packet_symmetric_63")),)


_LAST_MEAN, _LAST_RMS, _LAST_WITHIN = of_last(MEAN), of_last(RMS), of_last(WITHIN_30)
#: Section 8 of railhil's specification.
ACCEPTANCE = (
    Band("1", "packet, noise power", "", 4, 0.12, 0.13, lambda results: [], _compute_noise_power),
    _make_band("3", "packet, mean error", "m", 3, (0.10, 0.15), PAPER_CASE, _LAST_MEAN),
    _make_band("3", "packet, within 0.3 m", "%", 1, (90.0, None), PAPER_CASE, _LAST_WITHIN),
    _make_band("3", "packet, runs, median", "", 0, (4.0, 6.0), PAPER_CASE, CONVERGED),
    _make_band("3", "no filter, mean error", "m", 3, (0.18, 0.26), _NONE, _LAST_MEAN),
    _make_band(
        "3", "mean error without filter by that with it", "", 2, (1.4, None), _NONE, _LAST_MEAN,
        (PAPER_CASE, _LAST_MEAN),
    ),
    _make_band(
        "4", "rms with gamma 1.5 by that with 0.5", "", 2, (1.6, 2.2), gamma_key(1.5), _LAST_RMS,
        (PAPER_CASE, _LAST_RMS),
    ),
    # The clamps keep it from growing without bound.
    _make_band("4", "gamma 2 must not converge: within 0.3 m", "%", 1, (None, 1.0), gamma_key(2.0), _LAST_WITHIN),
    _make_band("5", "gain 1 % from run to run, mean error", "m", 2, (1.5, 2.0), scatter_key(0.01), _LAST_MEAN),
    _make_band("6", "re-aim, observer, balises: rms", "m", 3, (None, 0.08), runs.OURS_FIXED, of_all(RMS)),
    _make_memory_band("memory faults that are seen", "%", (100.0, None), SEEN, min),
    _make_memory_band("runs until recovered, median, slowest fault", "", (None, 5.0), RECOVERED, max),
)  # fmt: skip
#: Bars of ours.
BARS = (
    _make_band("run 1", "observer, balises: rms", "m", 4, (None, 0.05), runs.OURS, of_run(RMS, 1)),
    _make_band("learned", "observer, balises: rms", "m", 4, (None, 0.026), runs.OURS, _LAST_RMS),
    _make_band("learned", "without balises: rms", "m", 4, (None, 0.066), runs.NO_BALISES, _LAST_RMS),
    _make_band("learned", "15 % loss below 2 m/s: rms", "m", 4, (None, 0.035), runs.LOSS, _LAST_RMS),
    _make_band(
        "learned", "10 % slide runs: rms of the others by that without slides", "", 2, (None, 1.2), runs.SLIDE,
        runs.LAST_RMS_HELD, (runs.OURS, _LAST_RMS),
    ),
)  # fmt: skip


def compare(results: Results) -> list[Table]:
    """All tables."""
    filters = {name: filter_key(name) for name in runs.FILTERS}
    gains = {f"{gamma:g}" if gamma else "max(1/j, 0.3)": gamma_key(gamma) for gamma in runs.GAMMAS}
    scatters = {"0": PAPER_CASE, **{f"{100 * sigma:g} %": scatter_key(sigma) for sigma in runs.SCATTERS}}
    scatters["1 %, no filter"] = scatter_key(0.01, runs.NONE)
    readings = [title for _, _, title in READINGS]
    return [
        TEXT.table("figure_6", ("packet", "no filter"), _make_figure_6_lines(results), with_ratio=False),
        TEXT.table("table_2", readings, _make_table_2_lines(results), with_ratio=False),
        TEXT.table("table_3", _BENCH, _make_table_3_lines(results)),
        *(
            TEXT.table(name, list(keys), _make_entry_lines(results, list(keys.values())))
            for name, keys in (("filters", filters), ("gains", gains), ("scatter", scatters))
        ),
        TEXT.table("ours", ("run 1", "last 5 of 15 runs", "all runs"), _make_closed_lines(results)),
        TEXT.table("bars", _BENCH, (band.line(results) for band in BARS)),
        TEXT.table("memory", _BENCH, _make_memory_lines(results)),
        TEXT.table("acceptance", _BENCH, (band.line(results) for band in ACCEPTANCE)),
    ]


def _make_figure_6_lines(results: Results) -> Iterator[Line]:
    for figure in (MEAN, WITHIN_10, WITHIN_30):
        title, unit, digits = FIGURES[figure]
        for number in range(1, runs.RUNS + 1):
            is_printed = figure == MEAN and number == PRINTED["iterations"]
            found = tuple(_find_scaled(results, key, of_run(figure, number), unit) for key in (PAPER_CASE, _NONE))
            yield Line(f"run {number}", title, unit, digits, PRINTED["error_m"] if is_printed else None, found, 1)


def _make_table_2_lines(results: Results) -> Iterator[Line]:
    columns = [find_mean_errors(results, learned, cycle_ms) for learned, cycle_ms, _ in READINGS]
    for epsilon_m in EPSILONS_M:
        printed = PRINTED["table_2"].get(f"{epsilon_m:g}", [None])[0]
        found = tuple(column[epsilon_m] for column in columns)
        yield Line(f"eps {epsilon_m:g} m", "mean error", "m", 3, printed, found, 1)
    for epsilon_m in EPSILONS_M:
        printed = PRINTED["table_2"].get(f"{epsilon_m:g}", [None])[-1]
        found = tuple(
            results.value(epsilon_key(epsilon_m, cycle_ms, learned=True), CONVERGED) if learned else None
            for learned, cycle_ms, _ in READINGS
        )
        value = None if printed is None else float(printed)
        yield Line(f"eps {epsilon_m:g} m", _RUNS_TITLE, "", 0, value, found, 0)


def _make_table_3_lines(results: Results) -> Iterator[Line]:
    for place, (title, figure, unit, digits) in enumerate(
        (("mean error", _LAST_MEAN, "m", 3), (_RUNS_TITLE, CONVERGED, "", 0))
    ):
        for name in (runs.NONE, runs.PACKET):
            printed, found = float(PRINTED["table_3"][name][place]), results.value(filter_key(name), figure)
            yield Line(name, title, unit, digits, printed, (found,), 0 if place else 2)


def _make_entry_lines(results: Results, keys: Sequence[str]) -> Iterator[Line]:
    """Figures after learning, a column for each entry."""
    for figure, (title, unit, digits) in FIGURES.items():
        found = tuple(_find_scaled(results, key, of_last(figure), unit) for key in keys)
        yield Line("", title, unit, digits, None, found)
    for title, figure in (("median", CONVERGED), ("90 %", CONVERGED_P90)):
        found = tuple(results.value(key, figure) for key in keys)
        yield Line("", f"{_RUNS_TITLE}, {title}", "", 0, None, found)


def _make_closed_lines(results: Results) -> Iterator[Line]:
    for figure in (RMS, WITHIN_10, WITHIN_30):
        title, unit, digits = FIGURES[figure]
        for item, key, learned in _CLOSED:
            first = _find_scaled(results, key, of_run(figure, 1), unit)
            later = _find_scaled(results, key, (of_last if learned else of_all)(figure), unit)
            found = (first, later, None) if learned else (first, None, later)
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
            found = _find_scaled(results, runs.MEMORY, fault_figure(fault, figure), unit)
            yield Line(fault, title, unit, digits, None, (found,))


def check(results: Results) -> Iterator[Finding]:
    """All findings, in the order of the paper."""
    yield _check_figure_6(results)
    yield _check_limit(results)
    yield _check_best_epsilon(results)
    yield _check_epsilon_and_cycle(results)
    yield _check_filter(results)
    yield _check_best_filter(results)
    yield _check_window(results)
    yield _check_scatter(results)
    yield _check_learning(results)
    for name, bands in (("acceptance", ACCEPTANCE), ("bars", BARS)):
        yield check_bands(name, results, bands, lambda band: f"{band.what}, {band.limits}")


def _list_epsilon_keys(learned: bool) -> list[str]:
    return [epsilon_key(one, cycle_ms, learned=learned) for cycle_ms in CYCLES_MS for one in EPSILONS_M]


def _format_percent(value: float | None) -> str:
    return "-" if value is None else percent(value, 0)


def _is_best(errors: Mapping[str, float | None], name: str) -> bool:
    """Whether one has the least error, by a margin."""
    own = errors[name]
    others = [error for other, error in errors.items() if other != name]
    return own is not None and all(is_less(own, None if error is None else (1 - _MARGIN) * error) for error in others)


def _check_figure_6(results: Results) -> Finding:
    number = PRINTED["iterations"]
    error, later = (results.value(PAPER_CASE, name) for name in (of_run(MEAN, number), _LAST_MEAN))
    shares = [_format_percent(results.value(PAPER_CASE, of_run(WITHIN_10, one))) for one in (number, runs.RUNS)]
    near, near_later = (value is not None and value <= 1.5 * PRINTED["error_m"] for value in (error, later))
    said = (
        f"mean error {decimal(error, 3)} m in run {number} ({shares[0]} of the sequences within 0.1 m), "
        f"{decimal(later, 3)} m in the last 5 runs ({shares[1]} within 0.1 m in run {runs.RUNS})."
    )
    return Finding("figure_6", said, [near, near or near_later], [PAPER_CASE])


def _check_limit(results: Results) -> Finding:
    needed, share = results.value(PAPER_CASE, CONVERGED), results.value(PAPER_CASE, _LAST_WITHIN)
    held = needed is not None and needed <= PRINTED["iterations"] + 1
    first = decimal(needed, 0)
    said = f"three runs in a row within it from run {first} on (median); {_format_percent(share)} of the last 5 runs."
    return Finding("limit", said, [held], [PAPER_CASE])


def _check_best_epsilon(results: Results) -> Finding:
    best, said = [], []
    for learned, cycle_ms, title in READINGS:
        errors = {f"{one:g}": error for one, error in find_mean_errors(results, learned, cycle_ms).items()}
        best.append(_is_best(errors, f"{EPSILON_M:g}"))
        said.append(f"{title}: {', '.join(decimal(error, 3) for error in errors.values())} m")
    text = f"mean errors with {', '.join(f'{one:g}' for one in EPSILONS_M)} m, {'; '.join(said)}."
    return Finding(
        "best_epsilon",
        text,
        [all(best[:2]), any(best)],
        _list_epsilon_keys(learned=True) + _list_epsilon_keys(learned=False),
    )


def _check_epsilon_and_cycle(results: Results) -> Finding:
    found = []
    for cycle_ms in CYCLES_MS:
        errors = find_mean_errors(results, learned=False, cycle_ms=cycle_ms)
        found.append(least({f"{one:g}": error for one, error in errors.items()}))
    said = (
        f"without learning the best of the four is {found[0]} m in cycles of {CYCLES_MS[0]} ms and {found[1]} m in "
        f"cycles of {CYCLES_MS[1]} ms."
    )
    return Finding("epsilon_and_cycle", said, [found == ["0.2", "0.4"]], _list_epsilon_keys(learned=False))


def _check_filter(results: Results) -> Finding:
    error, bare = (results.value(key, _LAST_MEAN) for key in (PAPER_CASE, _NONE))
    needed, bare_needed = (results.value(key, CONVERGED) for key in (PAPER_CASE, _NONE))
    fewer = needed is not None and (bare_needed is None or needed < bare_needed)
    said = (
        f"mean error {decimal(bare, 3)} to {decimal(error, 3)} m, "
        f"runs {decimal(bare_needed, 0)} to {decimal(needed, 0)} (median)."
    )
    return Finding("filter", said, [is_less(error, bare), fewer], [PAPER_CASE, _NONE])


def _check_best_filter(results: Results) -> Finding:
    errors = {name: results.value(filter_key(name), _LAST_MEAN) for name in runs.FILTERS}
    said = ", ".join(f"{name} {decimal(errors[name], 3)}" for name in order(errors))
    keys = [filter_key(name) for name in runs.FILTERS]
    return Finding("best_filter", f"mean errors in m, {said}.", [_is_best(errors, runs.PACKET)], keys)


def _check_window(results: Results) -> Finding:
    share = results.value(runs.WINDOW, runs.NOT_STOPPED)
    said = f"with eps = 0.1 m, {_format_percent(share)} of the trains never brake by themselves."
    return Finding("window", said, [share == 0], [runs.WINDOW])


def _check_scatter(results: Results) -> Finding:
    keys = [scatter_key(0.01, name) for name in (runs.PACKET, runs.NONE)]
    error, bare = (results.value(key, _LAST_MEAN) for key in keys)
    held = error is not None and bare is not None and error <= PRINTED["limit_m"]
    said = (
        f"with a brake whose gain differs by 1 % from run to run the mean error is {decimal(error, 2)} m with the "
        f"filter and {decimal(bare, 2)} m without."
    )
    return Finding("scatter", said, [held], keys)


def _check_learning(results: Results) -> Finding:
    less, said = [], []
    for title, key, before, name in _LEARNED:
        first, last = results.value(before, name), results.value(key, _LAST_RMS)
        less.append(is_less(last, first))
        said.append(f"{title} {decimal(first, 4)} to {decimal(last, 4)} m")
    return Finding("learning", f"rms, {', '.join(said)}.", less, [key for _, *both, _ in _LEARNED for key in both])
