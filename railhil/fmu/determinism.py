"""Checks whether an FMU is deterministic."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Callable
from typing import NamedTuple

from railhil.fmu.instance import Fmu, FmuError
from railhil.fmu.names import Input

#: Steps of each of the two runs, and the shares of the command in their equal parts.
TICKS = 4000
_SHARES = (1.0, 0.4, -0.15, 0.6, 0.0, -0.7, -1.0, 0.2)


class Twice(NamedTuple):
    """``same``: two equal runs gave the same; None: unknown. ``why``: the reason if they differ or it is unknown."""

    same: bool | None
    why: str


def outputs_sha256(fmu: Fmu) -> str:
    """SHA-256 over all outputs of a new instance after every step, driven by fixed inputs.

    A deterministic FMU gives the same SHA-256 each time.

    :raises FmuError: it refuses a step.
    """
    digest = hashlib.sha256()
    inputs = fmu.quantities.inputs
    for tick in range(TICKS):
        part = tick * len(_SHARES) // TICKS
        values = {name: _value(number, one, part) for number, (name, one) in enumerate(inputs.items())}
        found = fmu.step(values, fmu.step_s)
        digest.update(struct.pack(f"<{len(found)}d", *found.values()))
    return digest.hexdigest()


def _value(number: int, one: Input, part: int) -> float:
    """The command follows its shares; each of the other inputs has its other value in one part."""
    if number == 0:
        return one.other * _SHARES[part]
    return one.other if part == number else one.usual


def twice(new: Callable[[], Fmu]) -> Twice:
    """Whether an FMU is deterministic.

    :param new: makes an instance.
    :raises InputError: as ``new``.
    """
    first = new()
    if first.only_once:
        return Twice(None, "not checked: a process can have only one instance of it")
    try:
        one, other = outputs_sha256(first), outputs_sha256(new())
    except FmuError as error:
        return Twice(None, str(error))
    if one == other:
        return Twice(True, "")
    return Twice(False, f"two equal runs differ (sha256 {one[:16]}, {other[:16]})")
