"""The train's gate for NOTCH_CMD: nothing that fails a check here ever reaches the actuators."""

from __future__ import annotations

from collections import Counter

from bus.layout import CHECK_CORRECT, FLAG_FALSE
from bus.telegrams import NotchCmd

#: Counter steps up to this are a gap (lost telegrams); beyond, the telegram counts as one from the past.
_MAX_LIFE_STEP = 7


class CommandGate:
    """Whitelist of NOTCH_CMD telegrams: fresh life sign, check variable correct, notch in range.

    Refusals are counted by cause: ``duplicate``, ``out_of_order``, ``check_variable``, ``out_of_range``; ``gap``
    counts accepted telegrams that came after lost ones.
    """

    def __init__(self, notch_max_256th: int) -> None:
        self.counters: Counter[str] = Counter()
        self._notch_max = notch_max_256th
        self._life = -1

    def accept(self, command: NotchCmd) -> bool:
        """True when the command may act."""
        if self._life >= 0:
            step = (command.life - self._life) & 0xF
            if step == 0:
                return self._refuse("duplicate")
            if step > _MAX_LIFE_STEP:
                return self._refuse("out_of_order")
            if step > 1:
                self.counters["gap"] += 1
        if command.check != CHECK_CORRECT:
            return self._refuse("check_variable")
        if abs(command.notch_256th) > self._notch_max:
            return self._refuse("out_of_range")
        self._life = command.life
        self.counters["accepted"] += 1
        return True

    def _refuse(self, cause: str) -> bool:
        self.counters[cause] += 1
        return False

    @staticmethod
    def emergency(command: NotchCmd) -> bool:
        """Everything but a clear "false" applies the emergency brake (ANTIVALENT2)."""
        return command.emergency != FLAG_FALSE
