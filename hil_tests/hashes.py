"""SHA-256 of the frame logs of every law in every arithmetic, of every fault of the catalogues and of every shipped
scenario, to compare builds, Pythons, processors and versions: ``hil_tests/data/frames_sha256.txt`` has all lines.

``python hil_tests/hashes.py [--law LAW] [--arithmetic A] [--sample N --day DAY] [GROUP ...]`` needs only an installed
railhil and prints one line for each run: its name and the SHA-256, or ``refused`` where a law has no such arithmetic,
or a fault needs more than one process. A group is a system (its laws), ``faults`` or ``shipped``. All runs are made in
this process (``--bus local``). With ``--sample N`` it makes every N-th run only, those of the day (:func:`choose`).
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import railhil
from railhil.controller_node import arithmetic as arithmetics
from railhil.judge.reactions.catalogue import catalogue_of
from railhil.scenarios.load import names
from railhil.scenarios.system import system_named


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


def choose(names: Sequence[str], share: int, day: str) -> set[str]:
    """One of ``share`` names, rounded up: those whose SHA-256 together with the day is the smallest.

    Every day has its own names, so that each one has its turn; the same day has the same ones everywhere.

    :param day: as ``2026-11-27``.
    """
    ranked = sorted(names, key=lambda name: hashlib.sha256(f"{day} {name}".encode()).digest())
    return set(ranked[: -(-len(ranked) // share)])


def runs(groups: Sequence[str], law_only: str | None = None, arithmetic_only: str | None = None) -> dict[str, Run]:
    """Each run by its name; of these groups, this law and this arithmetic only, if any are named. Entries of a
    catalogue and shipped scenarios have the law and the arithmetic of their own."""
    made: dict[str, Run] = {}
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
    return made


def main() -> int:
    """Print the lines."""
    parser = argparse.ArgumentParser(prog="python hil_tests/hashes.py", description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=f"only these systems, {FAULTS} or {SHIPPED}")
    parser.add_argument("--law", help="only the runs of this law")
    parser.add_argument("--arithmetic", choices=arithmetics.names(), help="only the runs in this arithmetic")
    parser.add_argument("--sample", type=int, default=1, metavar="N", help="one run of N only, chosen by the day")
    parser.add_argument("--day", default="", metavar="YYYY-MM-DD", help="the day of the sample")
    options = parser.parse_args()
    made = runs(options.groups, options.law, options.arithmetic)
    chosen = choose(list(made), options.sample, options.day)
    for name, run in made.items():
        if name in chosen:
            print(name, run.sha256(), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
