"""What the paper says about its results, and what it comes to here."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.common.digits import percent
from railhil.reproduce.ilc import names, published
from railhil.reproduce.ilc.bands import ACCEPTANCE, BARS, Band
from railhil.reproduce.ilc.names import (
    CONVERGED,
    CYCLES_MS,
    EPSILON_M,
    EPSILONS_M,
    MEAN,
    PAPER_CASE,
    RMS,
    WITHIN_10,
    WITHIN_30,
    epsilon_key,
    filter_key,
    of_all,
    of_last,
    of_run,
    scatter_key,
)
from railhil.reproduce.paper import FOLLOWS, FOLLOWS_NOT, IN_PART, OPEN, Results, Statement, checked, least, order

#: One is better than another only if its mean error is this much less.
_MARGIN = 0.1
_NONE = filter_key(names.NONE)
#: Ours with learning: title, entry, entry and figure without it.
_LEARNED = (
    ("with balises", names.OURS, names.OURS_FIXED, of_all(RMS)),
    ("without", names.NO_BALISES, names.NO_BALISES, of_run(RMS, 1)),
    ("with 15 % loss below 2 m/s", names.LOSS, names.LOSS_FIXED, of_all(RMS)),
)


def statements(results: Results) -> list[Statement]:
    """All statements, in the order of the paper."""
    return [
        checked(results, _figure_6(results), [PAPER_CASE]),
        checked(results, _limit(results), [PAPER_CASE]),
        checked(results, _best_epsilon(results), _epsilon_keys(True) + _epsilon_keys(False)),
        checked(results, _epsilon_and_cycle(results), _epsilon_keys(False)),
        checked(results, _filter(results), [PAPER_CASE, _NONE]),
        checked(results, _best_filter(results), [filter_key(name) for name in names.FILTERS]),
        checked(results, _window(results), [names.WINDOW]),
        checked(results, _scatter(results), [scatter_key(0.01), scatter_key(0.01, names.NONE)]),
        checked(results, _learning(results), [key for _, *both, _ in _LEARNED for key in both]),
        _bands(results, "section 8: the acceptance list above.", ACCEPTANCE),
        _bands(results, "the bars of ours above.", BARS),
    ]


def _epsilon_keys(learned: bool) -> list[str]:
    return [epsilon_key(one, cycle_ms, learned=learned) for cycle_ms in CYCLES_MS for one in EPSILONS_M]


def _shown(value: float | None, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _percent(value: float | None) -> str:
    return "-" if value is None else percent(value, 0)


def _figure_6(results: Results) -> Statement:
    number = published.ITERATIONS
    error = results.value(PAPER_CASE, of_run(MEAN, number))
    later = results.value(PAPER_CASE, of_last(MEAN))
    shares = [results.value(PAPER_CASE, of_run(WITHIN_10, one)) for one in (number, names.RUNS)]

    def near(value: float | None) -> bool:
        return value is not None and value <= 1.5 * published.ERROR_M

    return Statement(
        "Figure 6",
        f"the error is least at iteration {number}, {published.ERROR_M:g} m.",
        f"mean error {_shown(error)} m in run {number} ({_percent(shares[0])} of the sequences within 0.1 m), "
        f"{_shown(later)} m in the last 5 runs ({_percent(shares[1])} within 0.1 m in run {names.RUNS}).",
        FOLLOWS if near(error) else IN_PART if near(later) else FOLLOWS_NOT,
        "One sequence, as the paper has it, can come to 0.1 m in any run from the fifth on.",
    )


def _limit(results: Results) -> Statement:
    runs = results.value(PAPER_CASE, CONVERGED)
    share = results.value(PAPER_CASE, of_last(WITHIN_30))
    held = runs is not None and runs <= published.ITERATIONS + 1
    return Statement(
        "Conclusion",
        f"about {published.ITERATIONS} iterations bring the error within {published.LIMIT_M:g} m.",
        f"three runs in a row within it from run {_shown(runs, 0)} on (median); {_percent(share)} of the last 5 runs.",
        FOLLOWS if held else FOLLOWS_NOT,
        "The brake of this scenario repeats itself exactly, as the paper's seems to.",
    )


def _is_best(results: Results, keys: Sequence[str], name: str) -> bool:
    """Whether the first of the entries has the least error, by a margin."""
    own, *others = (results.value(key, name) for key in keys)
    return own is not None and all(other is not None and own < (1.0 - _MARGIN) * other for other in others)


def _best_epsilon(results: Results) -> Statement:
    tolerances = [EPSILON_M, *(one for one in EPSILONS_M if one != EPSILON_M)]
    best, said = [], []
    for learned in (True, False):
        for cycle_ms in CYCLES_MS:
            keys = [epsilon_key(one, cycle_ms, learned=learned) for one in tolerances]
            name = of_last(MEAN) if learned else of_all(MEAN)
            best.append(_is_best(results, keys, name))
            errors = ", ".join(
                _shown(results.value(epsilon_key(one, cycle_ms, learned=learned), name)) for one in EPSILONS_M
            )
            said.append(f"{'learned' if learned else 'not learned'}, {cycle_ms} ms: {errors} m")
    return Statement(
        "Table 2",
        f"eps = {EPSILON_M:g} m suits best.",
        f"mean errors with {', '.join(f'{one:g}' for one in EPSILONS_M)} m, {'; '.join(said)}.",
        FOLLOWS if all(best[:2]) else IN_PART if any(best) else FOLLOWS_NOT,
        "Not reproducible as a law: what is learned takes up eps. Better: by a tenth.",
    )


def _epsilon_and_cycle(results: Results) -> Statement:
    found = []
    for cycle_ms in CYCLES_MS:
        errors = {
            f"{one:g}": results.value(epsilon_key(one, cycle_ms, learned=False), of_all(MEAN)) for one in EPSILONS_M
        }
        found.append(least(errors))
    return Statement(
        "Sect. on the starting point of braking",
        "eps depends on the sampling period.",
        f"without learning the best of the four is {found[0]} m in cycles of {CYCLES_MS[0]} ms and {found[1]} m in "
        f"cycles of {CYCLES_MS[1]} ms.",
        FOLLOWS if (found[0], found[1]) == ("0.2", "0.4") else FOLLOWS_NOT,
        "Half the way of a cycle: 0.13 m and 0.40 m.",
    )


def _filter(results: Results) -> Statement:
    (error, runs), (bare, bare_runs) = (
        [results.value(key, name) for name in (of_last(MEAN), CONVERGED)] for key in (PAPER_CASE, _NONE)
    )
    less = error is not None and bare is not None and error < bare
    fewer = runs is not None and (bare_runs is None or runs < bare_runs)
    return Statement(
        "Table 3",
        "the filter reduces the error (0.24 to 0.11 m) and the iterations (8 to 5).",
        f"mean error {_shown(bare)} to {_shown(error)} m, runs {_shown(bare_runs, 0)} to {_shown(runs, 0)} (median).",
        FOLLOWS if less and fewer else IN_PART if less or fewer else FOLLOWS_NOT,
        "On a brake that repeats itself exactly.",
    )


def _best_filter(results: Results) -> Statement:
    errors = {name: results.value(filter_key(name), of_last(MEAN)) for name in names.FILTERS}
    said = ", ".join(f"{name} {_shown(errors[name])}" for name in order(errors))
    keys = [PAPER_CASE, *(key for name in names.FILTERS if (key := filter_key(name)) != PAPER_CASE)]
    return Statement(
        "Sect. on the filter",
        "the wavelet packet is the filter to use, among FIR, IIR and others.",
        f"mean errors in m, {said}.",
        FOLLOWS if _is_best(results, keys, of_last(MEAN)) else FOLLOWS_NOT,
        "Keeping one node of the packet is a linear low pass, and others have less delay.",
    )


def _window(results: Results) -> Statement:
    share = results.value(names.WINDOW, names.NOT_STOPPED)
    return Statement(
        "Eq. (7)",
        "the train brakes when |s - f| is at most eps.",
        f"with eps = 0.1 m, {_percent(share)} of the trains never brake by themselves.",
        FOLLOWS if share == 0 else FOLLOWS_NOT,
        "A train passes 0.27 m in a cycle of 16 ms and can jump over the window of 0.2 m; the law here brakes when the "
        "margin is at most eps.",
    )


def _scatter(results: Results) -> Statement:
    error, bare = (results.value(scatter_key(0.01, name), of_last(MEAN)) for name in (names.PACKET, names.NONE))
    held = error is not None and bare is not None and error <= published.LIMIT_M
    return Statement(
        "Conclusion",
        "the method meets what is needed in practice.",
        f"with a brake whose gain differs by 1 % from run to run the mean error is {_shown(error, 2)} m with the "
        f"filter and {_shown(bare, 2)} m without.",
        FOLLOWS if held else FOLLOWS_NOT,
        "A single command cannot correct what does not repeat; ours aims anew until it stops.",
    )


def _learning(results: Results) -> Statement:
    less, said = [], []
    for title, key, before, name in _LEARNED:
        first, last = results.value(before, name), results.value(key, of_last(RMS))
        less.append(first is not None and last is not None and last < first)
        said.append(f"{title} {_shown(first, 4)} to {_shown(last, 4)} m")
    return Statement(
        "railhil's specification",
        "learning on the aim point makes ours better.",
        f"rms, {', '.join(said)}.",
        FOLLOWS if all(less) else IN_PART if any(less) else FOLLOWS_NOT,
        "It can only correct what repeats.",
    )


def _bands(results: Results, claim: str, bands: Sequence[Band]) -> Statement:
    made = [band for band in bands if band.is_measured(results)]
    held = [band.holds(results) for band in made]
    missed = [
        f"{band.what}, allowed {band.text}: {_shown(band.value(results), band.digits)}"
        for band, holds in zip(made, held, strict=True)
        if not holds
    ]
    said = f"{sum(held)} of {len(made)} hold{f' ({len(bands) - len(made)} not made)' if len(made) < len(bands) else ''}"
    verdict = OPEN if len(made) < len(bands) else FOLLOWS if all(held) else IN_PART if any(held) else FOLLOWS_NOT
    return Statement(
        "railhil's specification", claim, f"{said}; not: {'; '.join(missed)}." if missed else f"{said}.", verdict
    )
