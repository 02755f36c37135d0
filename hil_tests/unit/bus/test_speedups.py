"""Code optimised for speed gives the same results as a straightforward implementation."""

from __future__ import annotations

import random

import pytest

from railhil.bus import ident
from railhil.bus import telegrams as house_telegrams
from railhil.bus.frame import Frame, quick_frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import check_sequence, parse_master_frame
from railhil.controller_node.ato.control_loop import POSITION_MAX_01MM, limited_01mm
from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.record.framelog import log_line
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.target import Target
from railhil.wire import ato as telegrams

CLASSES = [
    kind
    for module in (house_telegrams, telegrams, ident)
    for kind in vars(module).values()
    if isinstance(kind, type) and issubclass(kind, Telegram) and "PORT" in vars(kind)
]


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.PORT)
def test_each_signal_stands_in_its_place_and_nothing_else_fits(kind: type[Telegram]) -> None:
    port = kind.port()
    signals = {signal.field_name: signal for signal in port.signals}
    empty = dict.fromkeys(signals, 0)
    for name, signal in signals.items():
        lowest, highest = signal.raw_range
        for value in (lowest, highest, lowest // 3, highest // 3):
            word = int.from_bytes(kind(**(empty | {name: value})).encode())
            shift = port.data_bytes * 8 - signal.first_bit - signal.length
            assert word == (value % (1 << signal.length)) << shift
            assert dict(kind.decode(word.to_bytes(port.data_bytes)).items()) == empty | {name: value}
        for value in (lowest - 1, highest + 1, -(1 << 70), 1 << 70):
            with pytest.raises(OverflowError, match=rf"^{kind.PORT}\.{name}: found {value}, allowed {lowest}"):
                kind(**(empty | {name: value})).encode()


def _by_long_division(block: bytes) -> int:
    """The check octet bit by bit, from the standard's words."""
    remainder = 0
    for bit in "".join(f"{byte:08b}" for byte in block) + "0" * 7:
        remainder = remainder << 1 | int(bit)
        if remainder & 0x80:
            remainder ^= 0b11100101
    ones = "".join(f"{byte:b}" for byte in block).count("1") + remainder.bit_count()
    return ~(remainder << 1 | ones % 2) & 0xFF


def test_check_sequence_by_words_is_that_by_bits() -> None:
    source = random.Random(7)
    for size in (*range(9), 2, 4, 8):
        for _ in range(150):
            block = source.randbytes(size)
            assert check_sequence(block) == _by_long_division(block)


def test_a_frame_made_quickly_is_a_frame() -> None:
    frame = quick_frame((0x118, b"ab", 0))
    assert frame == Frame(0x118, b"ab")
    assert type(frame) is Frame
    assert (frame.can_id, frame.data, frame.flags) == (0x118, b"ab", 0)


def test_a_damaged_poll_is_refused_each_time() -> None:
    assert [parse_master_frame(data) for data in (b"\x11\x10\0", b"\x11\x10\0", b"", b"\x11\x10")] == [None] * 4


def test_log_lines_of_changing_times_and_odd_identifiers() -> None:
    times_ns = (0, 10_000_000, 0, 1_234_567_890, 20_000_000, 30_000_000, 40_000_000, 0)
    stamps = [log_line(time_ns, Frame(0x118, b"\xab")).split()[0] for time_ns in times_ns]
    assert stamps == [f"({time_ns / 1e9:.6f})" for time_ns in (0, 10_000_000, 0, 1_234_567_000, *times_ns[4:])]
    assert log_line(0, Frame(0x7FF, b"\xab")).endswith(" 7FF#AB R\n")
    assert log_line(0, Frame(0x812, b"")).endswith(" 812# R\n")


def test_target_speed_in_stretches_is_that_of_each_instant() -> None:
    scenario = load("lvshun_tieshan")
    plant = Plant(scenario, 0)
    makers, target = TrainTelegrams(scenario, plant, 0.0).makers, Target(scenario.target)
    for tick in (0, 1, 1023, 1024, 5000, 6023, 6024, 3, 18_000, 25_000):
        plant.tick = tick
        track = makers["TRK_INFO"]()
        assert isinstance(track, telegrams.TrkInfo)
        wanted = round(2 * float(target.speed_mps(tick * scenario.timing.base_tick_ns / 1e9)))
        assert track.target_speed_half_mps == max(wanted, 0)


def test_forces_shown_are_those_of_this_instant() -> None:
    plant = Plant(load("lvshun_tieshan"), 0)
    shown = set()
    for tick in range(400):
        plant.command(1792 if tick < 200 else -900, False)
        plant.status.safety_loop_closed = tick < 350
        force_n = dynamics.applied_n(plant._constants, plant._window, plant._motion)
        assert (plant.traction_n, plant.brake_n) == (max(force_n, 0.0), max(-force_n, 0.0))
        plant.advance()
        force_n = dynamics.applied_n(plant._constants, plant._window, plant._motion)
        assert plant.traction_n - plant.brake_n == force_n
        shown.add(force_n)
    assert len(shown) > 100


def test_positions_are_limited_on_both_sides() -> None:
    most_mm = POSITION_MAX_01MM // 10
    given = (0, 7, -7, most_mm, most_mm + 1, -most_mm, -most_mm - 1, 2**31 - 1, -(2**31))
    limited = [min(max(position_mm * 10, -POSITION_MAX_01MM), POSITION_MAX_01MM) for position_mm in given]
    assert [limited_01mm(position_mm) for position_mm in given] == limited
