"""Random pairs of faults: the same for the same seed, and such that they find something to act on."""

from __future__ import annotations

from functools import cache

import pytest

from railhil.common.errors import InputError
from railhil.faults.language import parse
from railhil.faults.model import Fault
from railhil.faults.random_faults import DURATIONS_S, Sent, can_act, random_pair

HORIZON_S = 42.0
PORTS = {"TRN_SPEED": ["TrainSpeed"], "TIME_SYNC": ["TimeSeconds"], "NOTCH_SDT": ["SafeNotch"], "BALISE": ["BaliseId"]}
#: NOTCH_SDT is not sent, and BALISE from 12 s on.
SENT = {
    "TRN_SPEED": Sent(0.0, 42.0, 0.01),
    "TIME_SYNC": Sent(0.0, 41.0, 1.28),
    "BALISE": Sent(12.0, 41.0, 0.16),
}


def is_in_the_language(text: str) -> bool:
    try:
        parse(text)
    except InputError:
        return False
    return True


def pair(seed: int) -> list[Fault]:
    return [parse(text) for text in random_pair(seed, HORIZON_S, PORTS, SENT, is_in_the_language)]


@cache
def pairs() -> list[list[Fault]]:
    """Drawn when the first test needs them."""
    return [pair(seed) for seed in range(1000)]


@pytest.mark.slow
def test_a_number_is_always_the_same_pair() -> None:
    assert pair(5) == pair(5) == pairs()[5]
    assert len({tuple(map(str, faults)) for faults in pairs()}) == len(pairs())


def test_a_fault_of_a_telegram_lies_where_it_is_sent_and_lasts_until_it_is() -> None:
    faults = [fault for faults in pairs() for fault in faults if fault.place.level == "telegram"]
    assert {fault.place.name for fault in faults} == set(SENT)
    for fault in faults:
        sent = SENT[fault.place.name]
        assert sent.first_s <= fault.trigger.value <= sent.last_s - sent.apart_s
        assert fault.duration_s is None or sent.apart_s <= fault.duration_s <= DURATIONS_S[1]
        assert fault.values.get("port") != "NOTCH_SDT"


def test_the_second_fault_begins_while_the_first_one_still_matters() -> None:
    others = [faults for faults in pairs() if all(fault.place.level != "telegram" for fault in faults)]
    apart_s = [second.trigger.value - first.trigger.value for first, second in others]
    assert min(apart_s) >= 0
    assert 0.7 < sum(apart_s) / len(apart_s) < 1.3
    assert max(first.trigger.value for first, _ in others) <= 0.8 * HORIZON_S


def test_values_are_such_as_change_something() -> None:
    for fault in (fault for faults in pairs() for fault in faults):
        if fault.what == "noise":
            assert fault.values.get("sigma", 0.1) > 0
        if fault.place.part in ("counter", "checksum"):
            assert all(value == int(value) and value != 0 for value in fault.values.values())
        if fault.place.name == "balise":
            assert fault.duration_s is None
        if fault.place.level == "clock" and fault.duration_s is not None:
            assert fault.duration_s >= 1.28


@pytest.mark.parametrize(
    ("text", "others", "can"),
    [
        ("time stuck @5s", ["time stuck @4s for 2s"], False),
        ("time stuck @5s", ["time stuck @4s for 1s"], True),
        ("time stuck @5s", ["time stuck @4s"], False),
        ("TRN_SPEED loss @5s", ["TRN_SPEED loss @4s x5"], True),
        ("TRN_SPEED loss 50% @5s", ["TRN_SPEED loss @4s"], True),
        ("speed stuck @5s", ["position stuck @4s"], True),
        ("TRN_POS masquerade TRN_POS @5s", [], False),
        ("TRN_POS masquerade TRN_SPEED @5s", [], True),
    ],
)
def test_a_fault_in_the_place_of_the_same_one_cannot_act(text: str, others: list[str], can: bool) -> None:
    assert can_act(parse(text), [parse(one) for one in others]) == can


def test_no_pair_puts_a_port_in_its_own_place() -> None:
    masked = [fault for faults in pairs() for fault in faults if fault.what == "masquerade"]
    assert masked
    assert all(fault.values["port"] != fault.place.name for fault in masked)
