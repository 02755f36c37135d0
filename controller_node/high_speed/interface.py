"""Readings and commands of the laws of high-speed trains on the bus.

Readings, in this order: ``speed`` of each unit (``speed_1``, ... with several), ``ref1`` to ``ref14`` (target speeds in
steps of 0.25 s), ``ref0`` (the present one), ``emergency``. Commands, for each unit: ``u`` and ``mode``.
"""

from __future__ import annotations

from railhil.bus.layout import Telegram
from railhil.controller_node.vector.law import Command, Interface, Note, Reading
from railhil.wire.power_units import NOTES, PREVIEW, SAFE, wire

#: Q of the commands (0.001 m/s2) and of the notes' counts inside a law.
COMMAND_Q = 16
NOTE_COUNT_Q = 8
#: Bounds of the commands, 0.001 m/s2; scenarios may allow less.
_LOWEST, _HIGHEST = -2000, 2000
#: A reading is too old after this many periods without a new telegram.
_STALE_PERIODS = 3


def interface_of(units: int) -> Interface:
    """The interface for a train of one unit or three."""
    ports = wire(units)
    tails = [""] if units == 1 else [f"_{unit}" for unit in range(1, units + 1)]
    speeds = zip(tails, ports.feedback, strict=True)
    commands = zip(tails, ports.commands, strict=True)
    return Interface(
        readings=(
            *(_reading(f"speed{tail}", kind, "speed", "0.01 km/h") for tail, kind in speeds),
            *(_reading(f"ref{j}", ports.reference, f"ref{j}", "0.01 km/h") for j in (*range(1, PREVIEW + 1), 0)),
            _reading("emergency", ports.event, "emergency", ""),
        ),
        commands=tuple(
            command
            for tail, kind in commands
            for command in (
                Command(f"u{tail}", kind, "accel", COMMAND_Q, 0, "0.001 m/s2", _LOWEST, _HIGHEST),
                Command(f"mode{tail}", kind, "mode", 0, safe=SAFE),
            )
        ),
        notes=tuple(
            Note(f"{note}{tail}", f"{note}{unit}", NOTE_COUNT_Q) for unit, tail in enumerate(tails, 1) for note in NOTES
        ),
        status=ports.status,
    )


def _reading(name: str, kind: type[Telegram], field: str, unit: str) -> Reading:
    return Reading(name, kind, field, unit=unit, age_max_ms=_STALE_PERIODS * kind.port().period_ns // 1_000_000)


HST1 = interface_of(1)
EMU3 = interface_of(3)
