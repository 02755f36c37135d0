"""The benchmark "chasing cars": its model is that of the public definition, its sentences say what the formulas say."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hil_tests.documents.pages import blocks_of
from hil_tests.support.paths import ROOT

#: Compiling the model takes some seconds, once.
pytestmark = pytest.mark.slow

pytest.importorskip("numba", reason="MISSING CAPABILITY numba (extra campaign)")
pytest.importorskip("cmaes", reason="MISSING CAPABILITY cmaes (extra campaign)")

from benchmarks import falsification  # noqa: E402
from benchmarks.chasing_cars import SENTENCES, drive, judge, pieces  # noqa: E402

PAGE = "docs/reference/falsification.md"
HZ = 100
INPUTS = [np.random.default_rng(seed).integers(0, 2, 40) * 1.0 for seed in range(12)]


def signals(inputs):
    return drive(pieces(inputs[:20]), pieces(inputs[20:]))


def always(values, first_s, last_s):
    """The least of ``values`` in the window from each sample on, for the samples whose window lies in the run."""
    first, last = round(first_s * HZ), round(last_s * HZ)
    windows = np.lib.stride_tricks.sliding_window_view(values[first:], last - first + 1)
    return windows.min(axis=1)


def eventually(values, first_s, last_s):
    return -always(-values, first_s, last_s)


def formula(name, run):
    """The margin by the definition of signal temporal logic, written without the language of railhil."""
    first, second = run["y2"] - run["y1"], run["y5"] - run["y4"]
    if name == "CC1":
        found = always(40 - second, 0, 100)
    elif name == "CC2":
        found = always(eventually(second - 15, 0, 30), 0, 70)
    elif name == "CC3":
        found = always(np.maximum(always(20 - first, 0, 20), eventually(second - 40, 0, 20)), 0, 80)
    elif name == "CC4":
        found = always(eventually(always(second - 8, 0, 5), 0, 30), 0, 65)
    elif name == "CC5":
        later = always(second - 9, 5, 20)
        found = always(eventually(np.maximum(-always(first - 9, 0, 5)[: len(later)], later), 0, 8), 0, 72)
    else:
        gaps = [run[f"y{car + 1}"] - run[f"y{car}"] - 7.5 for car in range(1, 5)]
        found = np.min([always(gap, 0, 50)[:1] for gap in gaps], axis=0)
    return found[0]


@pytest.mark.parametrize("name", SENTENCES)
def test_each_sentence_has_the_margin_of_the_formula(name):
    judged, found = judge(name), []
    for inputs in INPUTS:
        run = signals(inputs)
        (outcome,) = judged.outcomes(run)
        assert outcome.margin == pytest.approx(formula(name, run), abs=1e-9)
        assert outcome.verdict == ("violated" if outcome.margin < 0 else "kept")
        found.append(outcome.margin)
    assert len(set(found)) > 5


def slope(_, state, pull, drag, modes):
    v = state[5:]
    dy, dv = np.empty(5), np.empty(5)
    dy[0], dv[0] = v[0], -pull - drag * v[0]
    for car, mode in enumerate(modes, 1):
        dy[car], dv[car] = {"chasing": (-v[car], 1), "keeping": (v[car], 0), "braking": (-v[car], -v[car])}[mode]
    return np.concatenate([dy, dv])


def next_mode(mode, gap):
    """The guards of the charts."""
    if mode == "chasing":
        return "keeping" if gap <= 10 else mode
    if mode == "keeping":
        return "chasing" if gap >= 15 else "braking" if gap <= 5 else mode
    return "chasing" if gap >= 20 else mode


@pytest.mark.parametrize("inputs", INPUTS[:2])
def test_the_model_is_the_equations_and_guards_of_the_charts(inputs):
    """20 s of it by a solver of scipy, whose events are the guards."""
    run, modes = signals(inputs), ["keeping"] * 4
    state = np.array([0.0, 10, 20, 30, 40, 0, 0, 0, 0, 0])
    for piece in range(4):
        pull, drag, instant_s = inputs[piece], inputs[20 + piece], 5.0 * piece
        while instant_s < 5 * piece + 5:
            gaps = np.diff(state[:5])
            modes = [next_mode(mode, gap) for mode, gap in zip(modes, gaps, strict=True)]

            def leaves(_, state, pull, drag, modes):
                return -min(
                    {"chasing": gap - 10, "keeping": min(15 - gap, gap - 5), "braking": 20 - gap}[mode]
                    for mode, gap in zip(modes, np.diff(state[:5]), strict=True)
                )

            leaves.terminal, leaves.direction = True, 1
            found = solve_ivp(
                slope, (instant_s, 5 * piece + 5), state, args=(pull, drag, modes), events=leaves, rtol=1e-9, atol=1e-9
            )
            instant_s, state = found.t[-1], found.y[:, -1]
            if found.status == 1:  # a little beyond the guard
                state = state + 1e-7 * slope(0, state, pull, drag, modes)
                instant_s += 1e-7
    for car in range(5):
        assert run[f"y{car + 1}"][20 * HZ] == pytest.approx(state[car], abs=1e-4)


def page_rows():
    """Cells of the rows of the page that begin with a requirement."""
    for block in blocks_of(PAGE, (ROOT / PAGE).read_text("utf-8").splitlines()):
        for line in block.lines if block.kind == "table" else ():
            cells = [cell.strip(" `") for cell in line.strip("|").split("|")]
            if cells[0] in SENTENCES:
                yield cells


def test_the_page_has_what_the_descent_finds():
    """Of two requirements that take few simulations; the others: `python -m benchmarks.falsification`."""
    rows = {cells[0]: cells for cells in page_rows() if len(cells) == 5}
    assert rows.keys() == SENTENCES.keys()
    for name in ("CC1", "CC3"):
        assert falsification.result(name, "descent").cell == rows[name][2]


def test_the_page_has_the_sentences():
    assert {cells[0]: cells[2] for cells in page_rows() if len(cells) == 3} == SENTENCES


def test_a_repetition_that_finds_nothing_says_so():
    found = falsification.result("CC4", "random", repetitions=1, runs=16)
    assert (found.firsts, found.cell) == ((None,), "0 of 1")


def test_the_command_prints_a_row(capsys):
    assert falsification.main(["--only", "CC3", "--repetitions", "1"]) == 0
    assert re.search(r"CC3 +│ 1 of 1: mean [\d.]+, median \d+ +│ 1 of 1", capsys.readouterr().out)
