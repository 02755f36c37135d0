"""What ``railhil hunt`` prints: each violated requirement with its least case, and what was not found."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.batch.decision import Decision
from railhil.common.digits import count_of
from railhil.hunt.draws import draws_sentence, size_words
from railhil.hunt.found import FOUND
from railhil.hunt.oracle import BENCH
from railhil.judge.requirements.sentence import SILENT

if TYPE_CHECKING:
    from railhil.hunt.plan import Plan

_DIGEST = 12


def lines(plan: Plan, summary: Mapping[str, Any], folder: Path) -> Iterator[str]:
    """The result of a hunt, line by line; the commands in it are for the present folder."""
    law = plan.base.law
    many = f"{count_of(len(plan.requirements), 'requirement')} and " if plan.requirements else ""
    what = f"{many}the rules of every run"
    yield f"{summary['scenario']}, {law.label} {law.arithmetic}, {what}; seed {summary['seed']}"
    yield headline(summary)
    tight = {one["id"]: one for one in summary.get("tight", ())}
    for one in summary["requirements"]:
        yield requirement_line(one)
        if one["id"] in tight:
            yield f"    {tight_sentence(tight[one['id']])}"
        for least in (case for case in summary["found"] if case["id"] == one["id"]):
            yield from _least(least, folder)
    yield verdict_line(summary)


def summary_lines(summary: Mapping[str, Any]) -> Iterator[str]:
    """What was found, without the least cases."""
    yield headline(summary)
    yield from map(requirement_line, summary["requirements"])
    yield verdict_line(summary)


def headline(summary: Mapping[str, Any]) -> str:
    """Runs and cells, in a line."""
    last = summary["last_new_cell"]
    new = "" if last is None else f", the last new one in case {last}"
    idle = summary["with_idle_faults"]
    without = f", in {idle:,} of them not every fault acted" if idle else ""
    return (
        f"{count_of(summary['runs'], 'run', spec=',')} ({summary['valid']:,} valid{without}); "
        f"{count_of(len(summary['cells']), 'cell')} of level, cause and phase reached{new}"
    )


def requirement_line(one: Mapping[str, Any]) -> str:
    """What was found of a requirement."""
    if one["verdict"] != "violated":
        return _kept(one)
    return f"{one['id']}  VIOLATED in {count_of(one['violations'], 'run')}: {one['said']}"


def _kept(one: Mapping[str, Any]) -> str:
    """A requirement that no run violates."""
    if not one["runs"]:
        return f"{one['id']}  not judged in any run: none was valid, or it is about runs without faults only"
    if one["verdict"] == SILENT:
        return f"{one['id']}  says nothing: its antecedent was never met in {count_of(one['runs'], 'run', spec=',')}"
    margin = f"; nearest {text}" if (text := nearest(one)) else ""
    slack = "" if one["slack"] is None else f", least slack {one['slack'] * 1e3:g} ms"
    met = f"antecedent met in {one['antecedent_met']:,}"
    return f"{one['id']}  not found in {count_of(one['runs'], 'run', spec=',')}{margin}{slack} ({met})"


def nearest(one: Mapping[str, Any]) -> str:
    """The smallest margin of a requirement over all runs; empty: there is none."""
    return "" if one.get("margin") is None else f"{one['margin']:.4g} {one['unit']}".rstrip()


def _least(one: Mapping[str, Any], folder: Path) -> Iterator[str]:
    draws = [draws_sentence(one["draws"])] if one["draws"] else []
    for text in [*one["faults"], *draws] or ["(without any fault)"]:
        yield f"    {text}"
    saved = f"; {text}" if (text := saved_sentence(one)) else ""
    yield f"    found {found_sentence(one)}{saved}"
    if one["longer_pass"]:
        factors = ", ".join(f"x{factor:g}" for factor in one["longer_pass"])
        yield f"    not monotone: longer ones pass ({factors})"
    file = shlex.quote(str(folder / FOUND / f"{one['name']}.toml"))
    yield f"    railhil run {file}{one['options']}"
    repeats = "" if one["is_repeatable"] else "  NOT REPEATED by its file"
    yield f"    sha256 {one['frames_sha256'][:_DIGEST]}...{repeats}"


def found_sentence(one: Mapping[str, Any]) -> str:
    """In which case a least case was found, and from what it was shrunk."""
    before, after = (size_words(case["faults"], case["draws"]) for case in (one["from"], one))
    shrunk = f"shrunk in {count_of(one['runs'], 'run')} from {before} to {after}" if one["runs"] else "not shrunk"
    return f"in case {one['case']}, {shrunk}"


def tight_sentence(one: Mapping[str, Any]) -> str:
    """The tightest bound of a requirement that held."""
    still_open = f" ({one['open_runs']:,} open at the end)" if one["open_runs"] else ""
    held = f"held in {count_of(one['runs'], 'run', spec=',')}{still_open} with {one['bound']} instead of {one['was']}"
    if not one["is_confirmed"]:
        return f"{held}: NOT CONFIRMED by case {one['case']}, made again"
    least = "less cannot be said" if one["is_least"] else f"case {one['case']} violates the next tighter one"
    return f"{held}; {least}"


def saved_sentence(one: Mapping[str, Any]) -> str:
    """Up to when the run of a least case can be saved; empty: it is not known."""
    if found := one.get("decided"):
        return Decision.from_json(found).sentence
    if found := one["no_return"]:
        many = f"({count_of(found['branches'], 'branch', 'branches')})"
        if found["saved_s"] is None:
            return f"ending its faults when they begin does not save the run {many}"
        whole = "all its faults" if len(one["faults"]) > 1 else "it"
        return f"ending {whole} at {found['saved_s']:g} s still saves the run, at {found['lost_s']:g} s not {many}"
    return "" if one["saved_at_s"] is None else f"ending it at {one['saved_at_s']:g} s still saves the run"


def verdict_line(summary: Mapping[str, Any]) -> str:
    """The result in a line."""
    runs = f"{count_of(summary['runs'], 'run', spec=',')} with this seed"
    found = [one["id"] for one in summary["requirements"] if one["verdict"] == "violated"]
    if not found:
        if 2 * summary["valid"] < summary["runs"]:
            return f"INVALID: only {summary['valid']:,} of {runs} could be judged"
        return f"no violation found in {runs}. Not found is not absence."
    bench = "; a defect of the bench" if BENCH in found else ""
    return f"FAIL: {', '.join(found)} violated{bench}. Not found is not absence: {runs}."
