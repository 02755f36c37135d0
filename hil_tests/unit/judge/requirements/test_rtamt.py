"""rtamt gives the same margins at every sample: of random formulas, of random sentences and of those that ship."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.unit.judge.requirements.records import names, record_of
from railhil.common.errors import InputError
from railhil.faults.random_faults import Sent, random_pair
from railhil.judge.record import Record, checked_record
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.outcome import judge_one
from railhil.judge.requirements.requirement import Requirement, read_requirements
from railhil.judge.requirements.robustness import all_of, any_of, compared, unless, window_max, window_min
from railhil.record.trace import FloatArray, Trace
from railhil.run.make import NeverBegan, record_run
from railhil.scenarios.fault_list import list_disturbed_signals
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.study.faultless import can_inject_in, faultless_run
from railhil.wire.ato import CtlMode

pytest.importorskip("rtamt", reason="MISSING CAPABILITY rtamt, which cannot be installed for Python 3.13 and newer")

from hil_tests.unit.judge.requirements.stl import EQUAL_BELOW, Oracle, margins

DEPTH = 4
#: Signals of the formulas.
_SIGNALS = "abcd"
#: The first tick at which the windows of a random sentence into the past are known.
_FIRST = 12
#: A journey of 250 m with a margin of each sentence.
_JOURNEY = RunSpec(str(TEST_DATA / "pairs.toml"), law=LawSpec("ipfc_plus"), bus="local")


class Formulas:
    """Formulas drawn at random, and what railhil's operators give for each."""

    def __init__(self, draws: np.random.Generator) -> None:
        self._draws = draws
        # rtamt fails at a record of one sample.
        count = int(draws.integers(2, 80))
        self.series = {name: draws.normal(size=count) for name in _SIGNALS}

    def drawn(self, depth: int) -> tuple[str, FloatArray]:
        """A formula, and its margins at each sample."""
        if depth == 0:
            return self._comparison()
        word = str(self._draws.choice(["not", "and", "or", "always", "eventually", "until"]))
        formula, own = self.drawn(depth - 1)
        if word == "not":
            return f"not({formula})", -own
        if word in ("always", "eventually"):
            first, last = np.sort(self._draws.integers(0, 12, 2)).tolist()
            # rtamt cuts a window at the end of the record.
            window, beyond = (window_min, np.inf) if word == "always" else (window_max, -np.inf)
            return f"{word}[{first}:{last}]({formula})", window(own, first, last, beyond)
        other, others = self.drawn(int(self._draws.integers(0, depth)))
        if word in ("and", "or"):
            return f"({formula} {word} {other})", (all_of if word == "and" else any_of)(own, others)
        # A sentence asks for the truth of what releases, and for no margin of it.
        gate = f"r{len(self.series)}"
        self.series[gate] = np.where(margins(other, self.series) > 0, np.inf, -np.inf)
        found = unless(own, others > 0)
        return f"((({formula}) until ({gate})) or always({formula}))", np.where(np.isnan(found), np.inf, found)

    def _comparison(self) -> tuple[str, FloatArray]:
        sign = str(self._draws.choice(["<", "<=", ">", ">="]))
        left, right = self._draws.choice(list(_SIGNALS), 2, replace=False)
        return f"({left} {sign} {right})", compared(sign, self.series[left], self.series[right], 0.0)


def compare_formulas(seed: int, number: int) -> None:
    draws = np.random.default_rng(seed)
    for _ in range(number):
        formulas = Formulas(draws)
        formula, own = formulas.drawn(DEPTH)
        np.testing.assert_array_equal(own, margins(formula, formulas.series), err_msg=formula)


class Sentences:
    """Sentences and records drawn at random. All values of a record are known at every tick."""

    def __init__(self, draws: np.random.Generator) -> None:
        self._draws = draws

    def _one(self, *of: str) -> str:
        return str(self._draws.choice(list(of)))

    def _time(self, most: int = 10) -> str:
        return f"{self._draws.integers(2, most) * 10} ms"

    def _comparison(self) -> str:
        sign = self._one("<", "<=", ">", ">=")
        name, limit = self._one("measured_speed", "notch_command"), float(self._draws.integers(-1, 5))
        value = self._one(name, f"lowest({name}, {self._time()})", f"highest({name}, {self._time()})", f"abs({name})")
        return f"{value} {sign} {limit} m/s" if name == "measured_speed" else f"{value} {sign} {limit}"

    def condition(self, depth: int) -> str:
        word = self._one("not", "and", "or", "")
        if depth == 0 or not word:
            return self._comparison()
        if word == "not":
            return f"not ({self.condition(depth - 1)})"
        return f"({self.condition(depth - 1)} {word} {self.condition(depth - 1)})"

    def sentence(self) -> str:
        body = self._one("always", "never", "never for", "whenever", "whenever", "whenever", "eventually")
        condition = self.condition(DEPTH - 1)
        if body == "never for":
            return f"never {condition} for longer than {self._time()}"
        if body in ("always", "never"):
            return f"{body} {condition}"
        hold = self._one("", f" for {self._time()}")
        if body == "eventually":
            return f"eventually {self._one('', f'within {self._time()} ')}{condition}{hold}"
        times = np.sort(self._draws.choice(np.arange(2, 12), 2, replace=False) * 10).tolist()
        first = self._one("", "at once ", f"within {self._time()} ", f"from {times[0]} ms to {times[1]} ms ")
        rest = self._one("", f" for {self._time()}", f", until {self.condition(1)}", ", until end")
        return f"whenever {self.condition(2)}, {first}{condition}{rest}"

    def record(self) -> Record:
        ticks = int(self._draws.integers(_FIRST + 2, 60))
        # Values that stay for some ticks.
        speeds = np.repeat(self._draws.integers(0, 5, ticks), self._draws.integers(1, 5, ticks))[:ticks] * 1000
        notches = np.repeat(self._draws.integers(-2, 5, ticks), self._draws.integers(1, 4, ticks))[: -(-ticks // 2)]
        return record_of(speeds.tolist(), [(int(notch) * 256, int(CtlMode.RUNNING)) for notch in notches])


def compare_sentence(says: str, grid: Grid, known: Names, first: int, step: int = 1) -> tuple[int, set[str]]:
    """Compare a sentence from each ``step``-th tick on with rtamt; ticks compared, and verdicts."""
    oracle = Oracle(says, known, grid)
    found, verdicts = oracle.outcomes(), set[str]()
    ticks = range(first, grid.count, step)
    for tick in ticks:
        requirement = Requirement("R", f"from {tick * grid.tick_ns // 10**6} ms to end, {says}")
        own = judge_one(requirement, requirement.bind(known), grid)
        verdict, margin = found[tick]
        assert own.verdict == verdict, (tick, says)
        assert (own.margin is None) == (margin is None), (tick, says)
        if own.margin is not None and margin is not None:
            assert own.margin == pytest.approx(margin, rel=EQUAL_BELOW, abs=EQUAL_BELOW), (tick, says)
        verdicts.add(verdict)
    return oracle.compared, verdicts


def compare_sentences(seed: int, number: int) -> None:
    drawn, verdicts = Sentences(np.random.default_rng(seed)), set[str]()
    for _ in range(number):
        verdicts |= compare_sentence(drawn.sentence(), Grid(drawn.record()), names(), _FIRST)[1]
    assert verdicts == {"kept", "violated", "open", "says nothing"}


def compare_shipped(record: Record, step: int) -> list[str]:
    """Compare the shipped sentences on the record of a run; what they find in all of it."""
    known = Names(record.scenario, Trace(record.trace.contract), record.certificate.get("notes"))
    grid, found = Grid(record), list[str]()
    for one in read_requirements("ato"):
        ticks, verdicts = compare_sentence(one.says, grid, known, 0, step)
        # But for the beginning of the record, a controller that has no level, and the time since what has not happened.
        assert ticks > 0.5 * grid.count or "since(" in one.says
        found += verdicts
    return found


@pytest.fixture(scope="module")
def calm() -> tuple[float, Mapping[str, Sent]]:
    return faultless_run(_JOURNEY)


def test_random_formulas_have_the_margins_of_rtamt_at_every_sample() -> None:
    compare_formulas(1, 60)


@pytest.mark.slow
def test_random_sentences_have_the_margins_of_rtamt_at_every_sample() -> None:
    compare_sentences(2, 60)


@pytest.mark.long
def test_two_thousand_random_formulas_have_the_margins_of_rtamt_at_every_sample() -> None:
    compare_formulas(3, 2000)


@pytest.mark.long
def test_a_thousand_random_sentences_have_the_margins_of_rtamt_at_every_sample() -> None:
    compare_sentences(4, 1000)


@pytest.mark.slow
def test_the_shipped_sentences_have_the_margins_of_rtamt_on_a_run(tmp_path: Path) -> None:
    """Their conditions at every tick, their verdicts and margins from every 500th tick on."""
    faults = ("TRN_SPEED.SpeedChk raw 0 @4s x3", "NOTCH_CMD.NotchChk raw 0 @5s x3", "TRN_SPEED loss @8s for 90ms")
    result = record_run(replace(_JOURNEY, faults=faults, out=tmp_path / "run"))
    assert "kept" in compare_shipped(checked_record(str(result.folder), None), step=500)


@pytest.mark.long
@pytest.mark.parametrize("number", range(20))
def test_the_shipped_sentences_have_the_margins_of_rtamt_on_a_run_with_random_faults(
    number: int, calm: tuple[float, Mapping[str, Sent]], tmp_path: Path
) -> None:
    system = system_named("ato")
    can_inject = partial(can_inject_in, system, _JOURNEY)
    # Some faults do not go together: then the next pair of this number's row.
    for seed in itertools.count(number, 20):
        faults = random_pair(seed, calm[0], list_disturbed_signals(system), calm[1], can_inject)
        try:
            result = record_run(replace(_JOURNEY, faults=faults, seed=seed, out=tmp_path / f"run_{seed}"))
        except (InputError, NeverBegan):
            continue
        assert compare_shipped(checked_record(str(result.folder), None), step=100)
        return
