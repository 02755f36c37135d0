"""What people do with railhil beside runs of shipped laws, to compare builds: ``python hil_tests/uses.py``

Needs an installed railhil and, in folders of PYTHONPATH, the distributions of :func:`written` and the toy system of
``hil_tests/data``. Prints one line for each use; two builds agree if they print the same text.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import railhil
from railhil.scenarios.run_spec import RunSpec
from railhil.testing.live import Live

_SCENARIO = "yizhuang_05"
_CARTS = Path(__file__).parent / "data" / "toy_system" / "two_carts_2m.toml"
_FAULTS = ("speed noise 0.05 @20s for 5s seed 3", "TRN_SPEED loss 30% @30s for 2s", "brake weak 0.9 @60s")
#: A law in a distribution of its own, which does more than the shipped one that it extends.
_LAW = '''from railhil.controller_node.ato.laws.ipfc import Ipfc


class Own(Ipfc):
    """IPFC that keeps count of its steps."""

    steps = 0

    def step(self, state, inputs):
        self.steps += 1
        return super().step(state, inputs)
'''
_ENTRY_POINTS = "[railhil.laws]\nown = own_law:Own\n"


def written(folder: Path) -> Path:
    """A distribution with a law, in a new folder for PYTHONPATH."""
    about = folder / "own_law-1.dist-info"
    about.mkdir(parents=True)
    (folder / "own_law.py").write_text(_LAW, encoding="utf-8")
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: own-law\nVersion: 1\n", encoding="utf-8")
    (about / "entry_points.txt").write_text(_ENTRY_POINTS, encoding="utf-8")
    return folder


def _run(scenario: str | Path, folder: Path, bus: str = "local", **given: object) -> str:
    return railhil.run(scenario, bus=bus, out=folder, seed=7, **given).frames_sha256  # type: ignore[arg-type]


def _live(folder: Path) -> str:
    folder.mkdir()
    spec = RunSpec(_SCENARIO, seed=7)
    with Live(spec, spec.load(), folder, lambda run: None) as live:
        live.advance(10.0)
        live.inject(_FAULTS[0].replace("@20s", "@12s"))
        speed = live.read("TRN_SPEED")
        live.finish()
    return f"{speed} {live.result.outcome.frames_sha256 if live.result else None}"


#: Each use, and what makes its line in an empty folder.
USES: dict[str, Callable[[Path], str]] = {
    "over pipes": lambda folder: _run(_SCENARIO, folder, "auto"),
    "over a hub": lambda folder: _run(_SCENARIO, folder, "hub"),
    "a user's law": lambda folder: _run(_SCENARIO, folder, controller="own"),
    "a user's law over pipes": lambda folder: _run(_SCENARIO, folder, "auto", controller="own"),
    "faults in every node, over a hub": lambda folder: _run(_SCENARIO, folder, "hub", faults=_FAULTS),
    "a user's system, plant and law": lambda folder: _run(_CARTS, folder),
    "a user's system over pipes": lambda folder: _run(_CARTS, folder, "auto"),
    "a run by hand, with a fault": _live,
}


def lines() -> Iterator[str]:
    """One line for each use."""
    for name, made in USES.items():
        with tempfile.TemporaryDirectory() as folder:
            yield f"{name}: {made(Path(folder) / 'run')}"


def main() -> int:
    """Print the lines."""
    for line in lines():
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
