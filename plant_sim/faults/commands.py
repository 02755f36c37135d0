"""Faults of the notch command as the train's gate receives it: the record of the bus shows what was sent."""

from __future__ import annotations

from dataclasses import replace

from railhil.bus.injector.activity import Activity
from railhil.bus.layout import FLAG_TRUE
from railhil.bus.telegrams import NotchCmd
from railhil.plant_sim.faults.injections import CLEAR, Injections, number_of

_CODES_PER_NOTCH = 256

#: Words of its places.
WORDS = ("value", "stuck", "offset", "scale", "random", "both", CLEAR)


class CommandFaults:
    """Changes NOTCH_CMD telegrams; values are in notches, and keep to the numbers that the signal can hold."""

    def __init__(self, injections: Injections) -> None:
        self._injections = injections
        self._faults = [(one, injections.samples(one)) for one in injections.at("command")]
        self._low, self._high = dict(NotchCmd.signals())["notch_256th"].raw_range
        # Command at the first instant of a fault that keeps it, by the fault's number.
        self._held: dict[int, int] = {}

    def received(self, command: NotchCmd) -> NotchCmd:
        """The command with the faults that are active, in the order of their numbers."""
        for one, source in self._faults:
            if not one.active:
                self._held.pop(one.number, None)
                continue
            changed = self._changed(one, command, source)
            if changed != command:
                self._injections.hit(one, _text(command), _text(changed))
            command = changed
        return command

    def _changed(self, one: Activity, command: NotchCmd, source: object) -> NotchCmd:
        fault, code = one.fault, command.notch_256th
        if fault.what == "value":
            code = self._code(number_of(fault, "value") * _CODES_PER_NOTCH)
        elif fault.what == "offset":
            code = self._code(code + number_of(fault, "error") * _CODES_PER_NOTCH)
        elif fault.what == "scale":
            code = self._code(code * number_of(fault, "factor"))
        elif fault.what == "stuck":
            code = self._held.setdefault(one.number, code)
        elif fault.what == "random":
            code = int(source.integers(self._low, self._high, endpoint=True))  # type: ignore[attr-defined]
        elif fault.what == "both":
            return replace(
                command, notch_256th=self._code(number_of(fault, "value") * _CODES_PER_NOTCH), emergency=FLAG_TRUE
            )
        return replace(command, notch_256th=code)

    def _code(self, value: float) -> int:
        return min(max(round(value), self._low), self._high)


def _text(command: NotchCmd) -> str:
    brake = " emergency" if command.emergency == FLAG_TRUE else ""
    return f"{command.notch_256th}{brake}"
