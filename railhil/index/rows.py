"""The rows of one folder: what its documents say, read by their own readers. Nothing is computed here.

A folder whose documents cannot be read, or are not as listed beside them, has one row with its ``problem`` and no
result.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeAlias

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_json, open_given, refuse_unreadable
from railhil.index.find import RECORDED, RUN, Found
from railhil.judge.events.event import COLUMNS, EVENTS
from railhil.judge.record import law_label
from railhil.record.documents import (
    CERTIFICATE,
    SCORE,
    SUMMARY,
    fault_entries_missing,
    fault_table_verdict,
    read_certificate,
    read_comparison,
    read_fault_table,
    read_score,
)
from railhil.record.hash_list import HASH_LIST, REPORT, SIGNATURE, changed_files, check_document
from railhil.scenarios.system import DEFAULT

#: Rows by the name of their table.
Rows: TypeAlias = dict[str, list[dict[str, Any]]]
Document: TypeAlias = Mapping[str, Any]
#: Verdicts, the worst one last.
_VERDICTS = ("PASS", "FAIL", "INVALID")
#: Keys of a certificate that are columns of the table ``runs``.
FACTS = (
    "controller", "arithmetic", "indexing", "seed", "perturbed", "run_number", "pace", "bus", "transport", "frames",
    "frames_sha256", "code_sha256", "system_sha256", "law_sha256", "scenario_sha256", "dbc_sha256",
)  # fmt: skip
#: The same, texts in a list.
LISTS = ("settings", "faults", "orders")


def rows_of(root: Path, found: Found) -> Rows:
    """All rows of a folder."""
    head = head_of(found)
    folder = root / found.folder
    try:
        if not found.document:
            raise InputError(folder, "", Words("did not come to its end"), CERTIFICATE)
        if found.kind == RUN:
            return _of_run(folder, found, head)
        told, rows = _STUDIES[found.kind](folder, found) if found.kind in _STUDIES else _of_any(folder, found)
        return {"folders": [head | told], **rows}
    except InputError as error:
        return {"folders": [head | {"problem": error.difference if error.file == str(folder) else str(error)}]}
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError):
        return foreign_rows(found)


def head_of(found: Found) -> dict[str, Any]:
    """What is known of a folder whose documents are not read."""
    return {
        "folder": found.folder,
        "kind": found.kind,
        "made": found.made,
        "dated_by": found.dated_by,
        "is_listed": HASH_LIST in found.names,
        "is_signed": SIGNATURE in found.names,
        "has_report": REPORT in found.names,
        "problem": "",
    }


def foreign_rows(found: Found) -> Rows:
    """The row of a folder whose documents hold other keys or values than those of the tables."""
    said = f"{found.document}, {SCORE} or {SUMMARY} has other keys or values than railhil writes"
    return {"folders": [head_of(found) | {"problem": said}]}


def _checked(folder: Path, name: str, document: Document | None, beside: str = "") -> Document:
    """The document of a folder. Refuses documents that are not as listed, or not listed beside others that are, or
    gone since the folder was found. Raises InputError."""
    hashes = check_document(folder, name, document)
    if document is None:
        raise InputError(folder / name, "", Words("does not exist"), "what railhil has written")
    if hashes and beside and beside not in hashes and (folder / beside).is_file():
        raise InputError(folder / HASH_LIST, "", Words(f"has no line of {beside}"), "the hash of each file")
    for changed in changed_files(folder, {beside: hashes[beside]} if beside in hashes else {}):
        raise changed.error(folder)
    return document


def _dated(document: Document) -> dict[str, Any]:
    """When a record was made, as it says itself: it is the same in a copy, whose files may have other dates."""
    if not (recorded := document.get("recorded")):
        return {}
    return {"dated_by": RECORDED, "made": datetime.fromisoformat(recorded["utc"]).astimezone(UTC)}


def _of_run(folder: Path, found: Found, head: dict[str, Any]) -> Rows:
    certificate = _checked(folder, CERTIFICATE, read_certificate(folder), SCORE)
    score, recorded = read_score(folder) or {}, certificate.get("recorded") or {}
    head |= _dated(certificate)
    run, parameters = score.get("run", {}), certificate.get("parameters")
    law = law_label(certificate, "?")
    common = {
        "scenario": certificate.get("scenario"),
        "system": certificate.get("system"),
        "law": law,
        "seed": certificate.get("seed"),
        "version": certificate.get("railhil"),
        "verdict": certificate.get("verdict"),
        "line": certificate.get("line"),
    }
    facts = {name: certificate.get(name) for name in FACTS}
    facts |= {name: certificate.get(name) or [] for name in LISTS}
    facts |= {
        "host": recorded.get("host"),
        "operator": recorded.get("operator"),
        "command": certificate.get("command"),
        "parameters": None if parameters is None else json.dumps(parameters["values"], sort_keys=True),
        "memory_sha256": (certificate.get("memory") or {}).get("sha256"),
        "why": score.get("why"),
        "ended": score.get("ended"),
        **{name: run.get(name) for name in ("sim_time_s", "wall_time_s", "speed_factor")},
    }
    scores = {**score.get("scores", {}), **{f"signed_{key}": one for key, one in score.get("signed", {}).items()}}
    key = {"folder": found.folder}
    return {
        "folders": [head | common],
        "runs": [{name: _number(one) for name, one in scores.items()} | key | {"made": head["made"]} | common | facts],
        "requirements": [key | _only(one, REQUIREMENT) for one in score.get("requirements", [])],
        "faults": [key | _only(one, FAULT) for one in certificate.get("injected", [])],
        "events": [key | one for one in _events(folder / EVENTS)] if EVENTS in found.names else [],
    }


#: Keys of an outcome, of an injected fault, and of a row of a fault table that are columns of their tables.
REQUIREMENT = {"id": str, "says": str, "verdict": str, "margin": float, "unit": str, "instant_s": float, "said": str}
FAULT = {"number": int, "fault": str, "begun_s": float, "effect_s": float, "ended_s": float, "hits": int}
REACTION = {
    "entry": str, "begun_s": float, "effective_s": float, "detected_by": str, "detected_s": float, "reaction": str,
    "reaction_s": float, "after_ms": float, "within_ms": float, "margin_ms": float, "verdict": str, "refused": str,
}  # fmt: skip
#: Columns of ``events.csv`` that are numbers.
EVENT = {name: float if name in ("time_s", "until_s", "count", "position_m") else str for name in COLUMNS}


def _only(row: Document, columns: Mapping[str, type]) -> dict[str, Any]:
    return {
        name: _number(row.get(name)) if kind is float else row.get(name) if isinstance(row.get(name), kind) else None
        for name, kind in columns.items()
    }


def _number(value: Any) -> float | None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and math.isfinite(value) else None


def _events(path: Path) -> Iterable[dict[str, Any]]:
    with refuse_unreadable(path, "events of a run"), open_given(path) as stream:
        rows = csv.DictReader(stream.read().decode().splitlines())
        numbers = [name for name, kind in EVENT.items() if kind is float]
        found = [{name: row[name] for name in EVENT} for row in rows]
    return [row | {name: float(row[name]) if row[name] else None for name in numbers} for row in found]


def _study(folder: Path, found: Found) -> tuple[dict[str, Any], Document]:
    """What a study tells in any case, and its summary, which is empty while it is not finished."""
    manifest = given_json(folder / found.document, "what railhil has written")
    _checked(folder, found.document, manifest, SUMMARY)
    summary = given_json(folder / SUMMARY, "what railhil has written") if SUMMARY in found.names else {}
    identity = manifest.get(found.kind, {})
    told = {"scenario": identity.get("scenario"), "version": manifest.get("railhil"), "law": identity.get("law")}
    told |= {"system": (manifest.get("scenario") or {}).get("system", DEFAULT), "seed": summary.get("seed")}
    return told | _dated(manifest) | {"line": "" if summary else "not finished"}, summary


def _of_any(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    return _study(folder, found)[0], {}


def _of_campaign(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    told, summary = _study(folder, found)
    laws = summary.get("laws", {})
    said = [f"{law} {one['inside']['pass']['share']:.1%} PASS" for law, one in laws.items()]
    rows = [
        {"folder": found.folder, "law": law, "score": key, "unit": one["unit"], "figure": figure,
         "value": _number(of["value"]), "runs": summary["runs"]}
        for law, its in laws.items() for key, one in its["scores"].items() for figure, of in one.items()
        if isinstance(of, dict)
    ]  # fmt: skip
    told |= {"law": ", ".join(laws), "seed": summary.get("first_seed")}
    return told | ({"line": f"{count_of(summary['runs'], 'run')}: {', '.join(said)}"} if laws else {}), {
        "figures": rows
    }


def _of_hunt(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    told, summary = _study(folder, found)
    rows = [{"folder": found.folder} | _only(one, REQUIREMENT) for one in summary.get("requirements", [])]
    violated = [one["id"] for one in rows if one["verdict"] == "violated"]
    said = f"violated: {', '.join(violated)}" if violated else "no violation found"
    return told | ({"line": f"{count_of(summary['runs'], 'run')}, {said}"} if summary else {}), {"requirements": rows}


def _of_probability(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    told, summary = _study(folder, found)
    if not summary:
        return told, {}
    interval = "" if summary["low"] is None else f" ({summary['low']:.2g} to {summary['high']:.2g})"
    p = "no estimate" if summary["p"] is None else f"P = {summary['p']:.2g}"
    return told | {"line": f"{summary['requirement']['id']}: {p}{interval}"}, {}


def _of_learn(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    told, summary = _study(folder, found)
    said = ", ".join(f"{count} {verdict}" for verdict, count in summary.get("verdicts", {}).items())
    return told | ({"law": summary["law"], "line": said} if summary else {}), {}


def _of_dossier(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    document = given_json(folder / found.document, "what railhil dossier has written")
    _checked(folder, found.document, document)
    return {"version": document["written"]["railhil"], "line": document["headline"]}, {}


def _of_compare(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    document = _checked(folder, found.document, read_comparison(folder))
    runs = document["runs"]
    line = ", ".join(f"{one['label']} {one['verdict']}" for one in runs)
    told = {"scenario": document.get("scenario"), "seed": document.get("seed"), "line": line}
    return told | _dated(document) | {
        "version": document.get("railhil"),
        "law": ", ".join(one["label"] for one in runs),
        "verdict": _worst(one["verdict"] for one in runs),
    }, {}


def _of_sequence(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    document = given_json(folder / found.document, "what railhil sequence has written")
    _checked(folder, found.document, document)
    first, made = document["first"], document["made"]
    told = {"scenario": first.get("scenario"), "law": first.get("controller"), "seed": first.get("seed")}
    line = f"{len(made)} of {count_of(document['runs'], 'run')}"
    told |= {"version": document.get("railhil"), "line": line, "verdict": _worst(one["verdict"] for one in made)}
    return told | _dated(document), {}


def _of_faults(folder: Path, found: Found) -> tuple[dict[str, Any], Rows]:
    document = _checked(folder, found.document, read_fault_table(folder))
    wrong = [str(one.get("entry")) for one in document["rows"] if one.get("failures")]
    said = f"not as they must be: {', '.join(wrong)}" if wrong else "all as they must be"
    if missing := fault_entries_missing(document):
        said += f", stopped before {', '.join(missing)}"
    if pairs := document.get("pairs"):
        broken = sum(bool(one["failures"]) for one in pairs)
        said += f"; {count_of(len(pairs), 'random pair')}, {broken} break a rule"
    told = {name: document.get(name) for name in ("scenario", "system")}
    told |= {"law": document.get("controller"), "version": document.get("railhil")}
    told |= _dated(document)
    told |= {"line": f"{count_of(len(document['rows']), 'entry', 'entries')}, {said}"}
    rows = [
        {"folder": found.folder} | _only(one, REACTION) | {"failures": "; ".join(one.get("failures", []))}
        for one in document["rows"]
    ]
    return told | {"verdict": fault_table_verdict(document)}, {"reactions": rows}


def _worst(verdicts: Iterable[str]) -> str | None:
    known = [_VERDICTS.index(one) for one in verdicts if one in _VERDICTS]
    return _VERDICTS[max(known)] if known else None


_STUDIES: Mapping[str, Callable[[Path, Found], tuple[dict[str, Any], Rows]]] = {
    "campaign": _of_campaign,
    "compare": _of_compare,
    "dossier": _of_dossier,
    "faults": _of_faults,
    "hunt": _of_hunt,
    "learn": _of_learn,
    "probability": _of_probability,
    "sequence": _of_sequence,
}
