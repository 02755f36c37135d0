"""``railhil_ports.h`` of an export against the telegram classes: both are made from the port table."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import pytest

from hil_tests.support.exported import STRICT
from railhil.bus.made import telegrams_of
from railhil.controller_node.export.control import Control
from railhil.controller_node.export.ports import CTelegram, ports_header
from railhil.controller_node.export.text import SHARED, names_of_files, template
from railhil.dbc import Contract, Port, Signal
from railhil.scenarios.system import names, system_named

pytestmark = pytest.mark.needs_compiler

_MASK = 2**64 - 1


def crooked() -> Contract:
    """Numbers of any length, signed or not, that begin at any bit."""
    ports = []
    for seed in range(12):
        number = Random(seed)
        ends = sorted({0, 64, *(number.randrange(1, 64) for _ in range(number.randrange(12)))})
        signals = [
            Signal(
                f"S{first}", first // 8, 7 - first % 8, last - first, signed=bool(number.randrange(2)),
                field_name=f"s{first}", default=int(last - first > 1),
            )
            for first, last in pairwise(ends)
        ]  # fmt: skip
        signals.append(Signal("Life", 9, 6, 4, field_name="life"))
        ports.append(
            Port(f"P{seed}", 0x100 + 8 * seed, 3, 10, "plant", "publish", "", tuple(signals), telegram=f"P{seed}")
        )
    return Contract(500_000, 0x80, 0x88, 10_000_000, tuple(ports), "0" * 64)


def library(
    folder: Path,
    contract: Contract,
    received: Sequence[Port],
    sent: Sequence[Port],
    code: str,
    taken: frozenset[str] = frozenset(),
) -> ctypes.CDLL:
    """The header of such a controller and functions that use it; undefined behaviour ends the process."""
    timing = SimpleNamespace(base_tick_ns=contract.base_tick_ns, port_period_ns={})
    control = SimpleNamespace(
        contract=contract, scenario=SimpleNamespace(timing=timing), ports=lambda: (received, sent)
    )
    folder.mkdir()
    (folder / "railhil_ports.h").write_text(ports_header(cast(Control, control), taken), encoding="ascii")
    (folder / "railhil_mvb.h").write_text(template("railhil_mvb.h", "law"), encoding="ascii")
    (folder / "all.c").write_text(f'#include "railhil_ports.h"\n{code}', encoding="ascii")
    flags = [*STRICT, "-fPIC", "-shared", "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"]
    subprocess.run(["gcc", *flags, "all.c", "-o", "all.so"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "all.so"))


def reading(port: Port) -> str:
    """A C function that gives the members as numbers of 64 bits."""
    telegram = CTelegram(port)
    rows = [f"to[{i}] = (int64_t){telegram.member(signal)};" for i, signal in enumerate(port.signals)]
    opening = f"void read_{port.name}(const unsigned char *process, int64_t *to) {{"
    return "\n".join(
        [opening, f"const {telegram.type} telegram = railhil_unpack_{telegram.name}(process);", *rows, "}\n"]
    )


def writing(port: Port) -> str:
    """C functions that write such numbers, and a new telegram."""
    telegram = CTelegram(port)
    kinds = [f"{telegram.member(signal)} = of[{i}];" for i, signal in enumerate(port.signals)]
    made = f"{telegram.type} telegram = railhil_new_{telegram.name}();"
    packed = f"railhil_pack_{telegram.name}(&telegram, process);"
    return "\n".join(
        [
            f"void new_{port.name}(unsigned char *process) {{ const {made} {packed} }}",
            f"void write_{port.name}(const int64_t *of, unsigned char *process) {{ {made}",
            *kinds,
            f"{packed} }}\n",
        ]
    )


@pytest.mark.parametrize("system", [*names(), "crooked"])
def test_c_reads_and_writes_what_the_telegram_class_does(tmp_path: Path, system: str) -> None:
    """Random process data: every member has the value of its field, and both write the same octets."""
    contract = crooked() if system == "crooked" else system_named(system).contract
    clock = contract.clock_port
    ports = [clock, *(port for port in contract.ports if port != clock)]
    reader = library(tmp_path / "read", contract, ports, [], "".join(map(reading, ports)))
    writer = library(tmp_path / "write", contract, ports[:1], ports[1:], "".join(map(writing, ports[1:])))
    random = Random(3)
    for port in ports:
        kind: Any = telegrams_of([port], __name__)[port.telegram]
        values = (ctypes.c_int64 * len(port.signals))()
        for _ in range(50):
            data = random.randbytes(port.data_bytes)
            telegram = kind.decode(data)
            reader[f"read_{port.name}"](data, values)
            fields = dict(telegram.items())
            assert [value & _MASK for value in values] == [
                fields[signal.field_name] & _MASK for signal in port.signals
            ], port.name
            if port != clock:
                written = ctypes.create_string_buffer(b"\xff" * port.data_bytes, port.data_bytes)
                writer[f"write_{port.name}"](values, written)
                assert written.raw == telegram.encode(), port.name
        if port != clock:
            made = ctypes.create_string_buffer(port.data_bytes)
            writer[f"new_{port.name}"](made)
            assert made.raw == kind().encode(), port.name


def test_enumerations_and_counts_of_life_signs_are_those_of_the_table(tmp_path: Path) -> None:
    contract = system_named("ato").contract
    clock = contract.clock_port
    ports = [clock, *(port for port in contract.ports if port != clock)]
    code = "int values[] = {RAILHIL_EVENT_ENDED_REFUSED, RAILHIL_CTL_CAUSE_TRACK_AGE, RAILHIL_TELEMETRY_INDEX_NONE,\n"
    code += "RAILHIL_CHECK_CORRECT, RAILHIL_FLAG_TRUE, RAILHIL_OVERFLOW_MESSAGE_LOST, RAILHIL_NOTCH_CMD_BYTES};\n"
    code += "int life(const unsigned char *process) { return railhil_clock_life(process); }\n"
    c = library(tmp_path / "c", contract, ports, [], code)
    assert list((ctypes.c_int * 7).in_dll(c, "values")) == [8, 17, 127, 1, 2, 8, 4]
    assert [c.life(bytes([0xFF, 0xFF, 0xFF, last])) for last in (0x00, 0x5A, 0xFF)] == [0, 10, 15]


def test_texts_of_an_enumeration_that_differ_in_signs_alone_are_apart(tmp_path: Path) -> None:
    mode = Signal("LawMode", 0, 7, 8, field_name="mode", codes=("Mode", {"up +": 0, "up -": 1, "Up": 2}))
    clock = Port("CLOCK", 0x100, 1, 10, "plant", "publish", "", (Signal("Life", 3, 3, 4, field_name="life"), mode))
    contract = Contract(500_000, 0x80, 0x88, 10_000_000, (clock,), "0" * 64)
    code = "int values[] = {RAILHIL_MODE_UP, RAILHIL_MODE_UP_1, RAILHIL_MODE_UP_2};\n"
    c = library(tmp_path / "c", contract, [clock], [], code)
    assert list((ctypes.c_int * 3).in_dll(c, "values")) == [0, 1, 2]


def test_no_name_of_the_table_is_one_of_the_c_around_the_law(tmp_path: Path) -> None:
    """A port, values and telegrams that are called like macros, enumerators and types of the exported files."""
    codes = ("Clock", {"ticks": 3, "port": 1, "free": 2})
    mode = Signal("Mode", 0, 7, 8, field_name="mode", codes=codes)
    life = Signal("Life", 3, 3, 4, field_name="life")
    gap = Port("GAP", 0x100, 1, 10, "plant", "publish", "", (life, mode), telegram="Clock")
    frame = Port("CLOCK_TICKS", 0x110, 1, 10, "plant", "publish", "", (life,), telegram="Frame")
    contract = Contract(500_000, 0x80, 0x88, 10_000_000, (gap, frame), "0" * 64)
    taken = names_of_files(SHARED) | {"RAILHIL_CLOCK_TICKS"}
    code = "#define RAILHIL_CLOCK_TICKS 99\nenum { RAILHIL_CLOCK_PORT = 98 };\n"
    code += "int values[] = {RAILHIL_CLOCK_TICKS_3, RAILHIL_CLOCK_PORT_1, RAILHIL_CLOCK_FREE, RAILHIL_GAP_PORT,\n"
    code += "RAILHIL_CLOCK_TICKS_PORT};\n"
    code += "int mode(const unsigned char *process) { return railhil_unpack_clock(process).mode; }\n"
    code += "typedef int railhil_clock_t;\n"
    c = library(tmp_path / "c", contract, [gap, frame], [], code, taken)
    assert list((ctypes.c_int * 5).in_dll(c, "values")) == [3, 1, 2, 0, 1]
    assert c.mode(bytes([7, 0, 0, 0])) == 7
