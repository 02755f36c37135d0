"""Recompute the target speed curves of a line's first leg:
``python -m railhil.systems.line.scenario.regenerate NAME... --write``.

It writes the files that ``route.target_files`` of a shipped scenario names and that no scenario of ``ato`` has, so that
loading the line is quick and its curves do not depend on the versions of numerical libraries.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from railhil.common.errors import InputError
from railhil.scenarios.layers import DATA, Layers
from railhil.scenarios.load import RUNS, find
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.regenerate import target_file_text
from railhil.systems.ato.scenario.schema import GenerateTable
from railhil.systems.line.scenario.model import LineScenario


def target_texts(path: Path) -> dict[str, str]:
    """The text of each target file of a scenario's first leg, by its name.

    :raises InputError: the scenario is wrong.
    """
    route = Layers(path).merge()["route"]
    scenario = system_named("line").scenario_kind.read(Layers(path, ["route.target_files=[]"]))
    assert isinstance(scenario, LineScenario)
    limits = GenerateTable.model_validate(route.get("generate", {}))
    command = f"railhil.systems.line.scenario.regenerate {path.stem} --write"
    names = route.get("target_files", [])
    return {
        name: target_file_text(section.target, limits, command)
        for name, section in zip(names, scenario.sections, strict=False)
    }


def main(arguments: list[str] | None = None) -> int:
    """Recompute the target speed curves of lines."""
    parser = argparse.ArgumentParser(
        prog="python -m railhil.systems.line.scenario.regenerate", description=main.__doc__
    )
    parser.add_argument("scenario", nargs="+", help="shipped name of a line with route.target_files")
    parser.add_argument("--write", action="store_true", help="write data/targets/<name>.toml instead of printing")
    options = parser.parse_args(arguments)
    try:
        for name in options.scenario:
            path = find(name)
            for target, text in target_texts(path).items():
                if (RUNS / f"{target}.toml").is_file():
                    # The curve of a single run is that of its own command.
                    continue
                if options.write:
                    (DATA / "targets" / f"{target}.toml").write_text(text, encoding="utf-8")
                else:
                    sys.stdout.write(text)
    except InputError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
