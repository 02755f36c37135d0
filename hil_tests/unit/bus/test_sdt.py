"""SDTv2: the safety code, and the verdicts of a sink, cycle by cycle."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus.sdt import (
    POLYNOMIAL,
    SafeSink,
    SafeSource,
    SinkLimits,
    Validity,
    crc32,
    source_identity,
)

VERSION = 3
OURS, REDUNDANT, STRANGER = (source_identity(number) for number in (0x140, 0x141, 0x142))
SIDS = {"": OURS, "b": REDUNDANT, "x": STRANGER}
LIMITS = SinkLimits(n_rxsafe=3, n_ssc=4, n_guard=5, cmthr=8)
#: Verdicts by their letters.
LETTERS = {Validity.FRESH: "F", Validity.INVALID: "i", Validity.ERROR: "E"}


# -- safety code ------------------------------------------------------------------------------------------------------


def mirrored(value: int, bits: int) -> int:
    return int(f"{value:0{bits}b}"[::-1], 2)


def test_the_code_has_the_published_check_value_of_its_polynomial() -> None:
    """CRC-32/AUTOSAR is the same polynomial, mirrored and inverted: 0x1697D06A for the digits 1 to 9."""
    data = bytes(mirrored(octet, 8) for octet in b"123456789")
    assert mirrored(crc32(data, 0xFFFF_FFFF), 32) ^ 0xFFFF_FFFF == 0x1697_D06A


@given(data=st.binary(max_size=40), seed=st.integers(0, 0xFFFF_FFFF))
def test_the_code_is_a_division_by_the_polynomial(data: bytes, seed: int) -> None:
    value = seed
    for octet in data:
        for bit in range(7, -1, -1):
            value = value << 1 ^ (octet >> bit & 1) << 32
            value ^= (1 << 32 | POLYNOMIAL) if value >> 32 else 0
    assert crc32(data, seed) == value
    assert crc32(data + value.to_bytes(4), seed) == 0


def test_sources_have_different_identities() -> None:
    assert len({source_identity(address) for address in range(0x100, 0x400, 8)}) == 96


def test_a_source_counts_its_telegrams() -> None:
    source = SafeSource(OURS, VERSION)
    for number in range(600):
        data = source.secured(bytes(range(16)))
        assert (data[:10], data[10:12]) == (bytes(range(10)), bytes([VERSION << 4, number % 256]))
        assert crc32(data, OURS) == 0


@pytest.mark.parametrize("octet", range(16))
def test_every_changed_bit_is_noticed(octet: int) -> None:
    data = SafeSource(OURS, VERSION).secured(bytes(range(16)))
    for bit in range(8):
        changed = bytearray(data)
        changed[octet] ^= 1 << bit
        sink = SafeSink([OURS], VERSION, LIMITS)
        assert sink.judge(bytes(changed)) is Validity.ERROR
        assert sink.counters == {"crc": 1}


# -- verdicts ---------------------------------------------------------------------------------------------------------


def telegram(word: str) -> bytes | None:
    """``-``: none; else the counter, with the letter of another source in front; behind it ``!`` damaged, ``v`` another
    version."""
    if word == "-":
        return None
    source = word.rstrip("0123456789!v")
    ssc = int(word.strip("!vbx"))
    body = ssc.to_bytes(4) + bytes(6) + bytes([(VERSION + word.endswith("v")) << 4, ssc % 256])
    code = crc32(body, SIDS[source]) ^ word.endswith("!")
    return body + code.to_bytes(4)


def words(text: str) -> Iterator[str]:
    """``1-4`` stands for ``1 2 3 4``, ``5*3`` for ``5 5 5``."""
    for word in text.split():
        first, dash, last = word.partition("-")
        if dash and first and last:
            letter = first.rstrip("0123456789")
            yield from (f"{letter}{number}" for number in range(int(first.strip("bx")), int(last) + 1))
        else:
            name, _, count = word.partition("*")
            yield from [name] * int(count or 1)


SCENARIOS = {
    "initialised by the second telegram": ("1-5", "E F*4", {}),
    "a duplicate, then init anew": ("1-4 4*4 5-7", "E F*3 i i E*2 E F*2", {"duplicate": 4}),
    "init with few duplicates": ("1*2 2-5", "E*2 F*4", {"duplicate": 1}),
    "init with many duplicates": ("1*10 2-5", "E*10 E F*3", {"duplicate": 9}),
    "a stuck sender does not initialise": ("7*20", "E*20", {"duplicate": 19}),
    "nothing for less than n_rxsafe": ("1-4 - - 5", "E F*3 i i F", {}),
    "nothing for n_rxsafe": ("1-4 - - - 5 6", "E F*3 i i E E F", {}),
    "an old one": ("1-10 6 11 12", "E F*9 i F*2", {"out_of_sequence": 1}),
    "a gap of n_ssc": ("1-4 8 9", "E F*3 F*2", {}),
    "a gap beyond n_ssc": ("1-4 9-14", "E F*3 i i E E F*2", {"out_of_sequence": 3}),
    "the counter goes round": ("254-260", "E F*6", {}),
    "damaged, then initialised": ("1! 2! 3 3 4-6", "E*3 E F*3", {"crc": 2, "duplicate": 1}),
    "one CRC error": ("1-3 4! 5-8", "E F*2 i F*4", {"crc": 1}),
    "two CRC errors within n_rxsafe": ("1-3 4! 5! 6-16", "E F*2 i E E*8 F F F", {"crc": 2, "channel": 1}),
    "CRC errors beyond n_rxsafe": ("1-3 4! 5! 6! 7! 8-18", "E F*2 i E*3 E*9 F F", {"crc": 4, "channel": 3}),
    "the same damaged one twice": ("1-3 4!*2 5-8", "E F*2 i i F*4", {"crc": 2}),
    "a stuck damaged one": ("1-3 4!*6 5-8", "E F*2 i i E*4 E F*3", {"crc": 6}),
    "CRC errors cmthr apart": ("1-3 4! 5-12 13! 14-16", "E F*2 i F*8 i F*3", {"crc": 2}),
    "CRC errors nearer than cmthr": (
        "1-3 4! 5-11 12! 13-23",
        "E F*2 i F*7 E E*8 F*3",
        {"crc": 2, "channel": 1},
    ),
    "ok ok crc1 ok crc2 crc2 ok ok": ("1 2 3! 4 5!*2 6 7", "E F i F E E E E", {"crc": 3, "channel": 1}),
    "stuck, then another stuck": ("1-4 5!*4 6!*4 7-20", "E F*3 i i E*2 E*4 E*9 F*5", {"crc": 8, "channel": 1}),
    "another version": ("1-3 4v 5v 6v 7-9", "E F*2 i i E E F*2", {"version": 3}),
    "a strange source": ("1-3 x4 x4 4 5", "E F*2 i i F*2", {"crc": 2}),
    "a switch-over": ("1-6 b1-9", "E F*5 i F*8", {"source": 1}),
    "back within the guard time at once": ("1-6 b1 7 b2-14", "E F*5 i E E E*5 E F*6", {"source": 3, "redundancy": 2}),
    "back within the guard time later": ("1-6 b1-3 7 8-16", "E F*5 i F*2 E E*6 F*3", {"source": 2, "redundancy": 1}),
    "back after the guard time": ("1-6 b1-7 7-10", "E F*5 i F*6 i F*3", {"source": 2}),
    "channel failed, then a switch-over": (
        "1-3 4! 5! b1-9",
        "E F*2 i E E F*8",
        {"crc": 2, "channel": 1, "source": 1},
    ),
}


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenario(name: str) -> None:
    given_words, verdicts, counted = SCENARIOS[name]
    sink = SafeSink([OURS, REDUNDANT], VERSION, LIMITS)
    found = [LETTERS[sink.judge(telegram(word))] for word in words(given_words)]
    assert " ".join(found) == " ".join(words(verdicts))
    assert dict(sink.counters) == counted


@given(st.lists(st.one_of(st.none(), st.binary(min_size=16, max_size=16)), max_size=60))
def test_no_content_raises_and_none_is_fresh(telegrams: list[bytes | None]) -> None:
    sink = SafeSink([OURS, REDUNDANT], VERSION, LIMITS)
    assert {sink.judge(data) for data in telegrams} <= {Validity.ERROR}
