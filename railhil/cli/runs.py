"""``railhil runs``: an index of all run folders and studies below a directory."""

from __future__ import annotations

import argparse
from datetime import UTC, datetime
from pathlib import Path

from railhil.common.command_line import whole_number
from railhil.common.digits import count_of
from railhil.common.extras import need
from railhil.common.output import Output, show_progress
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import refuse_unwritable
from railhil.scenarios.options import add_option

_EXIT_CODES = """\
exit codes:
  0    the folders were listed, whatever their verdicts
  2    usage or bad input; one line says what was found and what is allowed
  4    TOOL ERROR: a defect of the bench
  130  stopped by Ctrl-C; 143 by SIGTERM"""
#: Where runs are kept unless a folder is named.
USUAL = "runs"
_LAST = 50
_SHOWN_MAX = 1_000_000


def _condition(text: str) -> tuple[str, str]:
    key, equals, pattern = text.partition("=")
    if not equals or not key:
        raise argparse.ArgumentTypeError(f"found {text}, allowed KEY=PATTERN, such as verdict=FAIL")
    return key, pattern


def _since(text: str) -> datetime:
    from railhil.index.show import instant

    try:
        return instant(text, datetime.now(UTC))
    except (ValueError, OverflowError):
        said = f"found {text}, allowed a day or an instant as 2026-11-28T18:00 (UTC), or 12h, 3d, 2w ago"
        raise argparse.ArgumentTypeError(said) from None


def add_index_arguments(parser: argparse.ArgumentParser) -> None:
    """The directory, and whether its index is made again."""
    parser.add_argument(
        "folder",
        nargs="?",
        default=USUAL,
        metavar="DIR",
        help=f"directory with run folders below it (default: {USUAL})",
    )
    parser.add_argument("--again", action="store_true", help="read every folder again, not only those that changed")


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "runs",
        examples=[
            "railhil runs",
            "railhil runs runs --where verdict=FAIL --since 3d",
            "railhil runs runs --group law",
            "railhil runs runs --out runs/index.html",
        ],
        epilog=_EXIT_CODES,
    )
    add_index_arguments(parser)
    parser.add_argument(
        "--where", type=_condition, action="append", default=[], metavar="KEY=PATTERN",
        help="only folders with this value (scenario=yizhuang*, requirement=ATO-5); may be given again, all hold",
    )  # fmt: skip
    parser.add_argument(
        "--since", type=_since, metavar="WHEN", help="only those made since then: 2026-11-28, 12h, 3d, 2w"
    )
    parser.add_argument("--new", action="store_true", help="only those that the index did not have, or that changed")
    parser.add_argument("--group", metavar="KEY", help="count by law, scenario, version, verdict, requirement ...")
    parser.add_argument("--sort", metavar="KEY", default="made", help="order by law, stop_error_m ... (default: made)")
    parser.add_argument(
        "--last", type=whole_number(0, _SHOWN_MAX), default=_LAST, metavar="N",
        help=f"print the last N of them; 0: all (default: {_LAST})",
    )  # fmt: skip
    add_json_argument(parser)
    add_option(parser, "--out FILE", ": the page of all folders, which opens offline", usual="")


def work(namespace: argparse.Namespace) -> int:
    """Bring the index up to date, print the folders and write the page."""
    need("pyarrow", "index", command="railhil runs")
    from railhil.index import show
    from railhil.index.tables import open_index

    console = Output(stderr=namespace.json)
    root = Path(namespace.folder)
    with show_progress(console, "folders", 0) as shown:
        index = open_index(root, namespace.again, lambda done, total: shown(done, f"folders ({total})"))
    where = [*namespace.where, *([("is_new", "true")] if namespace.new else [])]
    for option, names in (
        ("--where", [key for key, _ in where]),
        ("--group", [namespace.group or "law"]),
        ("--sort", [namespace.sort]),
    ):
        for key in names:
            show.check_key(index, option, key)
    every = show.all_rows(index)
    rows = show.in_order(show.chosen(every, where, namespace.since), namespace.sort)
    if namespace.out is not None:
        from railhil.index.page import write_page

        with refuse_unwritable("--out", Path(namespace.out), "file"):
            write_page(index, Path(namespace.out))
    found = show.groups(rows, namespace.group) if namespace.group else rows[-namespace.last :]
    if namespace.json:
        print_json([show.as_json(one) for one in (found if namespace.group else rows)])
    elif found:
        console.print(show.groups_table(found, namespace.group) if namespace.group else show.rows_table(found))
    for remark in (*index.remarks, *show.doubts(rows)):
        console.say(remark, style="yellow")
    said = (
        f"{count_of(len(rows), 'folder')} of {len(every)}" if len(rows) < len(every) else count_of(len(rows), "folder")
    )
    last = f", the last {len(found)} shown" if not namespace.group and len(found) < len(rows) else ""
    console.say(f"{said} below {root}{last}; {len(index.new)} new or changed since the index was last made")
    if namespace.out is not None:
        console.say(f"page {namespace.out}")
    return 0
