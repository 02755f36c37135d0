"""``railhil report``: writes ``report.html`` again, from recorded folders."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from pkgutil import resolve_name

from railhil.common.errors import InputError, Words
from railhil.common.extras import missing_library
from railhil.common.output import Output
from railhil.common.user_files import refuse_unwritable
from railhil.judge.record import Record, checked_record
from railhil.record.documents import COMPARISON, FAULT_TABLE, read_comparison
from railhil.record.hash_list import REPORT, check_free, check_hash_list
from railhil.report.noise import Noise
from railhil.report.recorded import check_one_scenario
from railhil.scenarios.options import add_option, add_options

#: Folders with a page of their own: the file by which one is known, and the study that it is of.
_CAMPAIGN, _SEQUENCE = "campaign.json", "sequence.json"
_STUDIES = {
    _CAMPAIGN: "railhil.campaign.study:CAMPAIGN",
    "hunt.json": "railhil.hunt.study:HUNT",
    "learn.json": "railhil.sequences.study:LEARN",
    "probability.json": "railhil.probability.study:PROBABILITY",
}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "report",
        examples=[
            "railhil report runs/mine",
            "railhil report runs/mine runs/other --out both.html",
            "railhil report runs/faults runs/faults-of-another --out faults.html",
        ],
    )
    parser.add_argument(
        "folder",
        nargs="+",
        metavar="DIR",
        help="run folder, or the folder of a comparison, of fault tables, a study or a sequence",
    )
    add_options(parser, "--scenario", "--no-return", "--campaign")
    add_option(parser, "--out FILE", usual="report.html in the folder; of several folders, here")


def work(namespace: argparse.Namespace) -> int:
    """Write the report and print its path."""
    try:
        from railhil.report.page import write_report
    except ImportError as error:
        raise missing_library("railhil report", error, "report") from None
    given = [Path(text) for text in namespace.folder]
    if any((path / FAULT_TABLE).is_file() for path in given):
        from railhil.report.fault_matrix import report_of

        return _write(given, namespace, partial(report_of, given))
    if found := next((name for name in (*_STUDIES, _SEQUENCE) for path in given if (path / name).is_file()), ""):
        return _study(given, namespace, found)
    folders: list[Path] = []
    notes: list[str] = []
    for path in given:
        compared = read_comparison(path) if path.is_dir() else None
        if compared is not None:
            check_hash_list(path, COMPARISON, compared)
        folders += [path] if compared is None else [path / row["folder"] for row in compared["runs"]]
        notes += [] if compared is None else compared.get("notes", [])
    records = [checked_record(str(folder), namespace.scenario) for folder in folders]
    notes += [note for record in records for note in record.notes]
    notes += _no_return(records) if namespace.no_return else []
    check_one_scenario(records)

    def write(out: Path) -> None:
        write_report(records, out, list(dict.fromkeys(notes)), _noise(records, namespace.campaign, out))

    return _write(given, namespace, write)


def _write(given: Sequence[Path], namespace: argparse.Namespace, write: Callable[[Path], None]) -> int:
    """Write the page and print its path."""
    if namespace.out is not None:
        out = Path(namespace.out)
    elif len(given) == 1:
        out = (given[0] if given[0].is_dir() else given[0].parent) / REPORT
    else:
        out = Path(REPORT)
    check_free("--out", out)
    with refuse_unwritable("--out", out, "file"):
        write(out)
    Output().say(str(out))
    return 0


def _noise(records: Sequence[Record], named: Path | None, out: Path) -> list[Noise]:
    """Other runs of the laws, in the campaign that is named, else in one beside the folder of a run or of a comparison.

    :raises InputError: the campaign that is named has none of these laws, or the library that reads it is missing.
    """
    places = dict.fromkeys(place for record in records for place in (record.folder.parent, record.folder.parent.parent))
    folders = [path.parent for place in places for path in sorted(place.glob(f"*/{_CAMPAIGN}"))]
    folders = folders if named is None else [named]
    if not folders:
        return []
    try:
        from railhil.campaign.noise import find_noise
    except ImportError as error:
        if named is None:
            return []
        raise missing_library("--campaign", error, "campaign") from None
    found = find_noise(records, folders, out)
    if named is not None and not found:
        allowed = f"a finished campaign of {records[0].scenario.name} with law and set-points of the run"
        raise InputError("command line", "--campaign", named, allowed)
    return found


def _no_return(records: Sequence[Record]) -> list[str]:
    """Up to when the runs that fail could be saved, a sentence each."""
    from railhil.batch.decision import lost_sentence

    found = ((record, lost_sentence(record)) for record in records)
    return [f"{record.label}: {said}" if len(records) > 1 else said for record, said in found if said]


def _study(given: Sequence[Path], namespace: argparse.Namespace, name: str) -> int:
    """The report of a study.

    :param name: of the file by which it is known.
    """
    kind = name.removesuffix(".json")
    if len(given) > 1 or namespace.scenario is not None:
        found = Words(f"a {kind} beside other folders or --scenario")
        raise InputError("command line", "folder", found, f"one {kind} alone")
    write: Callable[[Path, Path], None]
    try:
        if name == _SEQUENCE:
            write = resolve_name("railhil.sequences.recorded:report_of")
        else:
            from railhil.study import pages

            write = partial(pages.report_of, resolve_name(_STUDIES[name]))
    except ImportError as error:
        raise missing_library(f"railhil report of a {kind}", error, "campaign") from None
    return _write(given, namespace, partial(write, given[0]))
