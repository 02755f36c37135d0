"""Cases of a hunt are data: the same for the same seed and number, whatever was made before."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.common.errors import InputError
from railhil.faults.language import fault_text, parse
from railhil.faults.random_faults import Sent
from railhil.hunt.cases import STRATEGIES, Space, make_case, make_cases


def can_inject(text: str) -> bool:
    try:
        return parse(text).place.level != "bus"
    except InputError:
        return False


SPACE = Space(
    42.0,
    {"TRN_SPEED": ["TrainSpeed"], "TIME_SYNC": ["TimeSeconds"], "NOTCH_SDT": ["SafeNotch"]},
    {"TRN_SPEED": Sent(0.0, 42.0, 0.01), "TIME_SYNC": Sent(0.0, 41.0, 1.28)},
    can_inject,
)


@settings(max_examples=40)
@given(st.sampled_from(STRATEGIES), st.integers(0, 2**32 - 1), st.permutations(range(6)))
def test_a_case_depends_on_seed_and_number_alone(strategy: str, seed: int, order: list[int]) -> None:
    straight = make_cases(strategy, seed, range(6), SPACE)
    assert [make_case(strategy, seed, number, SPACE) for number in order] == [straight[number] for number in order]
    assert [case.number for case in straight] == list(range(6))


@pytest.mark.parametrize(("strategy", "least", "most"), [("random", 1, 2), ("swarm", 2, 5)])
def test_faults_of_a_case_are_in_the_language_and_can_be_injected(strategy: str, least: int, most: int) -> None:
    cases = make_cases(strategy, 1, range(200), SPACE)
    counts = {len(case.faults) for case in cases}
    assert set(range(least, most + 1)) <= counts <= set(range(1, most + 1))
    for text in (text for case in cases for text in case.faults):
        assert fault_text(parse(text)) == text
        assert can_inject(text)
        assert not text.startswith("NOTCH_SDT")


def test_a_swarm_case_has_fewer_kinds_of_faults_than_random_ones() -> None:
    """Its faults are of few levels, so that they meet."""
    levels = [{parse(text).place.level for text in case.faults} for case in make_cases("swarm", 2, range(200), SPACE)]
    assert max(len(one) for one in levels) <= 4
    assert sum(len(one) == 1 for one in levels) > 50


def test_auto_takes_the_strategies_in_turn() -> None:
    cases = make_cases("auto", 5, range(30), SPACE)
    assert {case.strategy for case in cases} == {*STRATEGIES} - {"auto"}
    for case in cases:
        assert case.faults == make_case(case.strategy, 5, case.number, SPACE).faults
