"""What a run over a line is not, said once: report, text, page and help take it from here."""

from __future__ import annotations

from typing import Final

#: Of the train protection, which a section run by itself does not have.
PROTECTION: Final = (
    "the train protection is modelled after the published structure of SUBSET-026-3, 3.13; it is no implementation of "
    "it, and no conformity is claimed"
)
#: Of the fastest curves of its regulation, which a section run by itself does not have either; sections follow.
OVERSPEED: Final = (
    "regulation: a train that is late and takes the shortest running time passes the permitted speed of the train "
    "protection, below its warning: "
)
#: Sentences for ``Scenario.assumptions`` of every line.
STATEMENT: Final = (
    PROTECTION,
    "the timetable is chosen; it is not the real timetable of a line",
    "the train is alone: no other trains, no passenger flow, no reversing but at a turn-back, no line voltage, no "
    "curve resistance, no brake percentages, no adhesion below the guaranteed factor",
)
