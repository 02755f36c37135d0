"""CTL_STAT: the state of guard and law, and the telemetry of the law's quantities, one of them in each telegram."""

from __future__ import annotations

from typing import Any, Final

from railhil.bus.layout import flag
from railhil.controller_node.ato.controller import ControlOutput
from railhil.controller_node.laws.note import slots
from railhil.wire.ato import CtlStat, TelemetryHeadroom, TelemetryIndex, WatchLevel

_UINT16_MAX: Final = 0xFFFF


class StatusReports:
    """Makes the answers to the polls of CTL_STAT.

    :param controller: computes the notch; gives its notes and its telemetry.
    """

    def __init__(self, controller: Any) -> None:
        self._controller = controller
        self._slots = slots(controller.notes)
        self._life = 0
        # Twice the index of the quantity reported by the next CTL_STAT, plus one if its maximum is reported.
        self._shown = 0

    def make(
        self, output: ControlOutput | None, level: WatchLevel, lost_flag: int, steps: int, overruns: int
    ) -> CtlStat:
        """The next answer.

        :param output: of the law's last step; None: it has made none.
        :param level: of the guard.
        :param lost_flag: flag of lost messages, 0 for none.
        :param steps: made by the law so far.
        :param overruns: control periods left out so far.
        """
        self._life = (self._life + 1) & 0xF
        if output is None:
            return CtlStat(overflow_flags=lost_flag, ready=flag(False), life=self._life)
        telemetry = self._controller.telemetry
        index, maximum = divmod(self._shown, 2)
        self._shown = (self._shown + 1) % (2 * min(len(telemetry.quantities), TelemetryIndex.NONE))
        quantity = telemetry.row(index)
        headroom_bits = TelemetryHeadroom.UNUSED if quantity.headroom_bits is None else quantity.headroom_bits
        extreme_raw = (quantity.maximum_raw if maximum else quantity.minimum_raw) or 0
        told = self._slots
        return CtlStat(
            note1=output.notes[told["Note1"]] if "Note1" in told else 0,
            ladder_level=level,
            overflow_flags=output.overflow_flags | lost_flag,
            note2=output.notes[told["Note2"]] if "Note2" in told else 0,
            note3=output.notes[told["Note3"]] if "Note3" in told else 0,
            step_count=steps & 0xFFFF,
            step_cycles=min(output.cycles, _UINT16_MAX),
            # After a left shift by the headroom, the larger extreme fills an int32.
            telemetry_extreme=(extreme_raw << headroom_bits) >> 16,
            telemetry_index=index,
            telemetry_maximum=maximum,
            telemetry_headroom_bits=headroom_bits,
            telemetry_wrapped=int(quantity.wraps > 0),
            telemetry_saturated=int(quantity.saturations > 0),
            telemetry_zero_division=int(quantity.zero_divisions > 0),
            overruns=min(overruns, 255),
            life=self._life,
        )
