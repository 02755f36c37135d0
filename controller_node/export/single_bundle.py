"""All files of an export in single precision: the law, its arithmetic, a log, and a program that recomputes the log."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from railhil.common.errors import InputError, Words
from railhil.controller_node.export.single import SingleSource, single_source
from railhil.controller_node.export.source import c_name
from railhil.controller_node.export.templates import template
from railhil.controller_node.program.leaves import leaves
from railhil.controller_node.vector.controller import VectorController
from railhil.controller_node.vector.law import Interface, raw_range
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Control periods of the log, and every how many of them other commands were sent.
_PERIODS = 400
_SENT_EVERY = 37


@dataclass(frozen=True, slots=True)
class SingleBundle:
    """The files by name, in the order of their listing, and the source."""

    source: SingleSource
    files: dict[str, str]


def single_bundle(scenario: AnyScenario, law: LawSpec) -> SingleBundle:
    """The files for a law on a scenario; the same bytes for the same law, parameters and scenario.

    :param law: in ``float32``.
    :raises InputError: the law cannot be made, or not be written in C.
    """
    controller = VectorController(scenario, law)
    interface = controller.interface
    try:
        name = c_name(law.controller)
        source = single_source(name, controller.program, interface, f"law {law.controller}, scenario {scenario.name}")
    except ValueError as error:
        allowed = "operations of the arithmetic that single precision has"
        raise InputError("controller", law.controller, Words(str(error)), allowed) from error
    places = {
        "READINGS": str(len(interface.readings)),
        "COMMANDS": str(len(interface.commands)),
        "NOTES": str(len(interface.notes)),
    }
    return SingleBundle(
        source,
        {
            f"{name}.c": source.source,
            f"{name}.h": source.header,
            "railhil_f32.h": template("railhil_f32.h", name),
            f"{name}_log.txt": _log(controller, interface),
            "railhil_single.c": template("railhil_single.c", name, **places),
            "Makefile": template("Makefile.single", name),
        },
    )


def _log(controller: VectorController, interface: Interface) -> str:
    """What the law in Python answers to smooth and sudden readings over their ranges."""
    lines = []
    told = [item.safe for item in interface.commands]
    for k, raws in enumerate(_readings(interface)):
        output = controller.step(raws)
        sent = k % _SENT_EVERY == _SENT_EVERY - 1
        if sent:
            controller.sent(*told)
        state = [_word(value) for _, value in leaves(controller.state)]
        flag = 2 if sent else int(k == 0)
        numbers = (flag, *raws, *told, *output.commands, *output.notes, *state)
        lines.append(" ".join(f"{number & 0xFFFFFFFF:08x}" for number in numbers))
    return "\n".join(lines) + "\n"


def _word(value: float) -> int:
    word: int = struct.unpack("<I", struct.pack("<f", value))[0]
    return word


def _readings(interface: Interface) -> Iterator[Sequence[int]]:
    """Each reading swings over a part of its range, all of them in step, with a small wave of its own and jumps."""
    ranges = [raw_range(item.telegram, item.field) for item in interface.readings]
    for k in range(_PERIODS):
        swing = 0.25 + 0.2 * math.sin(k / 40.0)
        row = []
        for i, (low, high) in enumerate(ranges):
            part = swing + 0.0005 * math.sin(k * 1.7 + i) + (0.3 if k % 90 == 89 else 0.0)
            row.append(min(high, max(low, low + round((high - low) * part))))
        yield row
