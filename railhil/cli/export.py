"""``railhil export``: a recorded run as files of other tools."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from railhil.common.errors import InputError, Words
from railhil.common.extras import allow_asammdf, missing_library
from railhil.common.output import Output
from railhil.common.user_files import refuse_unwritable, whole_file
from railhil.judge.record import checked_record
from railhil.record.hash_list import check_free
from railhil.report.files.content import Content, parsed_start
from railhil.scenarios.options import add_option

_ROOM = "railhil.report.files"


class _Format(NamedTuple):
    """Module and function that write a kind of file, its extra (empty: needs none), and its name in the run folder."""

    writer: str
    extra: str
    file: str
    help: str


_FORMATS = {
    "mf4": _Format("mf4_file:write_mf4", "mdf", "run.mf4", "ASAM MDF 4.11: frames, decoded telegrams, signals"),
    "mcap": _Format("mcap_file:write_mcap", "mcap", "run.mcap", "MCAP: telegrams and signals as ROS 2 messages"),
    "parquet": _Format("parquet_file:write_parquet", "parquet", "run.parquet", "Parquet: signals with units"),
    "telegrams": _Format(
        "parquet_file:write_telegrams", "parquet", "telegrams.parquet", "Parquet: each telegram with its signals"
    ),
    "csv": _Format("csv_file:write_csv", "", "run.csv", "CSV: signals, with certificate and units"),
    "blf": _Format("frames_file:write_blf_file", "", "run.blf", "BLF: frames, with the times of --start"),
    "asc": _Format("frames_file:write_asc", "", "run.asc", "Vector ASC: frames, with the times of the run"),
    "lichtblick": _Format("layouts:write_lichtblick", "", "lichtblick.json", "layout of Lichtblick for run.mcap"),
    "plotjuggler": _Format("layouts:write_plotjuggler", "", "plotjuggler.xml", "layout of PlotJuggler for run.mcap"),
    "asammdf": _Format("layouts:write_asammdf", "", "run.dspf", "display file of asammdf for run.mf4"),
}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "export",
        examples=[
            "railhil export runs/mine --csv",
            "railhil export runs/mine --mf4 --parquet --out files",
        ],
    )
    add_option(parser, "log")
    for name, kind in _FORMATS.items():
        extra = f" (needs the extra [{kind.extra}])" if kind.extra else ""
        parser.add_argument(f"--{name}", action="store_true", help=f"{kind.help}{extra}")
    parser.add_argument(
        "--start", metavar="TIME", help="instant of the run's time 0, with its zone: 2026-11-22T18:42:55Z"
    )
    note = ", or the file if there is only one"
    add_option(parser, "--out DIR", note, metavar="PATH", usual="the run folder")


def work(namespace: argparse.Namespace) -> int:
    """Write the files and print their paths."""
    wanted = [name for name in _FORMATS if getattr(namespace, name)]
    if not wanted:
        raise InputError(
            "command line", "format", Words(), f"one or more of {', '.join(f'--{name}' for name in _FORMATS)}"
        )
    start = None if namespace.start is None else parsed_start(namespace.start)
    if "blf" in wanted and start is None:
        raise InputError("command line", "--blf", Words("no --start"), "--start TIME; without it use frames.blf")
    extras = list(dict.fromkeys(_FORMATS[name].extra for name in wanted if _FORMATS[name].extra))
    writers = {name: _writer(_FORMATS[name], extras) for name in wanted}
    content = Content(checked_record(namespace.log, None), start)
    for note in content.record.unused:
        Output(stderr=True).say(note)
    for name, path in _places(namespace.out, content.record.log.parent, wanted).items():
        check_free("--out", path, [content.record.log])
        with refuse_unwritable("--out", path, "file"):
            path.parent.mkdir(parents=True, exist_ok=True)
            with whole_file(path) as draft:
                writers[name](content, draft)
        Output().say(str(path))
    return 0


def _writer(kind: _Format, extras: Sequence[str]) -> Callable[[Content, Path], None]:
    """The function that writes a kind of file.

    :param extras: of all kinds that are asked for.
    :raises InputError: libraries of these extras are missing.
    """
    module, _, name = kind.writer.partition(":")
    allow_asammdf()
    try:
        writer: Callable[[Content, Path], None] = getattr(import_module(f"{_ROOM}.{module}"), name)
    except ImportError as error:
        raise missing_library("railhil export", error, *extras) from None
    return writer


def _places(out: str | None, folder: Path, wanted: list[str]) -> dict[str, Path]:
    """Folder of each file."""
    if out is not None and not out.strip():
        raise InputError("command line", "--out", out, "name of a folder or file")
    place = folder if out is None else Path(out)
    if (
        out is not None
        and len(wanted) == 1
        and not place.is_dir()
        and place.suffix.lower() == Path(_FORMATS[wanted[0]].file).suffix
    ):
        return {wanted[0]: place}
    return {name: place / _FORMATS[name].file for name in wanted}
