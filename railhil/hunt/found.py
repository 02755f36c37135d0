"""The least cases of a hunt: shrunk, one of each class, written as scenario files, and run again from these files."""

from __future__ import annotations

import json
import os
import shlex
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.batch.decision import Decision, find_decision, scores_that_violate
from railhil.common.digits import count_of
from railhil.common.errors import InputError, describe_os_error
from railhil.common.user_files import RecordFailed, write_synced
from railhil.hunt.draws import size_words, with_draws
from railhil.hunt.least import Least, ShrinkTask, shrink_case
from railhil.hunt.oracle import Judged, judge_result, run_case
from railhil.judge.record import checked_record
from railhil.judge.requirements.requirement import as_toml
from railhil.record.documents import CERTIFICATE
from railhil.record.framelog import sha256_of
from railhil.record.hash_list import read_hash_list, write_hash_list
from railhil.run.no_return import NoReturn, find_no_return
from railhil.scenarios.given import NamedCode
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.settings import set_words

if TYPE_CHECKING:
    from railhil.hunt.plan import Plan
    from railhil.judge.requirements.requirement import Requirement
    from railhil.judge.result import Result
    from railhil.study.engines import Engine, Say
    from railhil.study.execute import Outcome

#: Names in the folder of a hunt.
CASES, FOUND, FOUND_LIST = "cases.jsonl", "found", "found.json"
#: Cases of each requirement that are shrunk: the first ones.
SHRUNK_MAX = 3
#: Ends of the names of run folders beside that of a least case: the same run without the faults of the case, and the
#: nearest case that keeps the requirement.
WITHOUT, PASSING = "-without", "-passing"


@dataclass(frozen=True, slots=True)
class _KeptRun:
    """A run whose folder is kept: of a scenario file that a hunt has written, or beside it. ``requirement``: of which
    is searched for when it is lost; empty: it is not. ``is_by_noise``: by its noise, else by its faults."""

    spec: RunSpec
    requirements: tuple[Requirement, ...]
    folder: Path
    requirement: str = ""
    is_by_noise: bool = False


def _keep_run(run: _KeptRun) -> tuple[Judged, NoReturn | Decision | None]:
    found = run_case(run.spec, run.requirements, run.spec.faults, run.spec.seed, run.folder)
    if run.requirement not in found.violated or not (run.folder / CERTIFICATE).is_file():
        return found, None

    def violates(result: Result) -> bool:
        return run.requirement in judge_result(result, run.requirements).violated

    def saves(result: Result) -> bool:
        judged = judge_result(result, run.requirements)
        return judged.is_valid and run.requirement not in judged.violated

    record = checked_record(str(run.folder), None)
    own = [one for one in run.requirements if one.id == run.requirement]
    try:
        if run.is_by_noise:
            scores = scores_that_violate(own, record.scenario) if own else None
            return found, find_decision(run.spec, record.trace.end_s, violates, scores)
        return found, find_no_return(record, saves, NamedCode(controller=run.spec.law.given))
    except InputError:
        # Without a fault that began there is none.
        return found, None


def shrink_violations(plan: Plan, made: Outcome, engine: Engine, say: Say) -> Outcome:
    """Write ``cases.jsonl``, shrink the first violations of each requirement, and write the least cases.

    A finished hunt has them already.

    :returns: the outcome with the least cases in its summary, as ``found``.
    :raises RecordFailed: a file cannot be written.
    """
    found = read_found(made.folder)
    if found is None:
        try:
            found = _make(plan, made, engine, say)
        except OSError as error:
            raise RecordFailed(f"{made.folder} cannot be written: {describe_os_error(error)}") from error
    return replace(made, summary={**made.summary, "found": found})


def read_found(folder: Path) -> list[dict[str, Any]] | None:
    """The least cases that the folder has; None: it has none, or a file has changed since."""
    hashes = read_hash_list(folder) or {}
    if not (folder / FOUND_LIST).is_file():
        return None
    wanted = {name: sha256 for name, sha256 in hashes.items() if name in (CASES, FOUND_LIST) or _is_found(name)}
    if not {CASES, FOUND_LIST} <= wanted.keys():
        return None
    if any(not (folder / name).is_file() or sha256_of(folder / name) != sha256 for name, sha256 in wanted.items()):
        return None
    found: list[dict[str, Any]] = json.loads((folder / FOUND_LIST).read_bytes())
    return found


def _is_found(name: str) -> bool:
    return name.startswith(f"{FOUND}/") and name.endswith(".toml") and name.count("/") == 1


def _make(plan: Plan, made: Outcome, engine: Engine, say: Say) -> list[dict[str, Any]]:
    assert made.table is not None
    rows: list[dict[str, Any]] = made.table.to_pylist()
    write_synced(made.folder / CASES, "".join(f"{json.dumps(row, sort_keys=True)}\n" for row in rows).encode())
    place = made.folder / FOUND
    if place.exists():
        # A command that was stopped has left it.
        shutil.rmtree(place)
    tasks = list(_tasks(plan, rows))
    if tasks and not plan.request.no_shrink:
        say(f"{count_of(len(tasks), 'case')} to be made smaller")
    with engine(shrink_case, tasks) as results:
        least = [one for _, one in sorted(results, key=lambda result: result[0])]
    kept = least if plan.request.all else _one_of_each(least)
    found = write_found(plan, place, kept, engine) if kept else []
    write_synced(made.folder / FOUND_LIST, (json.dumps(found, indent=2) + "\n").encode())
    write_hash_list(made.folder)
    return found


def _tasks(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> Iterator[ShrinkTask]:
    """The first violations of each requirement that is searched for; all, if the request says so."""
    most = len(rows) if plan.request.all else SHRUNK_MAX
    counts: dict[str, int] = {}
    for row in rows:
        for name in row["violated"]:
            if plan.is_searched(name) and counts.get(name, 0) < most:
                counts[name] = counts.get(name, 0) + 1
                yield ShrinkTask(
                    plan.base,
                    plan.requirements,
                    name,
                    row["number"],
                    tuple(row["faults"]),
                    row["seed"],
                    plan.scenario.planned_s,
                    not plan.request.no_shrink,
                    tuple(row["draws"]),
                )


def _one_of_each(least: Sequence[Least]) -> list[Least]:
    """The first of each class."""
    found: dict[tuple[str, str], Least] = {}
    for one in least:
        found.setdefault(one.kind, one)
    return list(found.values())


def write_found(plan: Plan, place: Path, least: Sequence[Least], engine: Engine) -> list[dict[str, Any]]:
    """Write the files, make their runs, and list them."""
    place.mkdir()
    names, counts = [], dict.fromkeys((one.task.requirement for one in least), 0)
    for one in least:
        counts[one.task.requirement] += 1
        names.append(f"{one.task.requirement}-{counts[one.task.requirement]}")
        text = _scenario_file(plan, place, names[-1], one)
        write_synced(place / f"{names[-1]}.toml", text.encode())
    runs: dict[str, _KeptRun] = {}
    # The folders say what their runs violate, too.
    base = replace(plan.base, requirements=tuple(one.as_json() for one in plan.requirements))
    for name, one in zip(names, least, strict=True):
        own = replace(with_draws(base, one.draws), seed=one.shrunk.seed)
        file = replace(base, seed=one.shrunk.seed, scenario=str(place / f"{name}.toml"))
        is_by_noise = not one.shrunk.faults and bool(plan.drawn)
        searched = one.task.requirement if one.task.shrinks and (one.shrunk.faults or is_by_noise) else ""
        runs[name] = _KeptRun(file, plan.requirements, place / name, searched, is_by_noise)
        if one.shrunk.faults:
            runs[name + WITHOUT] = _KeptRun(own, plan.requirements, place / (name + WITHOUT))
        if one.passing:
            passing = replace(own, faults=one.passing)
            runs[name + PASSING] = _KeptRun(passing, plan.requirements, place / (name + PASSING))
    with engine(_keep_run, list(runs.values())) as results:
        made = dict(results)
    kept = {name: made[number] for number, name in enumerate(runs)}
    return [_entry(plan, name, one, *kept[name]) for name, one in zip(names, least, strict=True)]


def _entry(plan: Plan, name: str, one: Least, again: Judged, lost: NoReturn | Decision | None) -> dict[str, Any]:
    task = one.task
    return {
        "id": task.requirement,
        "name": name,
        "says": one.said,
        "case": task.number,
        "from": {"faults": list(task.faults), "seed": task.seed, "draws": list(task.draws)},
        "draws": list(one.draws),
        **asdict(one.shrunk),
        "faults": list(one.shrunk.faults),
        "longer_pass": list(one.shrunk.longer_pass),
        "passing": None if one.passing is None else list(one.passing),
        "no_return": asdict(lost) if isinstance(lost, NoReturn) else None,
        "decided": asdict(lost) if isinstance(lost, Decision) else None,
        "frames_sha256": one.frames_sha256,
        "options": _options(plan, one),
        "is_repeatable": again.frames_sha256 == one.frames_sha256 and task.requirement in again.violated,
    }


def _options(plan: Plan, one: Least) -> str:
    """The options with which ``railhil run`` repeats a file."""
    law = plan.base.law
    words = ["--controller", law.controller, "--arithmetic", law.arithmetic]
    words = words if law.given is None else law.given.words
    words += ["--seed", str(one.shrunk.seed)] if one.shrunk.seed else []
    return "".join(f" {shlex.quote(word)}" for word in (*words, *set_words(plan.request.settings)))


def _scenario_file(plan: Plan, place: Path, name: str, one: Least) -> str:
    """The least case as a scenario that extends the one of the hunt."""
    scenario = plan.request.scenario
    base = os.path.relpath(scenario, place.resolve()) if scenario.endswith(".toml") else scenario
    faults = (*plan.scenario.faults, *one.shrunk.faults)
    lines = [
        f"# railhil hunt, seed {plan.request.seed}: {one.task.requirement} is violated: {one.said}",
        f"# railhil run {FOUND}/{name}.toml{_options(plan, one)}",
        f"# frames.log sha256 {one.frames_sha256}",
        f"# found in case {one.task.number} with {size_words(one.task.faults, one.task.draws)}, "
        f"shrunk in {count_of(one.shrunk.runs, 'run')}",
        "schema_version = 1",
        f"extends = {_toml_text(base)}",
        *([f"draws = {[*one.draws]}"] if one.draws else []),
        f"fault = [{''.join(f'{chr(10)}    {_toml_text(text)},' for text in faults)}\n]",
    ]
    # A rule of every run needs no sentence.
    sentences = [requirement for requirement in plan.requirements if requirement.id == one.task.requirement]
    return "\n".join(line.replace("\r", " ") for line in lines) + "\n" + as_toml(sentences)


def _toml_text(text: str) -> str:
    """A basic string of TOML; its escapes are those of JSON."""
    return json.dumps(text)
