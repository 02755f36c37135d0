"""Headers of the exported controller: its constants (times, identity, the system's own) and eCAN mailboxes."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.bus.ident import Role, make_ident
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import F_DEVICE_STATUS, master_word
from railhil.bus.store import ASSEMBLY_NS
from railhil.bus.telegrams import TimeSync
from railhil.controller_node.ecan import Mailbox
from railhil.controller_node.export.control import Control, Define
from railhil.controller_node.export.ports import schedule_of, slow_port_of
from railhil.controller_node.export.text import Names, comment, header, template, wide
from railhil.dbc import Port


def node_header(name: str, control: Control) -> str:
    """``<law>_node.h``.

    :param name: of the law in C.
    :raises ValueError: see :meth:`~railhil.controller_node.export.control.Control.ports`.
    """
    contract, scenario, law, comments = control.contract, control.scenario, control.law, control.comments(name)
    _, sent = control.ports()
    ident = make_ident(Role.CONTROLLER, scenario.sha256, **law.identity, contract=contract).encode()
    return header(
        f"{name.upper()}_NODE_H",
        [
            f"{name}_node.h: constants of the controller's bus, {comments.constants}.",
            f"{comment(f'Law {law.label}, scenario {scenario.name}, {law.set_points}')}.",
            f"Scenario SHA-256 {scenario.sha256},",
            f"DBC SHA-256 {contract.sha256}.",
            f"Generated: export again, do not edit. Times in simulation time, {comments.units}.",
        ],
        ["railhil_ports.h"],
        [
            *(
                f"#define RAILHIL_{each.name} {each.literal}{f' /* {each.words} */' if each.words else ''}"
                for each in (*_bus(control, sent), *control.constants())
            ),
            "",
            "/* CTL_IDENT: hashes of scenario and DBC (32 bits each), seed (unknown), law and arithmetic, role and",
            " * indexing, version of the wire. */",
            f"static const unsigned char railhil_ident[{len(ident)}] = {{",
            *octets(ident),
            "};",
            "",
            *control.tables(),
        ],
    )


def octets(data: bytes) -> list[str]:
    """Process data as C initialisers, eight per line."""
    return [f"    {', '.join(f'0x{octet:02x}' for octet in data[i : i + 8])}," for i in range(0, len(data), 8)]


def _bus(control: Control, sent: list[Port]) -> list[Define]:
    """Constants of the bus that every controller needs."""
    contract, schedule = control.contract, schedule_of(control)
    # As in the bench's responder: while the clock port fails, the polls of the controller's fastest port count time.
    paced = [port for port in sent if port.period_ns and schedule.ticks(port.name) <= MAX_STEP]
    words = [(schedule.ticks(port.name), int.from_bytes(master_word(port.f_code, port.address))) for port in paced]
    pace_ticks, pace_word = min(words, default=(0, 0))
    clock = contract.clock_port.name
    status_word = int.from_bytes(master_word(F_DEVICE_STATUS, Role.CONTROLLER))
    slow = slow_port_of(control)
    slow_ticks = 0 if slow is None else schedule.ticks(slow.name)
    return [
        Define("POLL_ID", f"UINT32_C({contract.poll_id:#x})", "master frames of the bus administrator"),
        Define("DEVICE_STATUS_ID", f"UINT32_C({contract.device_status_id:#x})"),
        Define("DEVICE_STATUS_WORD", f"UINT32_C({status_word:#x})", "master word of this device's status"),
        Define("BIT_RATE", f"{contract.bit_rate}L", "of the bus, bit/s"),
        Define("BASE_TICK_NS", wide(schedule.base_tick_ns)),
        Define("ASSEMBLY_NS", wide(ASSEMBLY_NS), "in which all blocks of a telegram arrive"),
        Define(
            "FRACTIONS_PER_S", wide(round(1 / dict(TimeSync.signals())["fraction_65536th_s"].scale)), "of TIME_SYNC"
        ),
        Define("CLOCK_TICKS", wide(schedule.ticks(clock)), f"ticks from one {clock} to the next"),
        Define("PACE_TICKS", wide(pace_ticks), "ticks from one poll of RAILHIL_PACE_WORD to the next, 0: none"),
        Define("PACE_WORD", f"UINT32_C({pace_word:#x})"),
        Define("PACE_BEGINS", str(int(control.polls_begin)), "1: if nothing else has begun the time, they do"),
        Define("SLOW_TICKS", wide(slow_ticks), "ticks from one life sign of RAILHIL_SLOW_PORT to the next"),
        Define("GIVEN_COUNT", str(len(control.given)), "inputs of the law"),
        Define("COMMAND_COUNT", str(len(control.told)), "its commands"),
        Define("LIFE_START", f"{control.life_start}u", "life sign before the first telegram that is sent"),
    ]


def mailbox_header(law: str, table: Sequence[Mailbox]) -> str:
    """Text of the header.

    :param table: the checked table, in the order of the mailbox numbers.
    """
    names = Names("RAILHIL_MBX_")
    rows = [
        f"    {{{box.number}, {box.length}, {int(box.transmit)}, {int(box.overwrite)}, {int(box.extended)}, "
        f"UINT32_C({box.can_id:#x}), UINT32_C({box.mask:#x})}}, /* {box.name} */"
        for box in table
    ]
    numbers = [f"#define {names.new(box.name.upper())} {box.number}" for box in table]
    return template("mailboxes.h", law, NUMBERS="\n".join(numbers), COUNT=str(len(table)), ROWS="\n".join(rows))
