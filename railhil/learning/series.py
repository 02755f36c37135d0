"""Speeds and commands of one power unit in a record, and their samples at any sampling period."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.bus.layout import Telegram
from railhil.common.errors import InputError, Words
from railhil.controller_node.vector.law import Interface
from railhil.record.trace import Trace

FloatArray: TypeAlias = NDArray[np.float64]
_KMH = 3.6
#: Grid on which the instant of a change is compared with others, s.
_INSTANT_S = 0.001
#: A command is looked up this often, in the middle between two such instants, because its telegram may come a tick
#: later.
_LOOK_S = 0.1


@dataclass(frozen=True, slots=True)
class Series:
    """``speed_mps`` as sent at ``speed_s``; ``command_mps2`` as sent at ``command_s`` and held until the next one."""

    speed_s: FloatArray
    speed_mps: FloatArray
    command_s: FloatArray
    command_mps2: FloatArray

    def phase_s(self, period_s: float) -> float:
        """Instant within the sampling period at which the law has changed its command most often."""
        changed = self.command_s[1:][np.diff(self.command_mps2) != 0.0]
        places = np.round((changed % period_s) / _INSTANT_S).astype(np.int64) % round(period_s / _INSTANT_S)
        return float(np.bincount(places).argmax()) * _INSTANT_S if len(places) else 0.0

    def sample(self, period_s: float, phase_s: float) -> tuple[FloatArray, FloatArray]:
        """Speeds at the sampling instants and mean commands of the periods that begin there; both (n,).

        Between two telegrams the speed is interpolated.
        """
        begin_s = max(self.speed_s[0], self.command_s[0]) + _LOOK_S
        end_s = min(self.speed_s[-1], self.command_s[-1]) - _LOOK_S
        first, last = np.ceil((begin_s - phase_s) / period_s), np.floor((end_s - phase_s) / period_s)
        instants = phase_s + period_s * np.arange(int(first), int(last) + 1)
        looks = max(1, round(period_s / _LOOK_S))
        within_s = period_s / looks * (np.arange(looks) + 0.5)
        places = np.searchsorted(self.command_s, instants[:-1, None] + within_s, side="right") - 1
        commands = self.command_mps2[places].mean(axis=1)
        return np.interp(instants, self.speed_s, self.speed_mps)[:-1], commands


def read_series(scenario: Any, trace: Trace, unit: int, units: int) -> Series:
    """The series of a power unit.

    :param unit: from 1; with one unit the readings and commands of the interface have no number.
    :raises InputError: the system's laws have no speed and command of that unit, or the record has none of them.
    """
    interface: Interface = scenario.installed_system.part("interface")
    end = f"_{unit}" if units > 1 else ""
    speed = _find_telegram(scenario.system, interface.readings, f"speed{end}")
    command = _find_telegram(scenario.system, interface.commands, f"u{end}")
    for kind, _ in (speed, command):
        if trace.count(kind.PORT) < 2:
            raise InputError("record", kind.PORT, Words("no telegrams"), "a record of a run with its controller")
    return Series(
        trace.times_s(speed[0].PORT),
        trace.values(speed[0].PORT, speed[1]) / _KMH,
        trace.times_s(command[0].PORT),
        trace.values(command[0].PORT, command[1]),
    )


def _find_telegram(system: str, items: Any, name: str) -> tuple[type[Telegram], str]:
    """Telegram and signal of a reading or command."""
    found = next((item for item in items if item.name == name), None)
    if found is None:
        raise InputError("record", "system", system, f"a system whose laws have {name}: hst1 or emu3")
    return found.telegram, dict(found.telegram.signals())[found.field].name
