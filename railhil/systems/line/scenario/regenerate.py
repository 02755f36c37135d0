"""Recompute the target speed curves of a line's first leg:
``python -m railhil.systems.line.scenario.regenerate NAME... --write``.

It writes the files that ``route.target_files`` of a shipped scenario names and that no scenario of ``ato`` has, so that
loading the line is quick and its curves do not depend on the versions of numerical libraries.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from railhil.scenarios.layers import Layers
from railhil.scenarios.load import RUNS
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.regenerate import regenerate, target_file_text
from railhil.systems.ato.scenario.schema import GenerateTable
from railhil.systems.line.scenario.model import LineScenario


def target_texts(path: Path) -> dict[str, str]:
    """The text of each target file of a scenario's first leg that no scenario of ``ato`` has, by its name.

    :raises InputError: the scenario is wrong.
    """
    route = Layers(path).merge()["route"]
    scenario = system_named("line").scenario_kind.read(Layers(path, ["route.target_files=[]"]))
    assert isinstance(scenario, LineScenario)
    limits = GenerateTable.model_validate(route.get("generate", {}))
    command = f"railhil.systems.line.scenario.regenerate {path.stem} --write"
    named = zip(route.get("target_files", []), scenario.sections, strict=False)
    # The curve of a single run is that of its own command.
    own = [(name, section) for name, section in named if not (RUNS / f"{name}.toml").is_file()]
    return {name: target_file_text(section.target, limits, command) for name, section in own}


def main(arguments: list[str] | None = None) -> int:
    """Recompute the target speed curves of lines."""
    parser = argparse.ArgumentParser(
        prog="python -m railhil.systems.line.scenario.regenerate", description=main.__doc__
    )
    return regenerate(parser, target_texts, arguments)


if __name__ == "__main__":
    sys.exit(main())
