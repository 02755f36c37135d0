"""The facts that a reader needs in order to repeat a run and to judge it, with its timing.

Wall-clock figures are shown for real-time runs only: the report of a lockstep run is the same on every machine.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from railhil.bus.transports import limits_of
from railhil.charts.figure import Area, Chart, Curve, Figure
from railhil.common.digits import count_of
from railhil.judge.jitter import LATE_MS, LATE_SHARE_MAX, PLANT
from railhil.judge.record import Record
from railhil.record.target import Target
from railhil.record.telemetry import Headroom, ShownTelemetry, TelemetrySummary
from railhil.report.styles import styles
from railhil.scenarios.given import KEY as GIVEN_KEY
from railhil.scenarios.parameters import DIGEST_DIGITS

TIMING_HEADINGS = ("law", "cycles", "p50", "p99", "p99.9", "max", f"over {LATE_MS:g} ms", "polls", "missed")
_FIGURES = (("p50", "p50_ms"), ("p99", "p99_ms"), ("p99.9", "p999_ms"), ("max", "max_ms"))
_BY_PLANT = "the plant, at the beginning of each cycle and at each answer"
_BY_RECORDER = (
    "the supervisor, by the arrival of each tick (the plant has left no table here): the transport time counts too, "
    "and an answer that came too late for the plant counts as an answer"
)


def timing_of(run: Record) -> dict[str, Any]:
    """``run.timing`` of a run, empty if there is none."""
    found: dict[str, Any] = run.score_document.get("run", {}).get("timing") or {}
    return found


def jitter_sentence(jitter: Mapping[str, Any]) -> str:
    """Lateness of the cycles in one line."""
    text = ", ".join(f"{name} {jitter[key]:.3f} ms" for name, key in _FIGURES)
    return f"lateness of {count_of(jitter['cycles'], 'cycle')}: {text}"


def answers_sentence(timing: Mapping[str, Any]) -> str:
    """Missed polls, and the latency of the answers per port, in one line."""
    text = f"{timing['missed_polls']} of {count_of(timing['polls'], 'poll')} missed"
    for item in timing["answers"]:
        figures = (f"{name} {item[key]:.3f} ms" for name, key in _FIGURES if key in item)
        text += f"; {item['port']} {', '.join(figures)}"
    return text


def scheduling_sentence(timing: Mapping[str, Any]) -> str:
    """The scheduling granted to each process; processes with the same are named together."""
    roles: dict[str, list[str]] = {}
    for role, sentence in timing["scheduling"].items():
        roles.setdefault(sentence, []).append(role)
    text = "; ".join(f"{' and '.join(names)}: {sentence}" for sentence, names in roles.items())
    return text if "plant" in timing["scheduling"] else f"{text}; plant and controller were started elsewhere"


def timing_rows(document: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Facts on the timing of a run, from its ``score.json``."""
    rows: list[tuple[str, str]] = []
    run = document.get("run", {})
    timing = run.get("timing") or {}
    jitter = document.get("jitter")
    if jitter is None:
        missed = timing.get("missed_polls")
        return [] if missed is None else [("Timing", f"lockstep: no timing, missed polls {missed}")]
    rows.append(("Jitter", jitter_sentence(jitter)))
    if timing.get("lateness"):
        rows.append(("Measured by", _BY_PLANT if timing["source"] == PLANT else _BY_RECORDER))
        if timing.get("pace"):
            rows.append(("Pace", timing["pace"]))
        rows.append(("Answers", answers_sentence(timing)))
        rows.append(("Scheduling", scheduling_sentence(timing)))
    if run:
        rows.append(("Wall time", f"{run['sim_time_s']:.2f} s simulated in {run['wall_time_s']:.2f} s of wall time"))
    return rows


def timed(runs: Sequence[Record]) -> list[Record]:
    """The real-time runs, with their timing."""
    return [run for run in runs if timing_of(run).get("lateness")]


def timing_table(runs: Sequence[Record]) -> list[tuple[str, ...]]:
    """A row per real-time run, cells under :data:`TIMING_HEADINGS`; empty if all runs were in lockstep."""
    found = []
    for run in timed(runs):
        timing = timing_of(run)
        late = timing["lateness"]
        figures = (f"{late[key]:.3f}" for _, key in _FIGURES)
        counts = (str(timing["polls"]), str(timing["missed_polls"]))
        found.append((run.label, str(late["cycles"]), *figures, f"{late['late_share']:.3%}", *counts))
    return found


#: Labels of the horizontal axis, ms.
_DURATIONS_MS = (0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0)


def lateness_figures(runs: Sequence[Record]) -> list[Figure]:
    """Number of cycles over lateness with the limit that counts against the run; empty if no run has kept time."""
    curves = []
    for number, (run, style) in enumerate(zip(runs, styles([run.controller for run in runs]), strict=True)):
        if found := timing_of(run).get("histogram"):
            edges_ms, counts = np.array(found["edges_ms"]), np.array(found["counts"], dtype=np.float64)
            stairs = np.append(counts, counts[-1])
            curves.append((edges_ms, Curve(run.label, edges_ms, stairs, style.look, "", True, True, number)))
    if not curves:
        return []
    caption = (
        "How long after its absolute deadline each cycle began, in wall time; both axes are logarithmic. The dotted "
        f"line is {LATE_MS:g} ms: a run with more than {LATE_SHARE_MAX:.1%} of its cycles beyond it is INVALID."
    )
    bounds = min(float(edges[0]) for edges, _ in curves), max(float(edges[-1]) for edges, _ in curves)
    chart = Chart(
        [curve for _, curve in curves],
        "lateness",
        "cycles",
        bounds,
        (0.7, None),
        [Area((LATE_MS, LATE_MS), None, "line", f"{LATE_MS:g} ms")],
        x_names={late_ms: _duration(late_ms) for late_ms in _DURATIONS_MS},
        is_log=True,
        height_px=220,
    )
    return [Figure("lateness", "Lateness of the cycles", caption, [chart])]


def _duration(late_ms: float) -> str:
    return f"{late_ms:g} ms" if late_ms >= 1.0 else f"{late_ms * 1e3:g} µs"


def memory_sentence(certificate: Mapping[str, Any]) -> str:
    """The memory of its law with which a run began and ended; empty for a run without one."""
    before, after = certificate.get("memory"), certificate.get("memory_after_sha256")
    if not before and not after:
        return ""
    # Few records have a memory.
    from railhil.scenarios.parameters import DIGEST_DIGITS

    began, stored = "none yet", before["stored"] if before else []
    used = certificate.get("memory_used")
    # The run cannot be trusted without it: the law would have used the first.
    record = next((one["record"] for one in stored if one["record"] and used in (None, one["slot"])), None)
    if before and record:
        began = (
            f"that of {count_of(record['runs'], 'run')}, key {record['key']}, sha256 {before['sha256'][:DIGEST_DIGITS]}"
        )
    refused = "".join(
        f"; {slot} could not be used: {detail}" for slot, (_, detail) in certificate.get("memory_refused", {}).items()
    )
    return f"began with {began}{refused}; {f'left sha256 {after[:DIGEST_DIGITS]}' if after else 'left none'}"


_UNKNOWN = "not recorded"
_NO_SCORE = f"{_UNKNOWN}: score.json is missing"
#: Folder part of an absolute path within a sentence; paths of devices are kept.
_FOLDERS = re.compile(r"(?<![\w./])/(?!dev/)(?:[^\s/:]+/)+")


@dataclass(frozen=True, slots=True)
class Facts:
    """``common``: facts that hold for all runs; ``own``: per run, its label and the facts that differ; rows are
    ``(name, text)``."""

    common: tuple[tuple[str, str], ...]
    own: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]


def without_folders(text: str) -> str:
    """An absolute path reduced to its file name: the place of a run is not part of its report. Devices are kept."""
    path = PurePosixPath(text)
    return path.name if path.is_absolute() and not text.startswith("/dev/") else text


def without_paths(text: str) -> str:
    """A sentence with absolute paths reduced to file names."""
    return _FOLDERS.sub("", text)


def _transport(text: str) -> str:
    interface, _, channel = text.partition(":")
    return f"{interface}:{without_folders(channel)}"


def _command(text: str) -> str:
    try:
        return shlex.join(map(without_folders, shlex.split(text)))
    except ValueError:
        return text


def _telemetry(document: Any) -> str:
    """One sentence from the telemetry of ``score.json``."""
    if document is None:
        return "the controller has not reported on its arithmetic"
    least = Headroom(**document["least_headroom"]) if document["least_headroom"] else None
    if "source" in document:
        rows = tuple(document["quantities"])
        return ShownTelemetry(
            document["source"], tuple(document["happened"]), least, document["cycles"], rows
        ).sentence()
    names = [item.name for item in fields(TelemetrySummary)]
    return TelemetrySummary(**{name: document[name] for name in names} | {"least_headroom": least}).sentence()


def parameters_sentence(run: Record) -> str:
    """Origin of the parameters with which the controller ran."""
    given, own = run.certificate.get("parameters"), run.certificate.get("own_parameters")
    if run.certificate.get("foreign"):
        asked = f"those of a file, digest {given['sha256'][:DIGEST_DIGITS]}" if given else "the law's own"
        return f"not known: the controller was not railhil's; in the handshake it agreed to {asked}"
    if run.certificate.get(GIVEN_KEY):
        return f"in the code of {run.certificate['controller']}"
    if not given:
        return f"the law's own ({own['origin'] if own else _UNKNOWN + ' where they come from'})"
    words = f"from a file, digest {given['sha256'][:DIGEST_DIGITS]}"
    if training := given.get("training"):
        words += f", tuned on {count_of(len(training['seeds']), 'run')} of {training['scenario']}"
    return words


def _parameters(run: Record) -> str:
    if run.certificate.get("foreign"):
        return parameters_sentence(run)
    values = (run.certificate.get("parameters") or {}).get("values", {})
    return parameters_sentence(run) + "".join(f"; {name} = {value}" for name, value in values.items())


def _other(certificate: dict[str, Any]) -> str:
    said = "a board or another program"
    asked = certificate.get("asked") or {}
    if not asked:
        return f"{said}; law and arithmetic are as it reported them"
    words = ", ".join(f"{key} {value}" for key, value in asked.items())
    return f"{said}; asked for, and not confirmed or named otherwise: {words}"


def _settings(certificate: dict[str, Any]) -> str:
    return "".join(f"; set: {without_paths(text)}" for text in certificate.get("settings", ()))


def _plant(certificate: dict[str, Any], scenario: Any) -> str:
    if getattr(scenario, "draws", ()):
        return "drawn with the numbers of the scenario (draws)"
    return "drawn from the scenario's distributions" if certificate.get("perturbed") else "nominal"


def facts_of(run: Record) -> list[tuple[str, str]]:
    """All facts of one run, in reading order."""
    certificate, scenario, document = run.certificate, run.scenario, run.score_document

    def said(key: str) -> str:
        found = certificate.get(key)
        return _UNKNOWN if found is None else str(found)

    transport, profile = said("transport"), certificate.get("arithmetic_profile")
    own = list(run.judging.facts(run))
    rows = [
        ("Scenario", f"{scenario.title} ({scenario.name}){_settings(certificate)}"),
        *own[:1],
        ("Controller", said("controller")),
        ("Parameters", _parameters(run)),
        *([("Memory", kept)] if (kept := memory_sentence(run.certificate)) else []),
        ("Arithmetic", said("arithmetic") + (f" (profile {profile})" if profile else "")),
        ("Set-point over", said("indexing")),
        ("Seed", said("seed")),
        ("Plant", _plant(certificate, scenario)),
        *own[1:],
        ("Arithmetic telemetry", _telemetry(document["telemetry"]) if document else _NO_SCORE),
        ("Pacing", said("pace")),
        *timing_rows(document),
        ("Transport", _transport(transport)),
        ("Not modelled there", limits_of(transport)),
        ("Frames", said("frames")),
        ("SHA-256 of frames.log", said("frames_sha256")),
        ("SHA-256 of the scenario", scenario.sha256),
        ("SHA-256 of the DBC", said("dbc_sha256")),
        ("SHA-256 of the code", said("code_sha256")),
        ("railhil", said("railhil")),
        ("Again with", _command(said("command"))),
    ]
    if certificate.get("target"):
        rows += Target.model_validate(certificate["target"]).rows
    if certificate.get("foreign"):
        rows.append(("Other controller", _other(certificate)))
    if certificate.get("attached"):
        rows.append(("Attached", "plant and controller were started elsewhere"))
    if certificate.get("not_witnessed"):
        ports = ", ".join(certificate["not_witnessed"])
        rows.append(("Not witnessed", f"{ports}: their owners did not say which frames they sent"))
    if certificate.get("command_needs"):
        rows.append(("The command needs", said("command_needs")))
    return rows


def facts(runs: Sequence[Record]) -> Facts:
    """Facts of all runs, the common ones only once."""
    each = [facts_of(run) for run in runs]
    shared = set(each[0]).intersection(*map(set, each[1:]))
    return Facts(
        tuple(row for row in each[0] if row in shared),
        tuple(
            (run.label, tuple(row for row in rows if row not in shared)) for run, rows in zip(runs, each, strict=True)
        )
        if len(runs) > 1
        else (),
    )
