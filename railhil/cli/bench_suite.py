"""``railhil bench-suite``: planted defects for searches, and the table of what searches found."""

from __future__ import annotations

import argparse
from pathlib import Path

from railhil.common.errors import InputError, OptionError, Words
from railhil.common.exit_codes import PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "bench-suite",
        examples=[
            "railhil bench-suite suite",
            "railhil bench-suite suite --plant m02",
            "railhil bench-suite --score hunts/m02-1 hunts/m02-2",
        ],
    )
    parser.add_argument("folder", metavar="FOLDER", nargs="?", type=Path, help="write the suite into this folder")
    parser.add_argument(
        "--plant", metavar="ID", help="copy the installed railhil with this defect to FOLDER/planted/ID"
    )
    parser.add_argument(
        "--score", metavar="SEARCH", nargs="+", type=Path, help="hunts, or folders with entry.toml: print the table"
    )
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Write, plant or score."""
    folder, console = namespace.folder, Output(stderr=False)
    if namespace.score:
        if folder is not None or namespace.plant:
            raise OptionError("--score", "used without DIR and --plant")
        # Not before: a hunt needs the libraries of an extra.
        from railhil.hunt.leaderboard import leaderboard, table_of

        rows = leaderboard(namespace.score)
        if namespace.json:
            print_json({"rows": rows})
        else:
            console.print(table_of(rows))
        return PASS
    from railhil.hunt.defects import plant, write_suite

    if folder is None:
        raise InputError("command line", "DIR", Words("none"), "a folder for the suite, or --score FOLDER...")
    files = write_suite(folder)
    place = plant(namespace.plant, folder) if namespace.plant else None
    if namespace.json:
        print_json({"files": files, "planted": None if place is None else str(place)})
    else:
        console.say(f"{folder}: {', '.join(files)}")
        if place is not None:
            console.say(f"PYTHONPATH={place} railhil hunt ...: with the defect {namespace.plant}")
    return PASS
