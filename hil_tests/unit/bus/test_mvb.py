"""Check sequence, master word and CAN mapping against the vectors, and what the check sequence must detect."""

from __future__ import annotations

import itertools
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.slave_frames import slave_frame
from railhil.bus import mvb
from railhil.bus.packing import unpack_frames
from railhil.dbc import Port, wire_contract

VECTORS = [json.loads(line) for line in (TEST_DATA / "mvb" / "vectors.jsonl").read_text(encoding="utf-8").splitlines()]


def of_kind(kind: str) -> list[dict]:
    """Vectors of one kind."""
    return [vector for vector in VECTORS if vector["kind"] == kind]


def test_vector_file_is_complete():
    assert {kind: len(of_kind(kind)) for kind in ("telegram", "block", "shim")} == {
        "telegram": 200,
        "block": 73,
        "shim": 27,
    }


@pytest.mark.parametrize(
    ("data", "octet"),
    [("0000", 0xFF), ("1234", 0xA2), ("ffff", 0x05), ("deadbeef", 0xE2), ("0102030405060708", 0xC7), ("f001", 0xC8)],
)
def test_check_sequence_examples(data, octet):
    assert mvb.check_sequence(bytes.fromhex(data)) == octet


def test_telegram_vectors():
    for vector in of_kind("telegram"):
        word = mvb.master_word(vector["f_code"], vector["address"])
        assert word.hex() == vector["master_word"]
        assert f"{mvb.check_sequence(word):02x}" == vector["master_cs"]
        assert slave_frame(bytes.fromhex(vector["data"])).hex() == vector["slave_frame"]


def test_block_vectors():
    for vector in of_kind("block"):
        right = mvb.check_sequence(bytes.fromhex(vector["data"])) == int(vector["cs"], 16)
        assert right == vector["ok"], vector["why"]


@pytest.mark.parametrize("vector", of_kind("shim"), ids=lambda vector: f"{vector['port']}-{vector['seq']}")
def test_can_mapping_vectors(vector):
    port = Port(vector["port"], vector["address"], vector["f_code"], 0, "plant", "publish", "", ())
    for fd, key in ((False, "can"), (True, "canfd")):
        source = mvb.TelegramSource(port, fd=fd)
        data = bytes.fromhex(vector["data"])
        for _ in range(vector["seq"] or 0):
            source.frames(data)
        assert [[f"{frame.can_id:x}", frame.data.hex()] for frame in source.frames(data)] == vector[key]
    source = mvb.TelegramSource(port)
    for _ in range(vector["seq"] or 0):
        source.packed(data)
    found = unpack_frames(source.packed(data))
    assert [[f"{frame.can_id:x}", frame.data.hex()] for frame in found] == vector["can"]


@given(st.sampled_from(wire_contract().ports), st.lists(st.binary(min_size=32, max_size=32), max_size=40))
def test_packed_telegrams_are_those_of_frames(port, telegrams):
    """In turns they count the telegrams together."""
    source, expected = mvb.TelegramSource(port), mvb.TelegramSource(port)
    for number, block in enumerate(telegrams):
        data = block[: port.data_bytes]
        assert len(data) == port.data_bytes
        found = unpack_frames(source.packed(data)) if number % 3 else source.frames(data)
        assert found == expected.frames(data)


def test_sequence_counter_wraps_at_16():
    source = mvb.TelegramSource(wire_contract().port("TRN_POS"))
    counters = [source.frames(bytes(8))[-1].data[4] >> 4 for _ in range(33)]
    assert counters == [k % 16 for k in range(33)]


@pytest.mark.parametrize("size", [0, 1, 3, 5, 7, 9])
def test_wrong_data_length_is_refused(size):
    with pytest.raises(ValueError, match="TRN_SPEED: found"):
        mvb.TelegramSource(wire_contract().port("TRN_SPEED")).frames(bytes(size))
    with pytest.raises(ValueError, match="TRN_SPEED: found"):
        mvb.TelegramSource(wire_contract().port("TRN_SPEED")).packed(bytes(size))


def syndromes(bits: int) -> list[int]:
    """Change of the transmitted check octet, xor the received one, for each single bit error in data + octet.

    The code is linear, so an error pattern is undetected exactly when its syndromes xor to zero.
    """
    size = bits // 8
    zero = mvb.check_sequence(bytes(size))
    data_bits = [mvb.check_sequence((1 << k).to_bytes(size)) ^ zero for k in range(bits)]
    return data_bits + [1 << k for k in range(8)]


@pytest.mark.parametrize("bits", [16, 32, 64])
@pytest.mark.parametrize("weight", [1, 2, 3])
def test_every_error_of_up_to_three_bits_is_detected(bits, weight):
    table = syndromes(bits)
    for pattern in itertools.combinations(range(bits + 8), weight):
        syndrome = 0
        for position in pattern:
            syndrome ^= table[position]
        assert syndrome, f"undetected: bits {pattern}"


@pytest.mark.parametrize(("bits", "undetected"), [(16, 69), (32, 705), (64, 8203)])
def test_number_of_undetected_four_bit_errors(bits, undetected):
    """A share of 4-bit errors must pass: an implementation that rejects all of them is another code."""
    table = syndromes(bits)
    pairs: dict[int, int] = {}
    for a, b in itertools.combinations(range(bits + 8), 2):
        pairs[table[a] ^ table[b]] = pairs.get(table[a] ^ table[b], 0) + 1
    # Each undetected quadruple splits into two pairs in three ways; equal syndromes never share a bit (distance 4).
    assert sum(count * (count - 1) // 2 for count in pairs.values()) // 3 == undetected


@given(st.sampled_from([2, 4, 8]).flatmap(lambda n: st.binary(min_size=n, max_size=n)))
def test_code_is_linear_so_the_exhaustive_test_covers_all_data(block):
    """Flipping a data bit changes the octet by the same amount whatever the data."""
    size = len(block)
    zero = mvb.check_sequence(bytes(size))
    for k in range(size * 8):
        flipped = (int.from_bytes(block) ^ 1 << k).to_bytes(size)
        change = mvb.check_sequence(flipped) ^ mvb.check_sequence(block)
        assert change == mvb.check_sequence((1 << k).to_bytes(size)) ^ zero


@given(st.binary(max_size=12))
def test_master_frame_parser_never_raises(data):
    parsed = mvb.parse_master_frame(data)
    if parsed is not None:
        assert mvb.master_frame(*parsed).data == data


@given(st.binary(max_size=12))
def test_device_status_parser_never_raises(data):
    parsed = mvb.parse_device_status(data)
    if parsed is not None:
        assert mvb.device_status_frame(*parsed).data[:2] == data[:2]


@given(st.integers(0, 0xFFF), st.integers(0, 0xFFFF))
def test_device_status_round_trip(device, status):
    assert mvb.parse_device_status(mvb.device_status_frame(device, status).data) == (device, status)
