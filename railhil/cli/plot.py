"""``railhil plot``: the picture of a recorded run."""

from __future__ import annotations

import argparse
from pathlib import Path

from railhil.common.errors import InputError
from railhil.common.extras import missing_library
from railhil.common.output import Output
from railhil.common.user_files import refuse_unwritable, whole_file
from railhil.judge.record import checked_record
from railhil.record.hash_list import check_free
from railhil.record.sampling import drawn_trace
from railhil.scenarios.options import add_option, add_options

_SUFFIXES = (".svg", ".png", ".pdf")
#: A curve needs two points.
_POINTS_MIN = 2


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("plot", examples=["railhil plot runs/mine --out run.png"])
    add_options(parser, "log", "--scenario")
    add_option(parser, "--out FILE", ", a picture (.svg, .png or .pdf)", usual="run.svg beside the log")


def work(namespace: argparse.Namespace) -> int:
    """Draw the picture and print its path."""
    record = checked_record(namespace.log, namespace.scenario)
    try:
        from railhil.report.pictures import draw_signals
    except ImportError as error:
        raise missing_library("railhil plot", error, "report") from None
    system, truth = record.system, record.judging.truth
    draw, trace = draw_signals, record.trace
    if system.picture is not None:
        draw, trace = system.part("picture"), drawn_trace(record.scenario, trace)
    points = record.trace.count(truth)
    if points < _POINTS_MIN:
        raise InputError(record.log, truth, points, f"at least {_POINTS_MIN} telegrams to draw")
    out = Path(namespace.out) if namespace.out is not None else record.log.with_name("run.svg")
    if out.suffix.lower() not in _SUFFIXES:
        raise InputError("command line", "--out", str(out), f"a name that ends in {', '.join(_SUFFIXES)}")
    check_free("--out", out)
    with refuse_unwritable("--out", out, "file"), whole_file(out) as draft:
        draw(record.scenario, trace, draft)
    for note in record.unused:
        Output(stderr=True).say(note)
    Output().say(str(out))
    return 0
