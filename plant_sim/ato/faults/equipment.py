"""Faults of the train's equipment: interlocks that open, and the line voltage."""

from __future__ import annotations

from railhil.plant_sim.ato.status import TrainStatus
from railhil.plant_sim.faults.injections import Injections

#: Place -> field of the status that is False while a fault ``off`` is active there.
INTERLOCKS = {
    "power": "power_on",
    "pantograph": "pantograph_up",
    "main_breaker": "main_breaker_closed",
    "doors": "doors_closed_locked",
    "parking_brake": "parking_brake_released",
    "safety_loop": "safety_loop_closed",
}
LINE_VOLTAGE = "line_voltage"


class FaultyEquipment:
    """Sets the status of a train to what the active faults make of it; other fields stay as they are."""

    def __init__(self, injections: Injections) -> None:
        self._injections = injections
        self._faults = injections.at("train", LINE_VOLTAGE, *INTERLOCKS)

    def change(self, status: TrainStatus) -> None:
        """Faults have begun or ended."""
        healthy = TrainStatus()
        for one in self._faults:
            field = INTERLOCKS.get(one.fault.place.name, "line_voltage_percent")
            setattr(status, field, getattr(healthy, field))
        for one in self._faults:
            name = one.fault.place.name
            if name == LINE_VOLTAGE:
                found = one.fault.parameter("share") * 100 if one.active else 100.0
                before, status.line_voltage_percent = (
                    status.line_voltage_percent,
                    min(status.line_voltage_percent, found),
                )
                self._injections.effect(one, found < before, f"{before:g} %", f"{found:g} %")
            elif one.active:
                setattr(status, INTERLOCKS[name], False)
                self._injections.effect(one, True, "true", "false")
            else:
                self._injections.effect(one, False, "", "")
