"""A square wave added to the commands of a law, for a record that a network is trained on (D14).

Without it the record holds only what the law's own feedback does, and a network trained on it controls badly.
"""

from __future__ import annotations

from typing import Any, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.high_speed.core import Core, Move, Sample


class DitherState(NamedTuple, Generic[T]):
    """``inner``: state of the law; ``passed``: samples since the wave last changed; ``offset``: added now, m/s^2."""

    inner: Any
    passed: T
    offset: T


class Dithered(Core[T, DitherState[T]]):
    """A law whose command is changed by plus and minus ``size_mps2``, each for ``samples`` sampling periods.

    The law is told the command that is sent.
    """

    def __init__(self, inner: Core[T, Any], size_mps2: float, samples: int) -> None:
        self.re, self.unit, self.horizon, self._inner = inner.re, inner.unit, inner.horizon, inner
        self._size = self.re.number("dither", size_mps2, "parameters")
        self._last = self.re.number("dither_last", samples - 0.5, "parameters")

    def start(self, sample: Sample[T]) -> DitherState[T]:
        return DitherState(self._inner.start(sample), self.re.zero, self._size)

    def step(self, state: DitherState[T], sample: Sample[T]) -> tuple[DitherState[T], Move[T]]:
        re, ar = self.re, self.re.ar
        inner, move = self._inner.step(state.inner, sample)
        command = re.clip(re.add(move.command, state.offset), sample.lowest, sample.highest)
        counted = re.add(state.passed, re.one)
        over = re.gt(counted, self._last)
        count = ar.where(over, re.zero, counted)
        offset = ar.where(over, re.neg(state.offset), state.offset)
        return DitherState(self._inner.sent(inner, command), count, offset), move._replace(command=command)

    def sent(self, state: DitherState[T], command: T) -> DitherState[T]:
        return state._replace(inner=self._inner.sent(state.inner, command))
