"""What CI takes of the long checks: another share each day, the same one everywhere."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.hashes import choose, runs
from hil_tests.support.paths import ROOT

_DAYS = tuple(f"2026-12-{number:02}" for number in range(1, 32))


@given(st.sets(st.text(), min_size=1), st.integers(1, 20), st.dates(), st.randoms())
def test_a_sample_is_a_share_whatever_the_order(names, share, day, random):
    chosen = choose(sorted(names), share, str(day))
    assert chosen <= names
    assert len(chosen) == -(-len(names) // share)
    shuffled = sorted(names)
    random.shuffle(shuffled)
    assert choose(shuffled, share, str(day)) == chosen


def test_days_have_other_samples_and_in_time_each_run_has_its_turn():
    names = list(runs(["stop", "emu3", "faults"], None, None))
    days = [choose(names, 4, day) for day in _DAYS]
    assert len(set(map(frozenset, days))) == len(_DAYS)
    assert set().union(*days) == set(names)


def _collected(variables: dict[str, str]) -> list[str]:
    words = [sys.executable, "-m", "pytest", "--collect-only", "-q", "hil_tests/cli/test_makefile.py"]
    environment = {**os.environ, **variables}
    done = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    return [line for line in done.stdout.splitlines() if "::" in line]


@pytest.mark.slow
def test_pytest_collects_the_share_of_the_day():
    whole = _collected({})
    for day in ("2026-11-27", "2026-11-28"):
        assert set(_collected({"RAILHIL_SAMPLE": f"3 {day}"})) == choose(whole, 3, day)
