"""SHA-256 of the frame logs of every law in every arithmetic, to compare builds, Pythons and processors.

``python hil_tests/hashes.py`` needs only an installed railhil and prints one line for each run: scenario, law,
arithmetic, seed, SHA-256; what a law cannot do says so instead. Two machines agree if their output is the same text.
All runs are made in this process (``--bus local``).
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import railhil
from railhil.controller_node import arithmetic as arithmetics
from railhil.scenarios.system import system_named

#: System, scenario, settings, seed, faults: short runs in which much is drawn.
RUNS: tuple[tuple[str, str, tuple[str, ...], int, tuple[str, ...]], ...] = (
    ("ato", "yizhuang_05", (), 7, ()),
    ("ato", "lvshun_tieshan_worn_wheels", (), 1416, ("speed noise 0.05 @20s for 5s seed 3", "brake weak 0.9 @100s")),
    ("hst1", "hst_short", (), 7, ("train.lag scale 1.7 @20s for 30s",)),
    ("emu3", "emu3_short", (), 7, ()),
    ("stop", "yizhuang_stop_slide", (), 7, ()),
    ("stop", "yizhuang_stop_closed", (), 8, ()),
)


def lines(systems: list[str]) -> Iterator[str]:
    """One line for each run."""
    for system, scenario, settings, seed, faults in RUNS:
        if systems and system not in systems:
            continue
        for law in system_named(system).law_names():
            for arithmetic in arithmetics.names():
                yield f"{scenario} {law} {arithmetic} {seed} {_sha256(scenario, law, arithmetic, settings, seed, faults)}"


def _sha256(
    scenario: str, law: str, arithmetic: str, settings: tuple[str, ...], seed: int, faults: tuple[str, ...]
) -> str:
    with tempfile.TemporaryDirectory() as folder:
        try:
            outcome = railhil.run(
                scenario, controller=law, arithmetic=arithmetic, settings=list(settings), seed=seed, faults=list(faults),
                perturbed=True, bus="local", out=Path(folder) / "run",
            )  # fmt: skip
        except railhil.InputError as error:
            return f"refused: {error}"
        return f"{outcome.frames_sha256}"


def main() -> int:
    """Print the lines."""
    parser = argparse.ArgumentParser(prog="python hil_tests/hashes.py", description=__doc__.splitlines()[0])
    parser.add_argument("systems", nargs="*", help="only these systems")
    for line in lines(parser.parse_args().systems):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
