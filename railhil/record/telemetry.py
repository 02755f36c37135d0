"""The controller's reports on itself: its name, its arithmetic, and the memory that its law leaves.

:func:`read_kept` and similar functions read ``telemetry.json`` of a run folder. Another process has written it, and it
may be missing or damaged. The verdict does not depend on it, only on the record. A controller that was started
elsewhere leaves no file here; its status telegrams then give slightly less information.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

import numpy as np

from railhil.bus.codes import ControllerFlag
from railhil.bus.ident import CtlIdent
from railhil.record.notes import ReportedNote, Status
from railhil.record.run_folder import TELEMETRY
from railhil.record.trace import Trace
from railhil.scenarios.memory import MemoryRecord
from railhil.scenarios.run_spec import StartUp


@dataclass(frozen=True, slots=True)
class Kept:
    """The memory that the law wants to keep: key and values. ``used``: the place of the record that it began with
    (empty: none). ``refused``: places that it could not use, by name, with the fault and its description."""

    key: str
    values: dict[str, Any]
    used: str
    refused: dict[str, tuple[str, str]]


def kept_of(document: Mapping[str, Any]) -> Kept:
    """The document made by :func:`railhil.controller_node.laws.memory.kept`.

    :raises LookupError, TypeError, ValueError: something else.
    """
    refused = {str(one["slot"]): (str(one["fault"]), str(one["detail"])) for one in document["refused"]}
    return Kept(str(document["key"]), dict(document["values"]), str(document["used"]), refused)


#: :meth:`Learned.as_json` of a run after which nothing was kept.
NOTHING_LEARNED: Mapping[str, Any] = {"memory_used": None, "memory_refused": {}, "memory_after_sha256": None}


@dataclass(frozen=True, slots=True)
class Learned:
    """Memory left by a run: the values that its law wants to keep, and their record; None: the law has learned from
    this run before."""

    kept: Kept
    record: MemoryRecord | None

    def as_json(self) -> dict[str, Any]:
        """For the certificate: the stored record that the law used, the faults of other records, and the new record."""
        return {
            "memory_used": self.kept.used,
            "memory_refused": {slot: list(why) for slot, why in self.kept.refused.items()},
            "memory_after_sha256": None if self.record is None else self.record.sha256,
        }


UNKNOWN: Final = "unknown"
#: Keys of a run that the handshake of the controller confirms, with its fields; 0 there: not stated.
_CONFIRMED: Final = {"controller": "law", "arithmetic": "arithmetic", "indexing": "indexing"}


def reported(start_up: StartUp, trace: Trace) -> dict[str, str]:
    """Corrections of the values that were asked for, by key of a run; empty if the controller has confirmed them.

    A foreign controller that states its values has confirmed them: others are refused at the handshake.
    """
    if not start_up.joins:
        return {}
    ident = trace.ident(CtlIdent)
    found = {key: UNKNOWN for key, field in _CONFIRMED.items() if ident is None or not getattr(ident, field)}
    return found | ({"controller": start_up.controller_name} if start_up.controller_name else {})


@dataclass(frozen=True, slots=True)
class Headroom:
    """The quantity of the law that came closest to the limit of its format."""

    name: str
    bits: int


@dataclass(frozen=True, slots=True)
class TelemetrySummary:
    """The part of the telemetry that is written to ``score.json``.

    ``least_headroom`` is None without fixed point; ``cycles`` (program in RAM) and ``cycles_flash`` (in flash) are
    those of one control period, 0 for float64; ``cycle_share`` is ``cycles_flash`` as a share of the control period (1
    = all).
    """

    wraps: int
    saturations: int
    zero_divisions: int
    least_headroom: Headroom | None
    cycles: int
    cycles_flash: int
    cycle_share: float
    lost_messages: int

    def as_json(self) -> dict[str, Any]:
        """As in ``score.json``."""
        return asdict(self)

    def sentence(self) -> str:
        """One line for the terminal."""
        least = self.least_headroom
        words = [f"least headroom {least.bits} bit ({least.name})" if least else "no fixed point"]
        words += [f"{self.wraps} wraps", f"{self.saturations} saturations"]
        if self.zero_divisions:
            words.append(f"{self.zero_divisions} divisions by zero")
        if self.lost_messages:
            words.append(f"{self.lost_messages} messages lost")
        if self.cycles:
            words.append(f"{self.cycles} C28x cycles a step in RAM, {self.cycles_flash} from flash")
            words.append(f"{self.cycle_share:.4%} of the control period")
        return ", ".join(words)


def summary(document: dict[str, Any]) -> TelemetrySummary:
    """Summary of a telemetry document.

    :raises LookupError, TypeError, ValueError, AttributeError, OverflowError: it is not a telemetry document.
    """
    bits = [
        Headroom(str(row["name"]), int(row["headroom_bits"]))
        for row in document["quantities"]
        if row["headroom_bits"] is not None
    ]
    totals, cycles = document["totals"], document["cycles"]
    share = float(cycles["share"])
    if not math.isfinite(share):
        raise ValueError(f"share of the control period: found {share}, allowed a number")
    return TelemetrySummary(
        int(totals["wraps"]),
        int(totals["saturations"]),
        int(totals["zero_divisions"]),
        min(bits, key=lambda least: least.bits, default=None),
        int(cycles["ram"]),
        int(cycles["flash"]),
        share,
        int(document["lost_messages"]["total"]),
    )


@dataclass(frozen=True, slots=True)
class LawOrigin:
    """Declaration of a law: the source of its own parameters, and the perturbed runs (name of the scenario, seeds) from
    which they were chosen."""

    text: str
    design_seeds: Mapping[str, range]


def law_origin(document: dict[str, Any]) -> LawOrigin:
    """Origin from a telemetry document, or from the output of ``python -m railhil.controller_node --check``.

    :raises LookupError, TypeError, ValueError, AttributeError: it is neither.
    """
    seeds = {str(name): range(*map(int, numbers)) for name, numbers in document["design_seeds"].items()}
    return LawOrigin(str(document["parameters_origin"]), seeds)


_F = TypeVar("_F")


def _read(folder: Path, made: Callable[[dict[str, Any]], _F]) -> _F | None:
    """``made`` applied to the telemetry in a run folder; None if there is no readable telemetry."""
    try:
        return made(json.loads((folder / TELEMETRY).read_text(encoding="utf-8")))
    except (OSError, ValueError, LookupError, TypeError, AttributeError, OverflowError, RecursionError):
        return None


def read_summary(folder: Path) -> TelemetrySummary | None:
    """Summary of the telemetry in a run folder; None if there is no readable telemetry."""
    return _read(folder, summary)


def read_origin(folder: Path) -> LawOrigin | None:
    """Origin of the law's own parameters from a run folder; None if the controller has not written it there."""
    return _read(folder, law_origin)


def read_notes(folder: Path, status: Status | None) -> tuple[ReportedNote, ...] | None:
    """The notes of its own that the law sends, from a run folder; None if the controller has not declared them there.

    :param status: the status telegram of the system; None: it has none, and so no law has notes.
    """
    declared = Status("").declared if status is None else status.declared
    return _read(folder, lambda document: declared(document["notes"]))


def read_kept(folder: Path) -> Kept | None:
    """The memory that the law wants to keep, from a run folder; None if there is none."""
    return _read(folder, lambda document: kept_of(document["memory"]))


@dataclass(frozen=True, slots=True)
class ShownTelemetry:
    """The telemetry in ``score.json`` if there is no file: from the recorded status telegrams.

    ``source``: their port. ``happened``: names of the flags that were set. ``cycles``: of one control period, program
    in RAM, 0 for float64 and if not reported. ``quantities``: each as last reported, up to one rotation before
    the end; ``index`` is its row in the controller's own ``telemetry.json``. Raw extremes (rounded down to the
    bits that a telegram carries) and headroom are None if not yet reported, if the quantity was always 0, and without
    fixed point.
    """

    source: str
    happened: tuple[str, ...]
    least_headroom: Headroom | None
    cycles: int
    quantities: tuple[dict[str, int | bool | None], ...]

    def as_json(self) -> dict[str, Any]:
        """As in ``score.json``; ``source`` distinguishes it from :class:`TelemetrySummary`."""
        return asdict(self)

    def sentence(self) -> str:
        """One line for the terminal."""
        least = self.least_headroom
        words = [", ".join(self.happened) or "no overflow", f"as {self.source} tells it"]
        if self.quantities:
            words.insert(0, f"least headroom {least.bits} bit ({least.name})" if least else "no fixed point")
        return ", ".join(words)


#: Signals of a status telegram that reports the quantities of the law in turn, after the word ``Telemetry``.
_IN_TURNS = ("Index", "Maximum", "Extreme", "Headroom", "Wrapped", "Saturated", "ZeroDivision")
#: Words of the wire contract for an index of no quantity, and for the headroom of a quantity that was always 0.
_NO_QUANTITY, _NO_HEADROOM = "none", "unused"


def shown_telemetry(trace: Trace, status: Status | None) -> ShownTelemetry | None:
    """Telemetry from the recorded status telegrams; None if they report none, or no such telegram was recorded.

    :param status: the status telegram of the system; None: it has none.
    """
    if status is None or not status.flags or not trace.count(status.port):
        return None
    in_turns = all(trace.has(status.port, f"Telemetry{name}") for name in _IN_TURNS)
    quantities = _quantities(trace, status.port) if in_turns else ()
    if in_turns and not quantities:
        return None
    flags = int(np.bitwise_or.reduce(trace.raw(status.port, status.flags)))
    return ShownTelemetry(
        status.port,
        tuple((flag.name or "").lower() for flag in ControllerFlag if flag & flags),
        min(
            (
                Headroom(f"quantity {row['index']}", bits)
                for row in quantities
                if (bits := row["headroom_bits"]) is not None
            ),
            key=lambda least: least.bits,
            default=None,
        ),
        int(trace.raw(status.port, "StepCycles").max()) if trace.has(status.port, "StepCycles") else 0,
        quantities,
    )


def _quantities(trace: Trace, port: str) -> tuple[dict[str, int | bool | None], ...]:
    """Each quantity as last reported, by its number."""
    shown: dict[int, dict[str, int | bool | None]] = {}
    for index, maximum, extreme, bits, *events in zip(
        *(trace.raw(port, f"Telemetry{name}").tolist() for name in _IN_TURNS), strict=True
    ):
        if trace.word(port, "TelemetryIndex", index) != _NO_QUANTITY:
            row = shown.setdefault(index, {"index": index, "minimum_raw": None, "maximum_raw": None})
            known = trace.word(port, "TelemetryHeadroom", bits) != _NO_HEADROOM
            row["maximum_raw" if maximum else "minimum_raw"] = extreme << 16 >> bits if known else None
            row["headroom_bits"] = bits if known else None
            row.update(zip(("wrapped", "saturated", "zero_division"), map(bool, events), strict=True))
    return tuple(shown[index] for index in sorted(shown))
