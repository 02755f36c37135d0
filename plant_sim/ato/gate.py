"""The train's gate for NOTCH_CMD: a command that fails a check here never reaches the actuators."""

from __future__ import annotations

from collections import Counter
from typing import Final

from railhil.bus.layout import CHECK_CORRECT, FLAG_FALSE
from railhil.bus.lifesign import Life, LifeSign
from railhil.wire.ato import NotchCmd, WatchCause

#: Number of commands with a wrong check variable among the last :data:`RECENT` that is suspicious.
BAD_FOR_SUSPICION: Final = 3
RECENT = 10
#: Number of recent commands that are searched for old ones.
ORDER = 16
#: Counter of the accepted commands whose step was too large.
NOTCH_STEP: Final = "notch_step"

# Looking up a member of an enum costs as much as a call on CPython 3.11, and this runs with every command.
_NO_SUSPICION: Final = WatchCause.NONE
_NEXT: Final = Life.NEXT
_GAP: Final = Life.GAP
_RECENT_MASK: Final = (1 << RECENT) - 1
_ORDER_MASK: Final = (1 << ORDER) - 1


class CommandGate:
    """Accepts NOTCH_CMD telegrams only with a fresh life sign, a correct check variable and a notch in range.

    Refusals are counted by cause: ``duplicate``, ``out_of_order``, ``check_variable``, ``out_of_range``; ``gap``
    counts accepted telegrams that came after lost ones, ``notch_step`` those whose step was too large.

    ``suspicion``: level of the watch that the last telegram demands. If two controllers answer in turn, good and old
    commands alternate.

    :param step_max_256th: largest step from one command to the next; after a larger step the train follows the command
        only if it brakes.
    :param two_sources_max: number of old commands, each directly after a good one, from which on two controllers are
        suspected.
    """

    def __init__(self, notch_max_256th: int, step_max_256th: int, two_sources_max: int) -> None:
        self.counters: Counter[str] = Counter()
        self.suspicion = WatchCause.NONE
        #: Notch of the last accepted command that the train follows, 1/256.
        self.notch_256th = 0
        self._notch_max = notch_max_256th
        self._step_max = step_max_256th
        self._two_sources_max = two_sources_max
        self._life = LifeSign()
        # The last commands, newest in bit 0: 1 for a wrong check variable, and for an old one after a good one.
        self._bad = 0
        self._disorder = 0
        self._was_good = False
        # Notch of the last command in range.
        self._given_256th = 0

    def accept(self, command: NotchCmd) -> bool:
        """True when the command is accepted; sets ``suspicion`` and ``notch_256th``."""
        was_good = self._was_good
        self.suspicion = _NO_SUSPICION
        self._was_good = False
        if self._bad or self._disorder:
            self._bad = self._bad << 1 & _RECENT_MASK
            self._disorder = self._disorder << 1 & _ORDER_MASK
        life = self._life.judge(command.life)
        if life is not _NEXT and not life.fresh:
            if was_good and life is Life.OUT_OF_ORDER:
                self._disorder |= 1
                if self._disorder.bit_count() >= self._two_sources_max:
                    self.suspicion = WatchCause.TWO_SOURCES
            return self._refuse(life.value)
        if command.check != CHECK_CORRECT:
            self._bad |= 1
            if self._bad.bit_count() >= BAD_FOR_SUSPICION:
                self.suspicion = WatchCause.BAD_COMMANDS
            return self._refuse("check_variable")
        notch = command.notch_256th
        if abs(notch) > self._notch_max:
            self.suspicion = WatchCause.NOTCH_RANGE
            return self._refuse("out_of_range")
        if life is _GAP:
            self.counters["gap"] += 1
        self._life.accept(command.life)
        self.counters["accepted"] += 1
        self._was_good = True
        if abs(notch - self._given_256th) > self._step_max:
            self.counters[NOTCH_STEP] += 1
            self.suspicion = WatchCause.NOTCH_STEP
            self.notch_256th = min(notch, self.notch_256th)
        else:
            self.notch_256th = notch
        self._given_256th = notch
        return True

    def _refuse(self, cause: str) -> bool:
        self.counters[cause] += 1
        return False

    @staticmethod
    def emergency(command: NotchCmd) -> bool:
        """Anything other than a valid "false" applies the emergency brake (ANTIVALENT2), whatever the notch."""
        return command.emergency != FLAG_FALSE
