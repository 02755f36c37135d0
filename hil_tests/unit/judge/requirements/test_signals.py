"""Sentences over signals that no record has: the same language, units and margins."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.judge.requirements.outcome import Outcome
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.signals import SignalJudge

TICK_NS = 10_000_000
UNITS = {"gap": "m", "speed": "km/h"}
#: Each 10 ms; the gap shrinks by 0.1 m in each tick.
SIGNALS = {"gap": 5 - np.arange(30) / 10, "speed": np.full(30, 36.0)}


def judged(says: str) -> Outcome:
    (found,) = SignalJudge([Requirement("T-1", says)], UNITS, TICK_NS).outcomes(SIGNALS)
    return found


def test_a_sentence_has_its_margin_in_the_unit_of_the_signal() -> None:
    found = judged("always gap > 3 m")
    assert (found.verdict, found.margin, found.unit, found.instant_s) == ("violated", pytest.approx(-0.9), "m", 0.29)
    assert judged("always speed < 20 m/s").margin == pytest.approx(36.0)
    assert judged("never speed > 20 m/s for longer than 50 ms").kept


@pytest.mark.parametrize(("values", "margin"), [("lowest(gap, 50 ms)", 2.1), ("highest(gap, 50 ms)", 2.6)])
def test_a_window_has_both_its_ends(values: str, margin: float) -> None:
    found = judged(f"from 50 ms to end, always {values} >= 0 m")
    assert (found.verdict, found.margin) == ("kept", pytest.approx(margin))
    # Before the window lies in the run, nothing is known of it.
    assert judged(f"from 0 s to 40 ms, always {values} >= 0 m").verdict == "says nothing"


def test_a_window_with_an_unknown_value_is_unknown() -> None:
    gap = SIGNALS["gap"].copy()
    gap[10] = np.nan
    judge = SignalJudge([Requirement("T-1", "never highest(gap, 50 ms) > 0 m")], UNITS, TICK_NS)
    (found,) = judge.outcomes({**SIGNALS, "gap": gap})
    assert found.instant_s == pytest.approx(0.05)
    judge = SignalJudge([Requirement("T-1", "from 100 ms to 150 ms, never highest(gap, 50 ms) > 0 m")], UNITS, TICK_NS)
    assert judge.outcomes({**SIGNALS, "gap": gap})[0].verdict == "says nothing"


@pytest.mark.parametrize(
    ("says", "words"),
    [
        ("always gap < 3 s", "a length is compared with a time"),
        ("always gop < 3 m", "did you mean gap?"),
        ("always age(TRN_SPEED) < 3 s", "is no port"),
        ("after stopped, always gap < 3 m", "stopped"),
        ("at end stop_error < 3 m", "is no signal and no name"),
    ],
)
def test_what_a_model_has_not_is_refused(says: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        judged(says)


def test_signals_of_another_shape_are_refused() -> None:
    judge = SignalJudge([Requirement("T-1", "always gap > 3 m")], UNITS, TICK_NS)
    with pytest.raises(ValueError, match="all of the same length"):
        judge.outcomes({"gap": np.zeros(3), "speed": np.zeros(4)})
    with pytest.raises(ValueError, match="found signals"):
        judge.outcomes({"gap": np.zeros(3)})
