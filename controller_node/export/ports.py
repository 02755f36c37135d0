"""The controller's ports in C, from the port table: enumerations, one structure for each telegram, its packing.

A structure has a member for each signal, with the name of its field; the C written by hand knows no position, width or
number of a telegram.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from railhil.bus.codes import ControllerFlag
from railhil.bus.mvb import master_word
from railhil.bus.responder import slow_port
from railhil.bus.schedule import Schedule
from railhil.controller_node.export.control import Control
from railhil.controller_node.export.text import SHARED, Names, comment, header, names_of_files
from railhil.controller_node.program.model import identifier
from railhil.dbc import Port, Signal
from railhil.dbc.contract import ANTIVALENT_VALUES, CHECK_VALUES, snake_case

#: Longest integer in bits of a member that does not need 64.
_LONG_BITS = 32
_OCTET = 8
#: Longest expression in one line.
_COLUMNS = 70


class CTelegram:
    """The telegram of a port, or of all ports with the same layout, as a C structure.

    ``name``: in ``railhil_NAME_t``, ``railhil_unpack_NAME``, ``railhil_pack_NAME`` and ``railhil_new_NAME``;
    ``members``: C identifiers by the signals' field names. The structure is ``railhil_NAME_telegram_t`` where
    ``railhil_NAME_t`` is a type of the C around the law.
    """

    def __init__(self, port: Port) -> None:
        self._port = port
        self.name = snake_case(port.layout or port.telegram)
        self.type = f"railhil_{self.name}_t"
        if self.type in names_of_files(SHARED):
            self.type = f"railhil_{self.name}_telegram_t"
        names = Names()
        self.members = {signal.field_name: names.new(signal.field_name) for signal in port.signals}

    def member(self, signal: Signal) -> str:
        """A signal in the variable ``telegram``."""
        return f"telegram.{self.members[signal.field_name]}"

    def set(self, signal: Signal, value: str) -> str:
        """Statement that gives a signal an int32."""
        kind = _kind(signal)
        return f"{self.member(signal)} = {value if kind == 'int32_t' else f'({kind}){value}'};"

    def structure(self, ports: Sequence[str]) -> list[str]:
        """The structure in C.

        :param ports: names of the ports that have it.
        """
        rows = [
            f"    {_kind(signal)} {self.members[signal.field_name]}; /* {_words(signal)} */"
            for signal in self._port.signals
        ]
        return [f"/* {', '.join(ports)} */", "typedef struct {", *rows, f"}} {self.type};", ""]

    def unpack(self) -> list[str]:
        """The function that reads process data."""
        lines = [f"static inline {self.type} railhil_unpack_{self.name}(const unsigned char *process)", "{"]
        lines.append(f"    {self.type} telegram;")
        for signal in self._port.signals:
            wide = signal.length > _LONG_BITS
            integer = "uint64_t" if wide else "uint32_t"
            raw = _joined([_taken(integer, *part) for part in _parts(signal)])
            if signal.signed:
                raw = f"railhil_signed{'_wide' if wide else ''}({raw}, {signal.length})"
            elif _kind(signal) == "int32_t":
                raw = f"(int32_t)({raw})"
            lines.append(f"    {self.member(signal)} = {raw};")
        return [*lines, "    return telegram;", "}", ""]

    def new(self) -> list[str]:
        """The function that makes a new telegram."""
        given = [
            f".{self.members[signal.field_name]} = {signal.default}" for signal in self._port.signals if signal.default
        ]
        lines = [f"static inline {self.type} railhil_new_{self.name}(void)", "{"]
        lines.append(f"    const {self.type} telegram = {{{_joined(given or ['0'], ',')}}};")
        return [*lines, "    return telegram;", "}", ""]

    def pack(self) -> list[str]:
        """The function that writes process data: the low bits of each member."""
        octets: list[list[str]] = [[] for _ in range(self._port.data_bytes)]
        for signal in self._port.signals:
            integer = "uint64_t" if signal.length > _LONG_BITS else "uint32_t"
            value = f"({integer})telegram->{self.members[signal.field_name]}"
            for octet, width, right, left in _parts(signal):
                moved = f"{value} >> {left}" if left else value
                part = f"({moved} & {(1 << width) - 1:#x}u)"
                octets[octet].append(f"{part} << {right}" if right else part)
        arguments = f"const {self.type} *telegram, unsigned char *process"
        lines = [f"static inline void railhil_pack_{self.name}({arguments})", "{"]
        for octet, parts in enumerate(octets):
            lines.append(f"    process[{octet}] = {f'(unsigned char)({_joined(parts)})' if parts else '0'};")
        return [*lines, "}", ""]


def schedule_of(control: Control) -> Schedule:
    """Periods of the ports of a control's system."""
    timing = control.scenario.timing
    return Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, control.contract)


def slow_port_of(control: Control) -> Port | None:
    """The received port whose life sign counts long silences."""
    return slow_port(control.ports()[0], control.contract.clock_port, schedule_of(control))


def port_constants(ports: Sequence[Port], taken: Set[str]) -> dict[str, str]:
    """Constants in C with the numbers of ports, by the ports' names.

    :param taken: names that are defined elsewhere: a constant of such a name ends in ``_PORT``.
    """
    found: dict[str, str] = {}
    for port in ports:
        constant = f"RAILHIL_{port.name}"
        while constant in taken or constant in found.values():
            constant += "_PORT"
        found[port.name] = constant
    return found


def ports_header(control: Control, taken: Set[str]) -> str:
    """``railhil_ports.h``.

    :param taken: names that are defined in other files.
    :raises ValueError: see :meth:`~railhil.controller_node.export.control.Control.ports`.
    """
    received, sent = control.ports()
    ports = [*received, *sent]
    constants = port_constants(ports, taken)
    octets = {name: f"{constant}_BYTES" for name, constant in constants.items()}
    slow = slow_port_of(control)
    used = {*taken, *constants.values(), *octets.values()}
    return header(
        "RAILHIL_PORTS_H",
        [
            "railhil_ports.h: the controller's ports and their telegrams, from the port table.",
            f"DBC SHA-256 {control.contract.sha256}.",
            "Generated: export again, do not edit. A member is the raw integer of its signal.",
        ],
        ["railhil_mvb.h"],
        [
            *_enumeration("Values of a check variable.", "CHECK", {text: n for n, text in CHECK_VALUES.items()}, used),
            *_enumeration(
                "Values of a flag of two bits.", "FLAG", {text: n for n, text in ANTIVALENT_VALUES.items()}, used
            ),
            *_enumeration("Bits of the overflow flags of a status.", "OVERFLOW", ControllerFlag.__members__, used),
            *_enumerations(ports, used),
            "/* Ports: first those with receive mailboxes, then those that the controller sends. */",
            "enum {",
            *(f"    {constant}," for constant in constants.values()),
            "};",
            f"enum {{ RAILHIL_SINK_COUNT = {len(received)}, RAILHIL_SENT_COUNT = {len(sent)} }};",
            "",
            f"static const railhil_port_t railhil_ports[{len(ports)}] = {{",
            *(_port_row(port) for port in ports),
            "};",
            "",
            "/* Octets of their process data. */",
            "enum {",
            *(f"    {octets[port.name]} = {port.data_bytes}," for port in ports),
            "};",
            "",
            *_telegrams(received, sent),
            "/* Life signs that count time: of the clock port, and of RAILHIL_SLOW_PORT. */",
            *_life("clock", received[0]),
            f"enum {{ RAILHIL_SLOW_PORT = {'-1' if slow is None else constants[slow.name]} }};",
            *_life("slow", slow),
        ],
    )


def _telegrams(received: Sequence[Port], sent: Sequence[Port]) -> Iterator[str]:
    """Structures and functions, once for ports of the same layout."""
    found: dict[str, CTelegram] = {}
    users: dict[str, list[str]] = {}
    for port in (*received, *sent):
        made = CTelegram(port)
        found.setdefault(made.name, made)
        users.setdefault(made.name, []).append(port.name)
    for name, telegram in found.items():
        yield from telegram.structure(users[name])
        if any(port.name in users[name] for port in received):
            yield from telegram.unpack()
        if any(port.name in users[name] for port in sent):
            yield from telegram.new()
            yield from telegram.pack()


def _enumerations(ports: Sequence[Port], used: set[str]) -> Iterator[str]:
    found: dict[str, Mapping[str, int]] = {}
    for port in ports:
        found |= port.codes
    for name, members in found.items():
        yield from _enumeration(f"{name} of the port table.", snake_case(name).upper(), members, used)


def _enumeration(words: str, prefix: str, members: Mapping[str, int], used: set[str]) -> list[str]:
    """An enumeration in C.

    :param used: names that are in use; those of the members are added.
    """
    rows = []
    for name, value in members.items():
        constant = f"RAILHIL_{prefix}_{identifier(name).upper()}"
        while constant in used:
            # A name of the C around the law, or of a text that differs in signs or letters' case alone.
            constant += f"_{value}"
        used.add(constant)
        rows.append(f"    {constant} = {value},")
    return [f"/* {words} */", "enum {", *rows, "};", ""]


def _port_row(port: Port) -> str:
    word = int.from_bytes(master_word(port.f_code, port.address))
    return f"    {{UINT32_C({port.address:#x}), UINT32_C({word:#x}), {port.data_bytes}}}, /* {port.name} */"


def _life(name: str, port: Port | None) -> list[str]:
    opening = [f"static inline int railhil_{name}_life(const unsigned char *process)", "{"]
    if port is None or port.life is None:
        return [*opening, "    (void)process;", "    return 0;", "}", ""]
    telegram = CTelegram(port)
    member = telegram.members[port.life.field_name]
    return [*opening, f"    return (int)railhil_unpack_{telegram.name}(process).{member};", "}", ""]


def _kind(signal: Signal) -> str:
    """Type of a member: the narrowest that holds the signal, of at least 32 bits."""
    if signal.length > _LONG_BITS:
        return "int64_t" if signal.signed else "uint64_t"
    return "uint32_t" if signal.length == _LONG_BITS and not signal.signed else "int32_t"


def _words(signal: Signal) -> str:
    """Comment of a member: signal, scale and unit, range."""
    unit = "" if signal.unit == "1" else signal.unit
    scale = " ".join(filter(None, (f"{signal.scale:g}", unit)))
    low, high = signal.raw_range
    words = (signal.name, "" if scale == "1" else f"1 is {scale}", f"{low} to {high}")
    return comment(", ".join(filter(None, words)))


def _parts(signal: Signal) -> Iterator[tuple[int, int, int, int]]:
    """A signal's part in each octet: octet, number of bits, bits to its right in the octet, and in the signal."""
    end = signal.first_bit + signal.length
    for octet in range(signal.first_bit // _OCTET, (end - 1) // _OCTET + 1):
        first, last = max(signal.first_bit, _OCTET * octet), min(end, _OCTET * (octet + 1))
        yield octet, last - first, _OCTET * (octet + 1) - last, end - last


def _taken(integer: str, octet: int, width: int, right: int, left: int) -> str:
    """A part of a signal, moved to its place in the number."""
    part = f"process[{octet}]"
    if right:
        part = f"{part} >> {right}"
    if width + right < _OCTET:
        part = f"{part} & {(1 << width) - 1:#x}u"
    part = f"({integer}){part}" if part.endswith("]") else f"({integer})({part})"
    return f"{part} << {left}" if left else part


def _joined(parts: Sequence[str], operator: str = " |") -> str:
    """An expression of several parts, a line for each if one line would be long."""
    if len(line := f"{operator} ".join(parts)) < _COLUMNS:
        return line
    return "\n        " + f"{operator}\n        ".join(parts)
