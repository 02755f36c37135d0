"""Checks whether an FMU is deterministic."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import NamedTuple

from railhil.fmu.names import Input

#: Steps of each of the two runs, and the shares of the command in their equal parts.
TICKS = 4000
_SHARES = (1.0, 0.4, -0.15, 0.6, 0.0, -0.7, -1.0, 0.2)


class Twice(NamedTuple):
    """``same``: two equal runs gave the same; None: unknown. ``why``: the reason if they differ or it is unknown."""

    same: bool | None
    why: str


def outputs_sha256(
    step: Callable[[dict[str, float]], Collection[float]], inputs: Mapping[str, Input], ticks: int = TICKS
) -> str:
    """SHA-256 over all outputs of a new instance after every step, driven by fixed inputs.

    A deterministic FMU gives the same SHA-256 each time.

    :param step: values of the inputs in, outputs out; it raises where the FMU refuses the step.
    """
    digest = hashlib.sha256()
    for tick in range(ticks):
        part = tick * len(_SHARES) // ticks
        found = step({name: _value(number, one, part) for number, (name, one) in enumerate(inputs.items())})
        digest.update(struct.pack(f"<{len(found)}d", *found))
    return digest.hexdigest()


def _value(number: int, one: Input, part: int) -> float:
    """The command follows its shares; each of the other inputs has its other value in one part."""
    if number == 0:
        return one.other * _SHARES[part]
    return one.other if part == number else one.usual


def twice(runs: Iterable[Callable[[], str]], refusal: type[Exception]) -> Twice:
    """Whether two equal runs gave the same.

    :param runs: each gives its :func:`outputs_sha256`.
    :param refusal: raised where the FMU refuses a step.
    """
    try:
        one, other = (run() for run in runs)
    except refusal as error:
        return Twice(None, str(error))
    if one == other:
        return Twice(True, "")
    return Twice(False, f"two equal runs differ (sha256 {one[:16]}, {other[:16]})")
