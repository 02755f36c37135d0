"""Telegram classes and enumerations made from a port table, in which each signal is written once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field, make_dataclass
from enum import IntEnum
from typing import Any

from railhil.bus.layout import Telegram
from railhil.dbc import Port
from railhil.dbc.drawing import described


def telegrams_of(ports: Iterable[Port], module: str) -> dict[str, Any]:
    """The telegram classes of some ports and the enumerations of their signals, by name.

    A class has the fields that the signals of its port name, in the order of the table. Ports with a shared layout have
    a common base class.

    :param module: the module that will have them.
    :raises TypeError: fields of a port have the same name, or a name that Python does not allow.
    """
    made: dict[str, Any] = {}
    for port in ports:
        for name, members in port.codes.items():
            made[name] = IntEnum(name, members, module=module)
        if not port.layout:
            made[port.telegram] = _class(port.telegram, port, module, {"PORT": port.name, "_port": port})
            continue
        if port.layout not in made:
            made[port.layout] = _class(port.layout, port, module, {})
        made[port.telegram] = bound = made[port.layout].bound(port, port.telegram)
        bound.__module__, bound.__doc__ = module, described(port)
    return made


def _class(name: str, port: Port, module: str, members: dict[str, Any]) -> Any:
    fields = [(signal.field_name, int, field(default=signal.default)) for signal in port.signals]
    made: Any = make_dataclass(
        name, fields, bases=(Telegram,), namespace={**members, "__doc__": described(port)}, slots=True
    )
    # From Python 3.12 on, make_dataclass names the module that calls it.
    made.__module__ = module
    return made
