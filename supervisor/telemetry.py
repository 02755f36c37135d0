"""What the controller process has said about its arithmetic: ``telemetry.json`` of a run folder.

The file is written by another process that may have been killed: whatever is wrong with it, a run is judged by its
record alone, so a file that is missing or broken only counts as missing.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

#: Name in the run folder.
FILE_NAME = "telemetry.json"


@dataclass(frozen=True, slots=True)
class Headroom:
    """The quantity of the law that came nearest to the end of its format."""

    name: str
    bits: int


@dataclass(frozen=True, slots=True)
class TelemetrySummary:
    """The part of the telemetry that stands in ``score.json``.

    ``least_headroom`` is None without fixed point; ``cycles`` (program in RAM) and ``cycles_flash`` are those of the
    dearest control period, 0 for float64; ``cycle_share`` is their share of the control period from flash, 1 = all.
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
        """As ``score.json`` has it."""
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

    :raises LookupError, TypeError, ValueError, AttributeError, OverflowError: it is none.
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
        int(cycles["worst_step"]),
        int(cycles["flash"]),
        share,
        int(document["lost_messages"]["total"]),
    )


def read_summary(folder: Path) -> TelemetrySummary | None:
    """Summary of the telemetry in a run folder; None when the controller has left none that can be read."""
    try:
        return summary(json.loads((folder / FILE_NAME).read_text(encoding="utf-8")))
    except (OSError, ValueError, LookupError, TypeError, AttributeError, OverflowError, RecursionError):
        return None
