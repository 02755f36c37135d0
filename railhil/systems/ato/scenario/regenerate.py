"""Recompute the target speed curve of a scenario:
``python -m railhil.systems.ato.scenario.regenerate NAME... [--write]``.

Shipped scenarios contain the precomputed curve, so that loading is quick and the curve does not depend on the versions
of numerical libraries. This command recomputes it from ``[target.generate]`` and prints the target file, or writes it
over the shipped one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from railhil.common.errors import InputError, Words
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import RUNS, find
from railhil.systems.ato.scenario.model import TargetCurve
from railhil.systems.ato.scenario.schema import GenerateTable
from railhil.systems.ato.scenario.train_files import generate_target, read_parts


def target_file_text(curve: TargetCurve, limits: GenerateTable, command: str) -> str:
    """Text of a target file: the limits used to generate it, and the nodes.

    :param command: module and arguments that write it.
    """
    lines = [
        f"# Made by: python -m {command}",
        "nodes_s_mps2 = [",
        *(f"    [{time_s!r}, {accel!r}]," for time_s, accel in curve.nodes),
        "]",
        "",
        "[generate]",
        *(f"{key} = {value!r}" for key, value in limits.model_dump(exclude={"coast"}).items()),
        *(["coast = true"] if limits.coast else []),
    ]
    return "\n".join(lines) + "\n"


def target_texts(path: Path) -> dict[str, str]:
    """The text of the target file of a scenario, by its name.

    :raises InputError: the scenario is wrong.
    """
    parts = read_parts(path)
    curve, limits = generate_target(parts)[0], parts.file.target.generate
    assert limits is not None
    command = f"railhil.systems.ato.scenario.regenerate {parts.file.name} --write"
    return {parts.file.name: target_file_text(curve, limits, command)}


def regenerate(
    parser: argparse.ArgumentParser, texts_of: Callable[[Path], Mapping[str, str]], arguments: list[str] | None
) -> int:
    """Print or write the target files of scenarios; returns the exit code.

    :param parser: without arguments. :param texts_of: like :func:`target_texts`.
    """
    parser.add_argument("scenario", nargs="+", help="shipped name, or path of a scenario that generates its curves")
    parser.add_argument("--write", action="store_true", help="write data/targets/<name>.toml instead of printing")
    options = parser.parse_args(arguments)
    try:
        for path in map(find, options.scenario):
            if options.write and path.parent != RUNS:
                raise InputError(path, "--write", Words("is a file of your own"), "shipped names; redirect the output")
            for name, text in texts_of(path).items():
                if options.write:
                    (DATA / "targets" / f"{name}.toml").write_text(text, encoding="utf-8")
                else:
                    sys.stdout.write(text)
    except InputError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Recompute the target speed curves of scenarios."""
    parser = argparse.ArgumentParser(prog="python -m railhil.systems.ato.scenario.regenerate", description=main.__doc__)
    return regenerate(parser, target_texts, arguments)


if __name__ == "__main__":
    sys.exit(main())
