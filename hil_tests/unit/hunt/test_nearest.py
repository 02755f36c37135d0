"""The nearest case that keeps a requirement."""

from __future__ import annotations

from railhil.hunt.nearest import nearest_case

LEAST = ("TRN_SPEED loss @2s for 100ms", "adhesion low @1s for 2s combine")


def test_the_case_that_differs_least_in_time_is_the_nearest() -> None:
    shorter = ("TRN_SPEED loss @2s for 90ms", LEAST[1])
    later = ("TRN_SPEED loss @2.5s for 100ms", LEAST[1])
    both = ("TRN_SPEED loss @2s for 90ms", "adhesion low @1.01s for 2s combine")
    assert nearest_case(LEAST, [later, both, shorter, (), LEAST[:1]]) == shorter
    assert nearest_case(LEAST, [later, LEAST[:1]]) == later


def test_a_case_with_the_same_kinds_of_faults_is_nearer_than_one_with_others() -> None:
    other = ("TRN_POS loss @2s for 100ms", LEAST[1])
    assert nearest_case(LEAST, [other, LEAST[:1], ("TRN_SPEED loss @9s for 5s", LEAST[1])]) != other
    assert nearest_case(LEAST, [LEAST[:1], other]) is not None


def test_without_another_case_there_is_none() -> None:
    assert nearest_case(LEAST, []) is None
