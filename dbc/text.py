"""A wire contract as text: the DBC file, and the port table of a record.

A classic telegram of more than 32 bits consists of several CAN frames, so it becomes several DBC messages: one per
block, one for the trailer, and one for the CAN FD form. The check sequences, master words and trailers are signals too,
so that cantools decodes every frame on the bus.

Run folders hold the hash of this text, and their port tables are checked by it: the text of a table must never change.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace

from railhil.dbc.contract import Contract, Port, Signal

_NODES = {"plant": "PLT", "controller": "CTL", "supervisor": "SUP"}
#: Payload lengths of the CAN FD form by F_code; 40 bytes do not exist in CAN FD, 48 do.
FD_BYTES = {0: 8, 1: 8, 2: 16, 3: 24, 4: 48}


@dataclass(frozen=True, slots=True)
class _Message:
    can_id: int
    name: str
    length: int
    sender: str
    comment: str
    cycle_ms: int
    fd: bool
    signals: tuple[Signal, ...]


def _moved(signal: Signal, byte_offset: int) -> Signal:
    return replace(signal, byte=signal.byte + byte_offset)


def _master(byte: int) -> tuple[Signal, ...]:
    return (
        Signal("FCode", byte, 7, 4, comment="F_code of the master word"),
        Signal("Address", byte, 3, 12, comment="Logical address of the master word"),
        Signal("MasterCS", byte + 2, 7, 8, comment="Check sequence of the master word"),
    )


def _single_tail() -> tuple[Signal, ...]:
    return (Signal("CS", 4, 7, 8, comment="Check sequence of the data"), *_master(5))


def _trailer(blocks: int, byte: int) -> tuple[Signal, ...]:
    sums = tuple(Signal(f"CS{k}", byte + k, 7, 8, comment=f"Check sequence of block {k}") for k in range(blocks))
    return (
        *sums,
        Signal("Seq", byte + 4, 7, 4, comment="Telegram counter, for statistics"),
        Signal("Blocks", byte + 4, 3, 4, comment="Number of blocks"),
        *_master(byte + 5),
    )


def _port_messages(port: Port) -> Iterator[_Message]:
    sender = _NODES[port.source]
    cycle_ms = port.period_ns // 1_000_000
    note = f"{port.comment}. MVB F{port.f_code}, {port.mode}."
    if port.single_frame:
        signals = port.signals + _single_tail()
        yield _Message(port.address, port.name, 8, sender, note, cycle_ms, False, signals)
        yield _Message(port.fd_id, f"{port.name}_FD", 8, sender, f"{note} CAN FD form.", cycle_ms, True, signals)
        return
    for block in range(port.blocks):
        part = tuple(_moved(s, -8 * block) for s in port.signals if s.block == block)
        name = port.name if block == 0 else f"{port.name}_B{block}"
        yield _Message(port.address + block, name, 8, sender, f"{note} Block {block}.", cycle_ms, False, part)
    trailer = _trailer(port.blocks, 0)
    yield _Message(port.address + 4, f"{port.name}_TRL", 8, sender, f"{note} Trailer.", cycle_ms, False, trailer)
    everything = port.signals + _trailer(port.blocks, 8 * port.blocks)
    yield _Message(
        port.fd_id, f"{port.name}_FD", FD_BYTES[port.f_code], sender, f"{note} CAN FD form.", cycle_ms, True, everything
    )


def _messages(contract: Contract) -> list[_Message]:
    poll = (Signal("FCode", 0, 7, 4), Signal("Address", 0, 3, 12), Signal("MasterCS", 2, 7, 8))
    status = (Signal("DeviceStatus", 0, 7, 16, comment="Device status word"), *_single_tail())
    messages = [
        _Message(contract.poll_id, "BA_POLL", 3, "PLT", "Master frame of the bus administrator.", 0, False, poll),
        _Message(contract.device_status_id, "DEV_STAT", 8, "Vector__XXX", "Answer to F_code 15.", 0, False, status),
    ]
    for port in contract.ports:
        messages.extend(_port_messages(port))
    return sorted(messages, key=lambda message: message.can_id)


def _number(value: float) -> str:
    return repr(int(value)) if value == int(value) else f"{value:.17g}"


def _signal_line(signal: Signal) -> str:
    low, high = signal.raw_range
    start = signal.byte * 8 + signal.msb
    minimum = low * signal.scale if signal.minimum is None else signal.minimum
    maximum = high * signal.scale if signal.maximum is None else signal.maximum
    sign = "-" if signal.signed else "+"
    return (
        f" SG_ {signal.name} : {start}|{signal.length}@0{sign} ({_number(signal.scale)},0) "
        f'[{_number(minimum)}|{_number(maximum)}] "{signal.unit}" Vector__XXX'
    )


def dbc_text(contract: Contract) -> str:
    """The DBC file for a contract, as text with a final newline."""
    messages = _messages(contract)
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: PLT CTL SUP", ""]
    for message in messages:
        lines.append(f"BO_ {message.can_id} {message.name}: {message.length} {message.sender}")
        lines.extend(_signal_line(signal) for signal in message.signals)
        lines.append("")
    lines.append('CM_ "railhil wire contract: MVB process data on CAN. Written from ports.toml.";')
    for message in messages:
        lines.append(f'CM_ BO_ {message.can_id} "{message.comment}";')
        lines.extend(
            f'CM_ SG_ {message.can_id} {signal.name} "{signal.comment}";'
            for signal in message.signals
            if signal.comment
        )
    lines += [
        'BA_DEF_ "BusType" STRING ;',
        'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;',
        'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG","reserved","reserved",'
        '"reserved","reserved","reserved","reserved","reserved","reserved","reserved","reserved","StandardCAN_FD",'
        '"ExtendedCAN_FD";',
        'BA_DEF_DEF_ "BusType" "CAN FD";',
        'BA_DEF_DEF_ "GenMsgCycleTime" 0;',
        'BA_DEF_DEF_ "VFrameFormat" "StandardCAN";',
        'BA_ "BusType" "CAN FD";',
    ]
    for message in messages:
        lines.append(f'BA_ "GenMsgCycleTime" BO_ {message.can_id} {message.cycle_ms};')
        if message.fd:
            lines.append(f'BA_ "VFrameFormat" BO_ {message.can_id} 14;')
    for message in messages:
        for signal in message.signals:
            if signal.values:
                table = " ".join(f'{key} "{text}"' for key, text in sorted(signal.values.items(), reverse=True))
                lines.append(f"VAL_ {message.can_id} {signal.name} {table} ;")
    return "\n".join(lines) + "\n"


def table_text(contract: Contract) -> str:
    """A port table with all ports of a contract, those of the house too; a record keeps it.

    :returns: TOML; ``load_contract`` makes an equal contract of it.
    """
    lines = [
        "# The wire contract of a run: every port, its telegram and its signals.",
        '# at = "byte.msb:length", bytes counted from the start of the telegram, bit 7 first (Motorola order)',
        "",
        "[bus]",
        f"bit_rate = {contract.bit_rate}",
        f"poll_id = {contract.poll_id:#05x}",
        f"device_status_id = {contract.device_status_id:#05x}",
        f"base_tick_ms = {contract.base_tick_ns // 1_000_000}",
    ]
    for port in contract.ports:
        lines += [
            "",
            "[[port]]",
            f"name = {_quoted(port.name)}",
            f"address = {port.address:#05x}",
            f"f_code = {port.f_code}",
            f"period_ms = {port.period_ns // 1_000_000}",
            f"source = {_quoted(port.source)}",
            f"mode = {_quoted(port.mode)}",
            *(["optional = true"] if port.optional else []),
            f"comment = {_quoted(port.comment)}",
            "signals = [",
            *(f"  {{ {_signal_keys(signal)} }}," for signal in port.signals),
            "]",
        ]
    return "\n".join(lines) + "\n"


def _signal_keys(signal: Signal) -> str:
    """Keys and values of a signal in a port table; a key with the reader's default is left out."""
    keys = {"name": _quoted(signal.name), "at": _quoted(f"{signal.byte}.{signal.msb}:{signal.length}")}
    if signal.signed:
        keys["signed"] = "true"
    if signal.scale != 1.0:
        keys["scale"] = repr(signal.scale)
    if signal.unit:
        keys["unit"] = _quoted(signal.unit)
    for key, bound in (("min", signal.minimum), ("max", signal.maximum)):
        if bound is not None:
            keys[key] = repr(bound)
    if signal.check:
        keys["check"] = _quoted(signal.check)
    elif signal.values:
        keys["values"] = f"{{ {', '.join(f'{key} = {_quoted(text)}' for key, text in signal.values.items())} }}"
    if signal.comment:
        keys["comment"] = _quoted(signal.comment)
    return ", ".join(f"{key} = {value}" for key, value in keys.items())


def _quoted(text: str) -> str:
    """A basic string of TOML, whose escapes are those of JSON."""
    return json.dumps(text, ensure_ascii=False)
