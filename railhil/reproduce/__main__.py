"""``python -m railhil.reproduce`` (the same as ``railhil reproduce``)."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path

from railhil.charts.figure import Figure
from railhil.common.command_line import OneLineParser, run_command, seed_list
from railhil.common.errors import InputError, OptionError, did_you_mean
from railhil.common.exit_codes import INVALID, PASS, run_guarded
from railhil.common.extras import install_command
from railhil.common.output import Output, number, table
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import check_writable, refuse_unwritable
from railhil.reproduce.comparison import FOLLOWS, FOLLOWS_NOT, IN_PART, Table
from railhil.reproduce.document import PAGE, RUNS, make_document, write_page
from railhil.reproduce.measurement import measure_paper
from railhil.reproduce.paper import PAPERS, Paper, Results, find_paper
from railhil.scenarios.options import add_option
from railhil.study.engines import processors

_SEEDS_MAX = 1000
_COLOURS = {FOLLOWS: "green", IN_PART: "yellow", FOLLOWS_NOT: "red"}
_EXIT_CODES = """\
exit codes:
  0    the protocol was run and printed, whatever the runs and the paper came to
  2    usage or bad input; one line says what was found and what is allowed
  3    INVALID: one of the runs is not trustworthy
  4    TOOL ERROR: a defect of the bench, or the result could not be written"""


def _one_of(names: Sequence[str]) -> Callable[[str], str]:
    """An option's type: one of the names, else the nearest of them is suggested."""

    def name(text: str) -> str:
        if text not in names:
            hint = did_you_mean(text, names)
            raise argparse.ArgumentTypeError(f"found {text}, allowed {', '.join(names)}{f' ({hint})' if hint else ''}")
        return text

    return name


def _seeds(text: str) -> tuple[int, ...]:
    """An option's type."""
    found = tuple(seed_list(text, _SEEDS_MAX))
    if len(set(found)) < len(found):
        raise argparse.ArgumentTypeError(f"found {text}, allowed each seed once")
    return found


def arguments(papers: Mapping[str, str] = PAPERS) -> argparse.ArgumentParser:
    """Command line of the reproductions."""
    names = tuple(papers)
    parser = OneLineParser(
        prog="railhil reproduce",
        examples=[
            "railhil reproduce",
            "railhil reproduce ipfc --out ipfc",
        ],
        description="Run the protocol of a paper and print its tables beside the published ones, with what does not "
        "follow and why.",
        epilog=_EXIT_CODES,
    )
    parser.add_argument(
        "paper",
        nargs="?",
        type=_one_of(names),
        choices=names,
        metavar="PAPER",
        help=f"of {', '.join(names)}; without it they are listed",
    )
    add_option(parser, "--seeds", " of the runs", type=_seeds, usual="those of the paper's page")
    add_option(parser, "--jobs", default=processors())
    add_option(parser, "--out DIR", f": {PAGE}, figures (SVG), tables (CSV), results.json", type=Path)
    parser.add_argument("--keep-runs", action="store_true", help="also keep the run folders, in DIR/runs")
    parser.add_argument(
        "--measured", type=Path, metavar="DIR",
        help="store the figures of each run in DIR, and do not make runs again whose figures are there (by the "
        "same code); the protocol can so be run in pieces",
    )  # fmt: skip
    note = ": runs whose names match (* and ? as in file names); others are read from --measured, or left out, which "
    add_option(parser, "--only", f"{note}the page says", metavar="PATTERN")
    add_json_argument(parser)
    return parser


def _folder(out: Path, keep_runs: bool) -> bool:
    """Make the folder of the page if it is not there; returns whether it was made.

    :raises InputError: it cannot be made or written, or it has runs already and is to keep others.
    """
    made = False
    with refuse_unwritable("--out", out, "folder"):
        made = not out.exists()
        out.mkdir(parents=True, exist_ok=True)
        if keep_runs and (out / RUNS).exists():
            raise InputError("command line", "--keep-runs", str(out / RUNS), "a folder without runs")
        check_writable(out / PAGE)
    return made


def _measured_folder(folder: Path | None) -> Path | None:
    """The folder of the measured figures, made if it is not there.

    :raises InputError: it cannot be made.
    """
    if folder is None:
        return None
    with refuse_unwritable("--measured", folder, "folder"):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def _discard(folder: Path) -> None:
    """Remove the folder that was made for a page, unless a run has been recorded in it."""
    for empty in (folder / RUNS, folder):
        if empty.is_dir() and not any(empty.iterdir()):
            empty.rmdir()


def _draw(paper: Paper, found: Results, console: Output) -> Sequence[Figure]:
    """The figures; without the extra none, and one line that says so."""
    if find_spec("matplotlib") is None:
        console.say(f"no figures: matplotlib is not installed ({install_command('report')})")
        return ()
    return paper.draw(found)


def main(words: Sequence[str] | None = None, papers: Mapping[str, str] = PAPERS) -> int:
    """List the papers, or run the protocol of one and print or write the results.

    :param papers: as in :data:`railhil.reproduce.paper.PAPERS`.
    """
    return run_command(arguments(papers), words, partial(_work, papers=papers))


def _work(namespace: argparse.Namespace, papers: Mapping[str, str]) -> int:
    if namespace.paper is None:
        for option in ("seeds", "out", "keep_runs", "measured", "only"):
            if getattr(namespace, option):
                raise OptionError(
                    f"--{option.replace('_', '-')}", f"used only with a paper: one of {', '.join(papers)}"
                )
        _list([find_paper(name, papers) for name in papers], namespace.json)
        return PASS
    if namespace.keep_runs and namespace.out is None:
        raise OptionError("--keep-runs", "used only with --out DIR")
    return _reproduce(find_paper(namespace.paper, papers), namespace)


def _reproduce(paper: Paper, namespace: argparse.Namespace) -> int:
    """Run the protocol of one paper, print and write the results."""
    folder: Path | None = namespace.out
    made = folder is not None and _folder(folder, namespace.keep_runs)
    try:
        found = measure_paper(
            paper,
            namespace.seeds or paper.text.seeds,
            jobs=namespace.jobs,
            kept=folder / RUNS if folder is not None and namespace.keep_runs else None,
            measured=_measured_folder(namespace.measured),
            only=namespace.only,
            drawn=folder is not None,
            say=Output(stderr=True).say,
        )
    except BaseException:
        # After Ctrl-C, too, no empty folder remains.
        if folder is not None and made:
            _discard(folder)
        raise
    console = Output(stderr=namespace.json)
    figures = () if folder is None else _draw(paper, found, console)
    if namespace.json:
        print_json(make_document(paper, found, figures))
    else:
        _show(console, paper, found)
    if folder is not None:
        write_page(paper, found, figures, folder)
        console.say(f"page {folder / PAGE}")
    return INVALID if any(run.verdict == "INVALID" for run in found.runs.values()) else PASS


def _list(papers: Sequence[Paper], as_json: bool) -> None:
    """The papers and the number of entries of their protocols."""
    if as_json:
        print_json([{"paper": one.name, "title": one.text.title, "source": one.text.source} for one in papers])
        return
    rows = ((paper.name, paper.text.title, str(len(paper.plan(paper.text.seeds)))) for paper in papers)
    Output().print(table("paper", "title", number("entries"), rows=rows))


def _show(console: Output, paper: Paper, results: Results) -> None:
    """Protocol, tables and statements."""
    console.say(paper.text.title, style="bold")
    console.say(paper.text.source, style="dim")
    for sentence in paper.text.protocol:
        console.say(f"- {sentence}", style="dim")
    for one in paper.compare(results):
        console.say("")
        _show_table(console, one)
    console.say("")
    console.say("What follows and what does not", style="bold")
    for statement in paper.judge(results):
        console.say(f"{statement.verdict}: {statement.at}: {statement.claim}", style=_COLOURS.get(statement.verdict))
        console.say(f"    here: {statement.measured}{f' {statement.why}' if statement.why else ''}")
    for found in results.runs.values():
        if found.verdict == "INVALID":
            console.say(f"INVALID: {found.key}: {'; '.join(found.reasons)}", style="bold yellow")


def _show_table(console: Output, shown: Table) -> None:
    console.say(shown.title, style="bold")
    numbers = range(shown.first_number, len(shown.headings) - 1)
    heads = (number(name) if place in numbers else name for place, name in enumerate(shown.headings))
    rows = table(*heads, tight=True)
    before = ""
    for line in shown.lines:
        first, *cells = shown.cells(line)
        if before and first != before and line.item:
            rows.add_section()
        rows.add_row("" if first == before else first, *cells)
        before = first
    console.print(rows)
    if shown.note:
        console.say(shown.note, style="dim")


if __name__ == "__main__":
    sys.exit(run_guarded("railhil reproduce", main))
