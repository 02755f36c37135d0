"""What the injectors of one node did: for each fault its instants and hits, each with the value before and after."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from railhil.common.user_files import whole_file
from railhil.faults.activity import Activity
from railhil.faults.language import fault_text

#: Files of a run folder, by node: ``faults-plant.csv``.
FILE_NAME = "faults-{node}.csv"
#: In place of a node, in the name of the log of the faults inside the plant.
INSIDE = "inside-plant"
#: Header of such a file.
COLUMNS = ("fault", "time_ns", "what", "before", "after")


class Hit(NamedTuple):
    """One change: ``fault`` is its number from 1; ``before`` and ``after`` are texts (raw bytes in hex, values)."""

    fault: int
    time_ns: int
    what: str
    before: str
    after: str


class InjectionLog:
    """Hits of one node, in the order of the simulation."""

    def __init__(self) -> None:
        self.hits: list[Hit] = []

    def note(self, activity: Activity, time_ns: int, before: str, after: str) -> None:
        """Note that a fault has changed something, and count it (:meth:`Activity.hit`)."""
        self.hits.append(Hit(activity.number, time_ns, activity.fault.what, before, after))
        activity.hit(time_ns)

    def text(self, activities: Sequence[Activity]) -> str:
        """The file: a row ``begun`` and ``ended`` for each fault that became active, and one for each hit, by time.

        ``begun`` of a fault with values that an operator has given has its text.
        """
        rows = [(hit.time_ns, hit.fault, 1, hit) for hit in self.hits]
        for one in activities:
            if one.begun_ns is not None:
                text = fault_text(one.fault, judging=False) if one.given else ""
                rows.append((one.begun_ns, one.number, 0, Hit(one.number, one.begun_ns, "begun", "", text)))
            if one.ended_ns is not None and one.begun_ns is not None:
                rows.append((one.ended_ns, one.number, 2, Hit(one.number, one.ended_ns, "ended", "", "")))
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(hit for *_, hit in sorted(rows, key=lambda row: row[:3]))
        return buffer.getvalue()

    def write(self, folder: Path, node: str, activities: Sequence[Activity]) -> None:
        """Write :data:`FILE_NAME` into a run folder."""
        with whole_file(folder / FILE_NAME.format(node=node)) as path:
            path.write_text(self.text(activities), encoding="utf-8")
