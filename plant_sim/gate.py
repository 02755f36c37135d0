"""The train's gate for NOTCH_CMD: a command that fails a check here never reaches the actuators."""

from __future__ import annotations

from collections import Counter

from railhil.bus.layout import CHECK_CORRECT, FLAG_FALSE
from railhil.bus.lifesign import Life, LifeSign
from railhil.bus.telegrams import NotchCmd


class CommandGate:
    """Accepts NOTCH_CMD telegrams only with a fresh life sign, a correct check variable and a notch in range.

    Refusals are counted by cause: ``duplicate``, ``out_of_order``, ``check_variable``, ``out_of_range``; ``gap``
    counts accepted telegrams that came after lost ones.
    """

    def __init__(self, notch_max_256th: int) -> None:
        self.counters: Counter[str] = Counter()
        self._notch_max = notch_max_256th
        self._life = LifeSign()

    def accept(self, command: NotchCmd) -> bool:
        """True when the command is accepted."""
        life = self._life.judge(command.life)
        if not life.fresh:
            return self._refuse(life.value)
        if command.check != CHECK_CORRECT:
            return self._refuse("check_variable")
        if abs(command.notch_256th) > self._notch_max:
            return self._refuse("out_of_range")
        if life is Life.GAP:
            self.counters["gap"] += 1
        self._life.accept(command.life)
        self.counters["accepted"] += 1
        return True

    def _refuse(self, cause: str) -> bool:
        self.counters[cause] += 1
        return False

    @staticmethod
    def emergency(command: NotchCmd) -> bool:
        """Anything other than a valid "false" applies the emergency brake (ANTIVALENT2)."""
        return command.emergency != FLAG_FALSE
