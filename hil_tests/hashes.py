"""SHA-256 of the frame logs of every law in every arithmetic, and of every fault of the catalogue, to compare builds,
Pythons and processors.

``python hil_tests/hashes.py [--law LAW] [--arithmetic A] [--sample N --day DAY] [SYSTEM ...]`` needs only an installed
railhil and prints one line for each run: scenario, law, arithmetic, seed, SHA-256, or why the law refuses that
arithmetic; for ``faults`` in place of a system, entry, SHA-256 or why the entry needs more than one process. Two
machines agree if they print the same text. All runs are made in this process (``--bus local``). With ``--sample N`` it
makes every N-th run only, those of the day (:func:`choose`).
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import railhil
from railhil.controller_node import arithmetic as arithmetics
from railhil.scenarios.system import system_named
from railhil.supervisor.reactions.catalogue import Entry, catalogue


@dataclass(frozen=True)
class Run:
    """A short perturbed run."""

    system: str
    scenario: str
    seed: int
    faults: tuple[str, ...] = ()

    def head(self, law: str, arithmetic: str) -> str:
        """What the line of the run with this law begins with."""
        return f"{self.scenario} {law} {arithmetic} {self.seed}"

    def line(self, law: str, arithmetic: str) -> str:
        """The line of the run with this law."""
        head = self.head(law, arithmetic)
        with tempfile.TemporaryDirectory() as folder:
            try:
                outcome = railhil.run(
                    self.scenario, controller=law, arithmetic=arithmetic, seed=self.seed, faults=list(self.faults),
                    perturbed=True, bus="local", out=Path(folder) / "run",
                )  # fmt: skip
            except railhil.InputError as error:
                return f"{head} refused: {error}"
            return f"{head} {outcome.frames_sha256}"


RUNS = (
    Run("ato", "yizhuang_05", 7),
    Run("ato", "lvshun_tieshan_worn_wheels", 1416, ("speed noise 0.05 @20s for 5s seed 3", "brake weak 0.9 @100s")),
    Run("hst1", "hst_short", 7, ("train.lag scale 1.7 @20s for 30s",)),
    Run("emu3", "emu3_short", 7),
    Run("stop", "yizhuang_stop_slide", 7),
    Run("stop", "yizhuang_stop_closed", 8),
)


#: Named as a system: the catalogue of faults of ``ato``, with this run.
FAULTS = "faults"
_FAULTY = Run("ato", "yizhuang_05", 0)


def fault_line(entry: Entry) -> str:
    """The line of one entry of the catalogue."""
    return f"{entry.id} {replace(_FAULTY, faults=entry.faults).line(entry.law or 'ipfc', 'iq')}"


def choose(names: Sequence[str], share: int, day: str) -> set[str]:
    """One of ``share`` names, rounded up: those whose SHA-256 together with the day is the smallest.

    Every day has its own names, so that each one has its turn; the same day has the same ones everywhere.

    :param day: as ``2026-11-27``.
    """
    ranked = sorted(names, key=lambda name: hashlib.sha256(f"{day} {name}".encode()).digest())
    return set(ranked[: -(-len(ranked) // share)])


def runs(systems: Sequence[str], law_only: str | None, arithmetic_only: str | None) -> dict[str, Callable[[], str]]:
    """What makes the line of each run, by the name of the run; of these systems, this law and this arithmetic only, if
    any are named. Entries of the catalogue have the law and the arithmetic of their own."""
    made: dict[str, Callable[[], str]] = {}
    for run in RUNS:
        if not systems or run.system in systems:
            laws = system_named(run.system).law_names()
            for law in laws if law_only is None else [law for law in laws if law == law_only]:
                for arithmetic in arithmetics.names() if arithmetic_only is None else [arithmetic_only]:
                    made[run.head(law, arithmetic)] = partial(run.line, law, arithmetic)
    if FAULTS in systems or not (systems or law_only or arithmetic_only):
        made |= {entry.id: partial(fault_line, entry) for entry in catalogue() if entry.faults}
    return made


def lines(
    systems: Sequence[str], law: str | None, arithmetic: str | None, share: int = 1, day: str = ""
) -> Iterator[str]:
    """One line for each run (:func:`runs`); of one of ``share`` runs only, those of the ``day``."""
    made = runs(systems, law, arithmetic)
    chosen = choose(list(made), share, day)
    yield from (line() for name, line in made.items() if name in chosen)


def main() -> int:
    """Print the lines."""
    parser = argparse.ArgumentParser(prog="python hil_tests/hashes.py", description=__doc__.splitlines()[0])
    parser.add_argument("systems", nargs="*", metavar="SYSTEM", help=f"only these systems ({FAULTS}: the catalogue)")
    parser.add_argument("--law", help="only the runs of this law")
    parser.add_argument("--arithmetic", choices=arithmetics.names(), help="only the runs in this arithmetic")
    parser.add_argument("--sample", type=int, default=1, metavar="N", help="one run of N only, chosen by the day")
    parser.add_argument("--day", default="", metavar="YYYY-MM-DD", help="the day of the sample")
    options = parser.parse_args()
    for line in lines(options.systems, options.law, options.arithmetic, options.sample, options.day):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
