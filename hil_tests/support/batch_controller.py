"""Controllers of many trains that are stepped together, to hold a law on arrays against the same law on each train."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import NO_BALISE
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.law_controller import LawController
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, BaliseReading
from railhil.controller_node.laws.note import Note
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario


@dataclass(frozen=True, slots=True)
class BatchOutput:
    """``ControlOutput`` for N trains: int64 arrays of shape (N,); flags are common to all."""

    notch_code: NDArray[np.int64]
    notes: tuple[NDArray[np.int64], ...]
    error_raw: NDArray[np.int64]
    overflow_flags: int


def on_wire_batch(note: Note, raw: Any) -> Any:
    """:func:`~railhil.controller_node.laws.note.on_wire` of an int64 array."""
    low, high = note.limits
    value = np.clip(raw >> note.shift, low, high)
    return value & 0xFFFF if note.signed else value


class BatchController(LawController):
    """Controllers of N trains on the same scenario, stepped together; same law, same results as N controllers.

    :param trains: the number N.
    """

    loop, commands, wire = Controller.loop, Controller.commands, Controller.wire

    def __init__(self, scenario: Scenario, trains: int, law: LawSpec | None = None) -> None:
        law = law or LawSpec()
        super().__init__(scenario, law, make(law.arithmetic, batch=True))
        self._trains = trains

    def step(
        self,
        k: int,
        speed_01mmps: NDArray[np.int64],
        position_01mm: NDArray[np.int64],
        balise: BaliseReading[Any] = NO_BALISE,
    ) -> BatchOutput:
        """One control period of all trains; arguments as ``Controller.step``, arrays of shape (N,)."""
        number = self.arithmetic
        inputs, outputs = self._loop.step(k, speed_01mmps, position_01mm, balise)
        told = zip(self._loop.law.notes, outputs.notes, strict=True)
        notes = tuple(on_wire_batch(note, self._raw(value, note.q)) for note, value in told)
        error = number.sub(inputs.set_point, inputs.speed)
        self.telemetry.take(number)
        return BatchOutput(
            notch_code=self._raw(outputs.notch, NOTCH_Q),
            notes=notes,
            error_raw=self._raw(error, SPEED_Q),
            overflow_flags=number.counters.flags,
        )

    def sent(self, notch_code: NDArray[np.int64]) -> None:
        """Like ``Controller.sent``, for all trains, after the first step."""
        self._loop.sent(self.arithmetic.from_raw(notch_code, NOTCH_Q))
        self.telemetry.take(self.arithmetic)

    def _raw(self, value: Any, q: int) -> NDArray[np.int64]:
        return np.broadcast_to(np.asarray(self.arithmetic.raw(value, q), dtype=np.int64), (self._trains,))
