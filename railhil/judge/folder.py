"""The results of a run in its folder: score, certificate, table of signals, JUnit report."""

from __future__ import annotations

import hashlib
import shlex
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from railhil.bus.ident import PROFILES
from railhil.common.build import machine
from railhil.common.errors import describe_os_error
from railhil.common.held_code import place_of
from railhil.common.streams import one_line
from railhil.common.user_files import RecordFailed, whole_file, write_synced
from railhil.common.version import full_version
from railhil.judge.criteria import limited
from railhil.judge.events.event import EVENTS, FAULT, LOST, MISSED_POLL, REFUSED, write_events
from railhil.judge.events.summary import counts_said, explained, reactions, summary, why
from railhil.judge.signals import write_signals
from railhil.judge.training_seeds import seed_was_trained
from railhil.record.blf_writer import write_blf
from railhil.record.documents import CERTIFICATE, SCORE
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, write_hash_list
from railhil.record.run_folder import json_text, recorded_by, write_json
from railhil.record.telemetry import NOTHING_LEARNED
from railhil.scenarios.memory import MEMORY_AFTER
from railhil.scenarios.run_spec import RunSpec, StartUp
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.scenarios.system import system_named

if TYPE_CHECKING:
    from railhil.judge.result import Result

_CODE = (
    "common", "faults", "dbc", "bus", "scenarios", "plant_sim", "controller_node",
    "record", "judge", "report", "live", "systems", "run",
)  # fmt: skip

#: Files computed from ``frames.log`` after the run; removed again unless all of them could be written.
_DERIVED = ("signals.csv", EVENTS, "frames.blf", SCORE, "junit.xml", MEMORY_AFTER, HASH_LIST, CERTIFICATE)


def code_files(names: Sequence[str] = _CODE) -> Iterator[tuple[str, Path]]:
    """Source files and tables of folders and modules of the package, by default of the bench: names below the package,
    and the files."""
    for name in names:
        place = place_of(name)
        for path in sorted(place.rglob("*")) if place.is_dir() else [place]:
            if path.suffix in (".py", ".toml", ".dbc", ".csv"):
                yield str(Path(name, path.relative_to(place))), path


def code_sha256(names: Sequence[str] = _CODE, changed: Mapping[str, bytes] = MappingProxyType({})) -> str:
    """Hash over :func:`code_files` (paths and contents, in path order).

    :param changed: other contents of some of the files.
    """
    digest = hashlib.sha256()
    for name, path in code_files(names):
        content = changed[name] if name in changed else path.read_bytes()
        digest.update(name.encode() + b"\0" + content + b"\0")
    return digest.hexdigest()


def made_by(system: str, law: str, code: str) -> dict[str, str | None]:
    """The code that made a document, as stated in every document; :func:`railhil.judge.rerun.code_changes` compares it.

    :param system: its name; ``law``: the law's name; ``code``: :func:`code_sha256`.
    """
    maker = system_named(system)
    return {
        "railhil": full_version(),
        "code_sha256": code,
        # Hash of the package that provides the system, which need not be railhil.
        "system_sha256": maker.code_sha256(),
        # Hash of the distribution that provides the law; None: railhil.
        "law_sha256": maker.law_sha256(law),
    }


def run_command(spec: RunSpec, bus_words: Sequence[str]) -> str:
    """The command line that repeats the run.

    A run cannot attach to nodes that have ended. For an attached run it is therefore the command that started all
    nodes, if known, else a run that starts its own nodes on its own bus. In lockstep this gives the same bytes.
    """
    start_up = spec.start_up
    if start_up.rerun_command:
        return start_up.rerun_command
    words = ["railhil", "run", *spec.words]
    words += ["--no-rt"] * (not start_up.ask_for_fifo)
    words += ["--no-controller"] * start_up.foreign
    words += ["--controller-name", start_up.controller_name] if start_up.controller_name else []
    return shlex.join([*words, *(() if start_up.attach else bus_words)])


def rerun_needs(start_up: StartUp) -> str | None:
    """Requirements of :func:`run_command` that the command does not contain; None: there are none."""
    if start_up.foreign:
        return "the controller that answered, on the same bus: a board or another program"
    if start_up.attach and not start_up.rerun_command:
        return "that the nodes, which were started elsewhere, were ours and of this version"
    return None


def score_json(result: Result) -> dict[str, Any]:
    """Content of ``score.json``: results from the log, and data on the course of the run."""
    scenario, spec = result.scenario, result.spec
    document = result.score.as_json()
    document["verdict"] = result.verdict
    document["line"] = result.line
    document["why"] = why(scenario, result.events)
    document["events"] = summary(scenario, result.events)
    document["faults"] = [one.as_json() for one in result.faults]
    parameters = spec.law.parameters
    document["run"] = _described(result) | {
        # Their values are in the certificate.
        "parameters": None if parameters is None else parameters.digest,
        "memory": None if spec.law.memory is None else spec.law.memory.digest,
        "sim_time_s": result.sim_time_s,
        "wall_time_s": result.wall_time_s,
        "speed_factor": result.speed_factor,
        "first_frame_s": result.first_frame_s if result.frames else None,
        "frames": result.frames,
        "transport": result.transport,
        "seed_was_trained": seed_was_trained(scenario, spec, result.origin),
        "counters": result.recorder_counters,
        "timing": None if result.timing is None else result.timing.as_json(),
    }
    document["telemetry"] = None if result.summary is None else result.summary.as_json()
    if result.timing is not None and result.timing.jitter is not None:
        document["jitter"] = result.timing.jitter.as_json()
    return document


def _described(result: Result) -> dict[str, Any]:
    """The keys of a run. Values that a foreign controller has not confirmed are given as known, and the requested
    values stand under ``asked``."""
    document = result.spec.as_json()
    if not result.reported:
        return document
    return document | dict(result.reported) | {"asked": {key: document[key] for key in result.reported}}


def certificate(result: Result, code: str) -> dict[str, Any]:
    """Content of ``certificate.json``: enough to reproduce the same bytes, and to notice if they differ.

    :param code: :func:`code_sha256`.
    """
    scenario, spec, told = result.scenario, result.spec, result.trace.reported
    return {
        **made_by(scenario.system, spec.law.controller, code),
        **_described(result),
        # Hash of memory.json in the same folder; the initial memory is memory_before.json.
        **(NOTHING_LEARNED if result.memory is None else result.memory.as_json()),
        "scenario_sha256": scenario.sha256,
        # Includes the limits and factors by which the record is judged.
        "judged_sha256": any_judged_sha256(scenario),
        "system": scenario.system,
        "dbc_sha256": scenario.installed_system.contract.sha256,
        "own_parameters": None if result.origin is None else {"origin": result.origin.text},
        # The law's declaration of its notes in CTL_STAT; None: the controller has not reported it.
        "notes": _notes(result),
        "seed_was_trained": seed_was_trained(scenario, spec, result.origin),
        "arithmetic_profile": None if "arithmetic" in result.reported else PROFILES[spec.law.arithmetic],
        "attached": spec.start_up.attach,
        # If true, the controller was not railhil's: the handshake gives law, parameters and arithmetic.
        "foreign": spec.start_up.foreign,
        "transport": result.transport,
        "frames": result.frames,
        "frames_sha256": result.frames_sha256,
        # Hash of the frames of the wire contract alone, and the number of other frames in the record: on a shared bus
        # the first hash also covers foreign frames.
        "telegrams_sha256": result.telegrams_sha256,
        "other_frames": result.other_frames,
        # Ports whose owner was not started by this command and has left no list of its frames.
        "not_witnessed": list(result.not_witnessed),
        "verdict": result.verdict,
        "line": result.line,
        "command": run_command(spec, result.bus_words),
        "command_needs": rerun_needs(spec.start_up),
        "recorded": recorded_by(),
        "machine": machine(),
        "libraries": {name: version(name) for name in ("python-can", "cantools", "numpy", "scipy")},
        "assumptions": list(scenario.assumptions),
        # The injected faults with all draws: as texts of --fault they make the run again.
        "injected": [one.as_json() for one in result.faults],
        # Watch limits above the usual ones; empty: none.
        "watch_weakened": scenario.watch_weakened,
        "received": None if told is None else told.as_json(),
        **({} if result.branched_from is None else {"branched_from": result.branched_from}),
        **({} if result.target is None else {"target": result.target.model_dump()}),
    }


def _notes(result: Result) -> list[dict[str, Any]] | None:
    return None if result.notes is None else [note.as_json() for note in result.notes]


def junit(result: Result) -> ET.ElementTree[ET.Element]:
    """JUnit report with one case per limit of the scenario, and one per stop if the run has several.

    A missed limit is a ``failure``; a bench that cannot be trusted is an ``error``, and no limit is judged.
    The messages also give the reactions of the watches, the properties give them for each watch. ``time`` is wall time
    in s: the run's in ``bench_valid``, 0 for the limits, which are judged from its record.
    """
    scenario, spec, found = result.scenario, result.spec, result.score
    judging = result.judging
    cases: list[tuple[str, str]] = []
    if result.trusted:
        cases = [
            (criterion.name, criterion.missed(scenario, found.with_sign(criterion)))
            for criterion in limited(judging.criteria, scenario)
        ]
        cases += judging.checks(scenario, found)
        cases += [(f"stop {stop.planned.name}", stop.missed) for stop in found.listed_stops]
        cases += [(f"requirement {one.id}", one.line if one.violated else "") for one in found.requirements]
    suite = ET.Element(
        "testsuite",
        name=one_line(f"{scenario.name}.{result.reported.get('controller', spec.law.controller)}"),
        tests=str(1 + len(cases)),
        failures=str(sum(bool(text) for _, text in cases)),
        errors=str(int(not result.trusted)),
        time=f"{result.wall_time_s:.3f}",
    )
    properties = ET.SubElement(suite, "properties")
    for name, value in (
        ("railhil", full_version()),
        ("scenario", spec.scenario),
        ("seed", spec.seed),
        ("verdict", result.verdict),
        ("frames_sha256", result.frames_sha256),
        ("controller", result.reported.get("controller", spec.law.label)),
        ("arithmetic", result.reported.get("arithmetic", spec.law.arithmetic)),
        *((f"reaction.{item.watch.name}", item.sentence()) for item in reactions(scenario, result.events)),
        *((kind, said) for kind in (REFUSED, LOST, MISSED_POLL) if (said := counts_said(result.events, kind))),
        *((FAULT, event.detail) for event in result.events if event.kind == FAULT),
    ):
        ET.SubElement(properties, "property", name=name, value=one_line(str(value)))
    classname = one_line(f"railhil.{scenario.name}")
    bench = ET.SubElement(suite, "testcase", classname=classname, name="bench_valid", time=suite.attrib["time"])
    reason = why(scenario, result.events)
    if not result.trusted:
        ET.SubElement(bench, "error", message=one_line(explained(result.line, reason)))
    for name, text in cases:
        case = ET.SubElement(suite, "testcase", classname=classname, name=one_line(name), time="0.000")
        if text:
            ET.SubElement(case, "failure", message=one_line(explained(text, reason)))
    return ET.ElementTree(suite)


def write_folder(result: Result) -> None:
    """Write all results of a finished record; the certificate comes last and marks the folder as complete.

    :raises RecordFailed: the folder cannot be written; it then holds the recorded files (the log, and the output and
        measurements of the nodes) and nothing that looks like a result.
    """
    folder, scenario, trace = result.place, result.scenario, result.trace
    try:
        with ExitStack() as drafts:
            blf = drafts.enter_context(whole_file(folder / "frames.blf"))
            write_blf(folder / "frames.log", blf)
            if trace.count(result.judging.truth):
                signals = drafts.enter_context(whole_file(folder / "signals.csv"))
                write_signals(scenario, trace, signals, _notes(result))
        with whole_file(folder / EVENTS) as draft:
            write_events(result.events, draft)
        write_json(folder / SCORE, score_json(result))
        with whole_file(folder / "junit.xml") as draft:
            junit(result).write(draft, encoding="unicode", xml_declaration=True)
        if result.memory is not None and result.memory.record is not None:
            write_synced(folder / MEMORY_AFTER, result.memory.record.content)
        document = certificate(result, code_sha256())
        with whole_file(folder / CERTIFICATE) as draft:
            draft.write_text(json_text(document | {HASH_LIST_KEY: HASH_LIST}), encoding="utf-8")
            write_hash_list(folder, {CERTIFICATE: draft})
    except BaseException as error:
        # Nothing that looks like a result may remain on Ctrl-C, too.
        if isinstance(error, OSError):
            raise record_failed(folder, error) from error
        _discard_results(folder)
        raise


def _discard_results(folder: Path) -> None:
    for name in _DERIVED:
        (folder / name).unlink(missing_ok=True)


def record_failed(folder: Path, error: OSError) -> RecordFailed:
    """The error for a folder that cannot be written; files that look like results are removed."""
    _discard_results(folder)
    reason = describe_os_error(error)
    return RecordFailed(f"run folder {folder} cannot be written: {reason}; frames.log is kept as far as it got")
