"""Shrinking on made-up oracles: what remains still violates, is smaller, and is not made smaller again."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from hypothesis import assume, given
from hypothesis import strategies as st

from railhil.faults.language import parse
from railhil.hunt.shrink import ROUNDS_MAX, Shrunk, shrink

HORIZON_S = 42.0
CASE = (
    "TRN_SPEED loss @5s for 8s combine",
    "balise wrong 33m @50ms combine",
    "speed offset 20 km/h @6s for 3s combine",
    "NOTCH_CMD loss @7s x40 combine",
)


def length_s(faults: tuple[str, ...], start: str) -> float:
    """Longest fault whose text begins so; 0 without one."""
    found = [parse(text).duration_s or HORIZON_S for text in faults if text.startswith(start)]
    return max(found, default=0.0)


def counted(violates: Callable[[tuple[str, ...]], bool]) -> tuple[Callable[[tuple[str, ...], int], bool], list[str]]:
    """An oracle that does not look at the seed, and the candidates that it was asked."""
    asked: list[str] = []

    def oracle(faults: tuple[str, ...], seed: int) -> bool:
        asked.append(f"{faults} {seed}")
        return violates(faults)

    return oracle, asked


def shrunk(violates: Callable[[tuple[str, ...]], bool]) -> Shrunk:
    return shrink(CASE, 7, counted(violates)[0], HORIZON_S)


def test_one_short_late_fault_remains() -> None:
    found = shrunk(lambda faults: length_s(faults, "TRN_SPEED loss") >= 0.3)
    (text,) = found.faults
    fault = parse(text)
    assert (fault.place.name, fault.what, fault.combine, found.seed) == ("TRN_SPEED", "loss", False, 0)
    assert 0.3 <= (fault.duration_s or 0.0) <= 0.32
    assert HORIZON_S * 63 / 64 - 0.02 <= fault.trigger.value <= HORIZON_S
    assert found.saved_at_s is not None
    assert found.saved_at_s < fault.trigger.value + 0.3
    assert found.runs <= 45


def test_two_faults_remain_where_two_are_needed() -> None:
    found = shrunk(lambda faults: length_s(faults, "TRN_SPEED") >= 0.3 and length_s(faults, "speed offset") >= 0.05)
    assert [text.split()[0] for text in found.faults] == ["TRN_SPEED", "speed"]
    assert all(parse(text).combine for text in found.faults)


def test_two_faults_that_each_hide_the_other_are_dropped_as_a_pair() -> None:
    """Without one alone the case does not violate; without both it does."""
    pair = ("balise", "speed")
    found = shrunk(
        lambda faults: (
            sum(text.startswith(pair) for text in faults) != 1 and any(text.startswith("TRN_SPEED") for text in faults)
        )
    )
    assert [text.split()[0] for text in found.faults] == ["TRN_SPEED"]


def test_counts_are_made_smaller_like_lengths() -> None:
    found = shrunk(lambda faults: any((parse(text).count or 0) >= 6 for text in faults))
    assert [parse(text).count for text in found.faults] == [6]


def test_a_word_becomes_the_first_one_of_its_place_that_does() -> None:
    case = ("TRN_SPEED delay 200ms jitter 20ms @5s for 2s",)
    found = shrink(case, 0, lambda faults, seed: length_s(faults, "TRN_SPEED") >= 0.3, HORIZON_S)
    assert (parse(found.faults[0]).what, dict(parse(found.faults[0]).values)["share"]) == ("loss", 1.0)
    kept = shrink(case, 0, lambda faults, seed: length_s(faults, "TRN_SPEED delay") >= 0.3, HORIZON_S)
    assert parse(kept.faults[0]).what == "delay"


def test_values_become_milder() -> None:
    key = next(iter(parse(CASE[2]).values))
    found = shrunk(
        lambda faults: any(text.startswith("speed offset") and parse(text).parameter(key) > 1.0 for text in faults)
    )
    before, after = parse(CASE[2]).parameter(key), parse(found.faults[0]).parameter(key)
    assert 1.0 < after <= before / 2


def test_a_longer_fault_that_does_not_violate_is_told() -> None:
    found = shrink(("TRN_SPEED loss @5s for 400ms",), 0, lambda faults, seed: 0.3 <= length_s(faults, "TRN") <= 0.7, 42)
    assert 0.3 <= length_s(found.faults, "TRN") <= 0.32
    assert found.longer_pass == (3.0, 5.0)


def test_no_candidate_is_asked_twice_and_the_result_is_not_made_smaller_again() -> None:
    oracle, asked = counted(lambda faults: length_s(faults, "TRN_SPEED loss") >= 0.3)
    first = shrink(CASE, 7, oracle, HORIZON_S)
    assert len(asked) == len(set(asked)) == first.runs
    second = shrink(first.faults, first.seed, oracle, HORIZON_S)
    assert (second.faults, second.seed) == (first.faults, first.seed)
    assert second.runs <= 30


@given(st.data(), st.integers(0, 2**16))
def test_a_shrunk_case_stays_as_it_is_also_if_more_is_not_worse(data: st.DataObject, salt: int) -> None:
    """Made-up answers: by chance, the same for the same candidate."""
    share = data.draw(st.sampled_from((0.05, 0.2, 0.5)))

    def violates(faults: tuple[str, ...], seed: int) -> bool:
        return Random(f"{salt} {faults} {seed}").random() < share

    first = shrink(CASE, 7, violates, HORIZON_S)
    second = shrink(first.faults, first.seed, violates, HORIZON_S)
    assume(first.rounds < ROUNDS_MAX)
    assert (second.faults, second.seed) == (first.faults, first.seed)
    assert len(first.faults) > 1 or second.runs <= 30


@given(st.sets(st.integers(0, 3), min_size=1), st.floats(0.02, 7.0))
def test_the_result_violates_and_is_not_larger(needed: set[int], least_s: float) -> None:
    """A case violates if it has the needed faults, the first of them long enough."""
    starts = [CASE[place].split()[0] for place in sorted(needed)]

    def violates(faults: tuple[str, ...], seed: int) -> bool:
        has_all = all(any(text.startswith(start + " ") for text in faults) for start in starts)
        return has_all and (starts[0] != "TRN_SPEED" or length_s(faults, starts[0]) >= least_s)

    found = shrink(CASE, 7, violates, HORIZON_S)
    assert violates(found.faults, found.seed)
    assert len(found.faults) == len(needed)
