"""The registry of criteria: what is derived from an entry, and no other module refers to a score by its name."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import railhil
from hil_tests.support.paths import ROOT
from railhil.batch import Case
from railhil.judge.criteria import STOP_WITHIN_M, Criterion, Limit, limit_key, limited, scores, unscored, with_sign
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.judge.criteria import CRITERIA, STOP_ERROR, TIME_ERROR
from railhil.systems.ato.scenario.model import Scenario

HEADROOM = Criterion("headroom_m", "headroom", "m3", 1, lambda run: 3.0, "high", Limit(lambda scenario: 2.0, 2))


def test_documented_keys() -> None:
    assert [criterion.key for criterion in CRITERIA] == [
        "itae", "energy_kj", "punctuality_s", "stop_error_m", "comfort",
    ]  # fmt: skip
    assert list(with_sign(CRITERIA)) == ["time_error_s", "stop_error_m"]
    assert limited(CRITERIA) == [STOP_ERROR, TIME_ERROR]
    assert [criterion.heading for criterion in CRITERIA] == [
        "ITAE\nkm/h s2", "energy\nkJ", "time\nerror s", "stop\nerror m", "comfort\nm/s2/km",
    ]  # fmt: skip
    shown = ("digits", "published_digits", "statistics_digits", "tuning_digits", "audit_allowed", "name", "brief")
    assert [tuple(getattr(criterion, field) for field in shown) for criterion in CRITERIA] == [
        (1, 0, None, 0, None, "ITAE", "ITAE"),
        (0, None, None, None, None, "energy", "energy"),
        (4, None, None, 3, 0.01, "time_error", "time"),
        (4, None, None, 3, 0.01, "stop_error", "stop"),
        (3, None, 4, None, None, "comfort", "comfort"),
    ]
    assert STOP_WITHIN_M == (0.1, 0.2, 0.3)
    assert [criterion.limit.place for criterion in limited(CRITERIA) if criterion.limit is not None] == [0, 1]
    assert [limit_key(criterion) for criterion in (STOP_ERROR, HEADROOM)] == ["stop_error_m", "headroom_m"]
    assert limit_key(TIME_ERROR) == "time_error_s"
    assert [criterion.unit_typeset for criterion in CRITERIA] == ["km/h s²", "kJ", "s", "m", "m/s²/km"]


def test_no_other_module_knows_a_score_by_its_name() -> None:
    roots = [Path(railhil.__file__).parent, *(ROOT / name for name in railhil.AT_TOP)]
    # Each system has its own; the batch measures in its compiled loop; the schema says what a published row may hold; a
    # paper names its own. A bound of the energy is of a driving that is called comfort.
    known = {
        "systems/ato/judge/criteria.py",
        "systems/line/judge/criteria.py",
        "systems/ato/energy/ideal_train.py",
        "systems/ato/energy/programme.py",
        "systems/ato/energy/section.py",
        "systems/line/shipped_bounds.py",
        "cli/bound.py",
        "systems/ato/batch/engine.py",
        "systems/ato/scenario/schema.py",
        "systems/ato/scenario/keys.py",
        "reproduce/ipfc.py",
    }
    name = re.compile(r"[\"'.](itae|energy_kj|punctuality_s|comfort)(?![\w(])")
    found = {
        str(path.relative_to(root))
        for root in roots
        for path in root.rglob("*.py")
        if name.search(re.sub(r'""".*?"""', "", path.read_text(encoding="utf-8"), flags=re.DOTALL))
    }
    assert found <= known


def test_a_value_with_a_sign_is_scored_without_it() -> None:
    values, signed = scores({"stop_error_m": -0.25, "headroom_m": 3.0}, (STOP_ERROR, HEADROOM))
    assert (values, signed) == ({"stop_error_m": 0.25, "headroom_m": 3.0}, {"stop_error_m": -0.25})
    assert unscored((STOP_ERROR, HEADROOM)) == ({"stop_error_m": None, "headroom_m": None}, {"stop_error_m": None})


@pytest.mark.parametrize(
    ("criterion", "value", "said"),
    [
        (STOP_ERROR, -0.31, "-0.310 m, allowed +-0.3 m"),
        (STOP_ERROR, 0.3, ""),
        (STOP_ERROR, None, ""),
        (HEADROOM, 1.0, "1.0 m3, allowed at least 2 m3"),
        (HEADROOM, 2.0, ""),
        (replace(HEADROOM, better="low"), 2.0, ""),
        (replace(HEADROOM, better="low"), 2.5, "2.5 m3, allowed at most 2 m3"),
        (CRITERIA[0], 1e9, ""),
    ],
)
def test_what_is_said_of_a_limit(lvshun: Scenario, criterion: Criterion, value: float | None, said: str) -> None:
    assert criterion.missed(lvshun, value) == said


def test_a_value_in_a_table() -> None:
    assert [STOP_ERROR.shown(value) for value in (0.25, None)] == ["0.2500", "-"]
    assert STOP_ERROR.shown(0.25, 1) == "0.2"


def test_more_may_be_better(lvshun: Scenario) -> None:
    assert (HEADROOM.best([1.0, 3.0]), STOP_ERROR.best([1.0, 3.0])) == (3.0, 1.0)
    assert HEADROOM.inside(lvshun, np.array([1.0, 2.0, np.nan])).tolist() == [False, True, False]
    assert STOP_ERROR.inside(lvshun, np.array([1.0, 0.3, np.nan])).tolist() == [False, True, False]
    assert (STOP_ERROR.badness(np.array([2.0]))[0], HEADROOM.badness(np.array([2.0]))[0]) == (2.0, -2.0)
    assert limited((HEADROOM, TIME_ERROR, STOP_ERROR)) == [STOP_ERROR, TIME_ERROR, HEADROOM]
    assert limited((replace(HEADROOM, applies=lambda _: False), STOP_ERROR), lvshun) == [STOP_ERROR]


def test_the_batch_gives_every_criterion_and_the_stop(lvshun: Scenario) -> None:
    (score,) = run_batch(Case(lvshun), (1,)).scores
    assert list(score.values) == [criterion.key for criterion in CRITERIA]
    (stop,) = score.stops
    assert stop.error_m == score.signed["stop_error_m"]
