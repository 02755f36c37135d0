"""SHA-256 of the frame logs of every law in every arithmetic, of every fault of the catalogues and of every shipped
scenario, and of what hunts find, to compare builds, Pythons, processors and versions:
``hil_tests/data/frames_sha256.txt`` has all lines.

``python hil_tests/hashes.py [--law LAW] [--arithmetic A] [--one-process] [--sample N --day DAY] [GROUP ...]`` needs
only an installed railhil (a hunt pyarrow, too) and prints one line for each run: its name and the SHA-256, or
``refused`` where a law has no such arithmetic, or a fault needs more than one process. A group is a system (its laws),
``faults``, ``shipped`` or ``hunts``. All runs are made in this process (``--bus local``), but for branches of least
cases. With ``--sample N`` it makes every N-th run only, those of the day (:func:`choose`).
"""

from __future__ import annotations

import argparse
import hashlib
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import railhil
from railhil.controller_node import arithmetic as arithmetics
from railhil.judge.reactions.catalogue import catalogue_of
from railhil.scenarios.load import names
from railhil.scenarios.system import system_named

_DATA = Path(__file__).parent / "data"


class Line(Protocol):
    """What has a line of the list."""

    def sha256(self) -> str:
        """Its SHA-256, or ``refused``."""


@dataclass(frozen=True)
class Run:
    """A run of a shipped scenario; without a law or an arithmetic, with the usual one."""

    scenario: str
    seed: int = 0
    law: str | None = None
    arithmetic: str | None = None
    faults: tuple[str, ...] = ()
    perturbed: bool = False

    def sha256(self) -> str:
        """SHA-256 of ``frames.log``, or ``refused``."""
        with tempfile.TemporaryDirectory() as folder:
            try:
                outcome = railhil.run(
                    self.scenario, controller=self.law, arithmetic=self.arithmetic, seed=self.seed,
                    faults=list(self.faults), perturbed=self.perturbed, bus="local", out=Path(folder) / "run",
                )  # fmt: skip
            except railhil.InputError:
                return "refused"
            return outcome.frames_sha256


@dataclass(frozen=True)
class Hunt:
    """A short hunt in a scenario file of ``hil_tests/data``, with the usual law, and what else is asked for.

    ``shrinks``: its cases are shrunk; the branches of their runs are processes of their own.
    """

    scenario: str
    asked: Mapping[str, Any]
    shrinks: bool = True

    def sha256(self) -> str:
        """SHA-256 of ``cases.jsonl`` and of the files of ``found/``, one after the other."""
        with tempfile.TemporaryDirectory() as folder:
            # A found file names its scenario by the way from its folder to it.
            scenario = shutil.copy(_DATA / self.scenario, folder)
            made = railhil.hunt(scenario, out=Path(folder) / "hunt", shrink=self.shrinks, **self.asked).folder
            files = [made / "cases.jsonl", *sorted((made / "found").glob("*.toml"))]
            return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


#: Perturbed runs of every law of a system in every arithmetic.
PERTURBED = (
    ("ato", Run("yizhuang_05", 7)),
    (
        "ato",
        Run("lvshun_tieshan_worn_wheels", 1416, faults=("speed noise 0.05 @20s for 5s seed 3", "brake weak 0.9 @100s")),
    ),
    ("hst1", Run("hst_short", 7, faults=("train.lag scale 1.7 @20s for 30s",))),
    ("emu3", Run("emu3_short", 7)),
    ("stop", Run("yizhuang_stop_slide", 7)),
    ("stop", Run("yizhuang_stop_closed", 8)),
    ("line", Run("four_stops", 7, faults=("dwell hold 20s @stop 2",))),
)
#: Named as a group: the catalogues of faults, each with the run of its system.
FAULTS = "faults"
_FAULTY = {
    "ato": Run("yizhuang_05", arithmetic="iq"),
    "hst1": Run("hst_short"),
    "emu3": Run("emu3_short"),
    "stop": Run("yizhuang_stop"),
    "line": Run("four_stops"),
}
#: Named as a group: every scenario as it is shipped.
SHIPPED = "shipped"
#: Named as a group: margins of sentences; a least case.
HUNTS = "hunts"
_HUNTS = {
    "pairs": Hunt(
        "pairs.toml", {"requirements": _DATA / "hunted_margins.toml", "runs": 4, "strategy": "swarm"}, shrinks=False
    ),
    "faults": Hunt("hunted.toml", {"only": "CUT", "runs": 2, "seed": 3}),
}


def choose(names: Sequence[str], share: int, day: str) -> set[str]:
    """One of ``share`` names, rounded up: those whose SHA-256 together with the day is the smallest.

    Every day has its own names, so that each one has its turn; the same day has the same ones everywhere.

    :param day: as ``2026-11-27``.
    """
    ranked = sorted(names, key=lambda name: hashlib.sha256(f"{day} {name}".encode()).digest())
    return set(ranked[: -(-len(ranked) // share)])


def runs(
    groups: Sequence[str], law_only: str | None = None, arithmetic_only: str | None = None, one_process: bool = False
) -> dict[str, Line]:
    """Each run by its name; of these groups, this law and this arithmetic only, if any are named. Entries of a
    catalogue and shipped scenarios have the law and the arithmetic of their own, hunts the usual ones.

    :param one_process: without what starts further processes.
    """
    made: dict[str, Line] = {}
    for system, run in PERTURBED:
        if not groups or system in groups:
            laws = system_named(system).law_names()
            for law in laws if law_only is None else [law for law in laws if law == law_only]:
                for arithmetic in arithmetics.names() if arithmetic_only is None else [arithmetic_only]:
                    name = f"{run.scenario} {law} {arithmetic} {run.seed}"
                    made[name] = replace(run, law=law, arithmetic=arithmetic, perturbed=True)
    every = not (groups or law_only or arithmetic_only)
    if every or FAULTS in groups:
        for system, run in _FAULTY.items():
            for entry in catalogue_of(system_named(system)):
                if entry.faults:
                    law = entry.law or None
                    made[f"{FAULTS} {run.scenario} {entry.id}"] = replace(run, law=law, faults=entry.faults)
    if every or SHIPPED in groups:
        made |= {f"{SHIPPED} {scenario}": Run(scenario) for scenario in names()}
    usual = system_named("ato")
    has_usual = law_only in (None, usual.law) and arithmetic_only in (None, usual.arithmetic)
    if HUNTS in groups or (not groups and has_usual):
        made |= {f"{HUNTS} {name}": hunt for name, hunt in _HUNTS.items() if not (one_process and hunt.shrinks)}
    return made


def main() -> int:
    """Print the lines."""
    parser = argparse.ArgumentParser(prog="python hil_tests/hashes.py", description=__doc__.splitlines()[0])
    parser.add_argument(
        "groups", nargs="*", metavar="GROUP", help=f"only these systems, {FAULTS}, {SHIPPED} or {HUNTS}"
    )
    parser.add_argument("--law", help="only the runs of this law")
    parser.add_argument("--arithmetic", choices=arithmetics.names(), help="only the runs in this arithmetic")
    parser.add_argument("--sample", type=int, default=1, metavar="N", help="one run of N only, chosen by the day")
    parser.add_argument("--one-process", action="store_true", help="only what needs no other process")
    parser.add_argument("--day", default="", metavar="YYYY-MM-DD", help="the day of the sample")
    options = parser.parse_args()
    made = runs(options.groups, options.law, options.arithmetic, options.one_process)
    chosen = choose(list(made), options.sample, options.day)
    for name, run in made.items():
        if name in chosen:
            print(name, run.sha256(), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
