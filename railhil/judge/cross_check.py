"""Values that a run folder contains more than once must be the same everywhere.

The list of hashes finds a file that was changed alone. This module compares the documents with each other and with the
record, also in a folder without a list.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from railhil.bus.ident import CtlIdent, Ident, PltIdent, Role, SupIdent, make_ident
from railhil.common.errors import InputError, Words, short_repr
from railhil.common.streams import one_line
from railhil.common.user_files import refuse_unreadable
from railhil.dbc import PORTS, recorded_contract
from railhil.judge.fault_report import logged_outcomes
from railhil.judge.folder import code_sha256
from railhil.record.documents import CERTIFICATE, SCORE, read_score
from railhil.record.hash_list import check_hash_list
from railhil.record.target import read_target
from railhil.record.trace import Trace
from railhil.scenarios.given import TARGET
from railhil.scenarios.layers import faults_of_rows
from railhil.scenarios.model import AnyScenario, list_injected_faults
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.settings import REQUIREMENTS, required
from railhil.scenarios.system import DEFAULT, system_named

JUNIT: Final = "junit.xml"
#: Keys of the certificate that ``score.json`` has in its part ``run``.
_OF_THE_RUN: Final = (
    "scenario", "settings", "faults", "controller", "arithmetic", "indexing", "task_period_ms", "seed", "perturbed",
    "run_number", "pace", "rate", "orders", "requirements", "transport", "frames", "seed_was_trained",
)  # fmt: skip
#: Keys that ``junit.xml`` has as properties.
_OF_JUNIT: Final = ("scenario", "seed", "verdict", "frames_sha256", "arithmetic")
#: Beginning of the names of cases of requirements there.
_CASE = "requirement "
_VIOLATED = "violated"
#: The columns of the nodes' logs on a fault.
_LOGGED: Final = ("number", "begun_s", "effect_s", "ended_s", "hits")


def check_folder(folder: Path, document: Mapping[str, Any] | None) -> None:
    """Check the files of a run folder against its list of hashes, then its documents against each other.

    :param document: its certificate; None: there is none.
    :raises InputError: the first file that differs.
    :raises ContractError: port table, DBC and certificate do not belong together.
    """
    check_hash_list(folder, CERTIFICATE, document)
    if document is None:
        return
    if (folder / PORTS).is_file():
        system = system_named(str(document.get("system") or DEFAULT), folder / CERTIFICATE)
        recorded_contract(folder, document.get("dbc_sha256"), system.contract)
    for other, key, found, certified in (*_score(folder, document), *_junit(folder, document)):
        if found != certified:
            raise InputError(folder / CERTIFICATE, key, certified, f"{short_repr(found)}, as in {other} beside it")


def _score(folder: Path, document: Mapping[str, Any]) -> Iterator[tuple[str, str, Any, Any]]:
    """File, key, its value there, and the value in the certificate."""
    score = read_score(folder)
    if score is None:
        return
    run = score["run"]
    for key in ("verdict", "line"):
        if key in score and key in document:
            yield SCORE, key, score[key], document[key]
    for key in _OF_THE_RUN:
        if key in run and key in document:
            yield SCORE, key, run[key], document[key]
    outcomes = score.get(REQUIREMENTS, [])
    sentences = [[one.get("id"), one.get("says")] for one in required(document, folder / CERTIFICATE)]
    yield SCORE, REQUIREMENTS, [[one["id"], one["says"]] for one in outcomes], sentences
    if document.get("verdict") == "PASS" and any(one["verdict"] == _VIOLATED for one in outcomes):
        yield SCORE, "verdict", "FAIL", "PASS"
    if "faults" in score and "injected" in document:
        yield SCORE, "injected", score["faults"], document["injected"]
    for key in ("parameters", "memory"):
        digest, certified = run.get(key), document.get(key)
        if isinstance(digest, str) or certified is not None:
            sha256 = None if certified is None else str(certified["sha256"])
            yield SCORE, f"{key}.sha256", digest, sha256 if sha256 is None or digest is None else sha256[: len(digest)]


def _junit(folder: Path, document: Mapping[str, Any]) -> Iterator[tuple[str, str, Any, Any]]:
    path = folder / JUNIT
    if not path.is_file():
        return
    expected = "what railhil run has written"
    try:
        with refuse_unreadable(path, expected):
            tree = ET.parse(path)
    except ET.ParseError as error:
        raise InputError(path, "", Words("cannot be read"), expected, str(error)) from None
    properties = {entry.get("name"): entry.get("value") for entry in tree.iter("property")}
    _check_cases(path, tree.getroot(), properties.get("verdict"))
    _check_requirements(path, tree.getroot(), read_score(folder) or {})
    for key in _OF_JUNIT:
        if key in properties and key in document:
            yield JUNIT, key, properties[key], one_line(str(document[key]))
    label, controller = properties.get("controller"), document.get("controller")
    if label is not None and controller is not None and not label.startswith(one_line(str(controller))):
        yield JUNIT, "controller", label, controller


def _check_cases(path: Path, suite: ET.Element, verdict: str | None) -> None:
    """Check the cases of ``junit.xml`` against their numbers and its verdict.

    A run may be FAIL for a reason that is no case, such as a lost controller.

    :raises InputError: they contradict each other.
    """
    for key in ("failures", "errors"):
        said, found = suite.get(key), sum(1 for _ in suite.iter(key.removesuffix("s")))
        if said is not None and said != str(found):
            raise InputError(path, key, said, f"{found}, the cases that have one")
        if found and verdict in (("PASS",) if key == "failures" else ("PASS", "FAIL")):
            raise InputError(path, key, found, f"0 with the verdict {verdict}")


def _check_requirements(path: Path, suite: ET.Element, score: Mapping[str, Any]) -> None:
    """Check the cases of requirements in ``junit.xml`` against the outcomes in ``score.json``; an INVALID run has none.

    :raises InputError: they contradict each other.
    """
    cases = {one.get("name", ""): one.find("failure") is not None for one in suite.iter("testcase")}
    found = {name: failed for name, failed in cases.items() if name.startswith(_CASE)}
    wanted = {one_line(f"{_CASE}{one['id']}"): one["verdict"] == _VIOLATED for one in score.get(REQUIREMENTS, ())}
    if found != wanted and next(suite.iter("error"), None) is None:
        said, allowed = (
            ", ".join(f"{name}{' failed' * failed}" for name, failed in one.items()) or "none"
            for one in (found, wanted)
        )
        raise InputError(path, REQUIREMENTS, Words(said), f"{allowed}, as in {SCORE} beside it")


def check_record(folder: Path, document: Mapping[str, Any], scenario: AnyScenario, trace: Trace) -> None:
    """Check the certificate against the handshake in the record and the logs of the faults.

    :raises InputError: the first difference.
    """
    path = folder / CERTIFICATE
    target = read_target(folder)
    if document.get("target") != (None if target is None else target.model_dump()):
        raise InputError(path, "target", document.get("target"), f"what {TARGET} beside it has")
    sup, plant = trace.ident(SupIdent), trace.ident(PltIdent)
    if "controller" in document and plant is not None:
        spec = RunSpec.from_json({**document, "plant_fmu": None}, path)
        _check_described(path, document, spec, scenario)
        own = make_ident(Role.SUPERVISOR, scenario.sha256, **spec.identity, contract=trace.contract)
        said: list[str] = []
        for ident in (plant, trace.ident(CtlIdent), sup):
            said += [] if ident is None else _differences(ident, own)
        if said:
            allowed = f"what {PltIdent.PORT}, {CtlIdent.PORT} and {SupIdent.PORT} in the record say"
            raise InputError(path, "handshake", Words("; ".join(said)), allowed)
    if not scenario.faults or "injected" not in document or plant is None:
        return
    logged = logged_outcomes(folder, scenario, plant.seed)
    certified = document["injected"]
    for one in logged:
        wanted = {key: one.as_json()[key] for key in _LOGGED}
        found = next((row for row in certified if row["number"] == one.number), None)
        if found is None or {key: found[key] for key in _LOGGED} != wanted:
            raise InputError(path, f"injected {one.number}", found, f"{wanted}, as in the logs of the faults beside it")


def _check_described(path: Path, document: Mapping[str, Any], spec: RunSpec, scenario: AnyScenario) -> None:
    """Check the run described by the certificate against the scenario whose hash ``PLT_IDENT`` in the record has.

    A user's scenario may have changed since or be elsewhere, and a shipped one may differ in another version. Then only
    the faults can be compared, which the scenario of the record lists.

    :raises InputError: the certificate describes another scenario.
    """
    allowed = f"that of {PltIdent.PORT} in the record"
    wanted = document.get("scenario_sha256")
    if wanted is not None and wanted != scenario.sha256:
        raise InputError(path, "scenario_sha256", wanted, f"{scenario.sha256}, {allowed}")
    was = list_injected_faults(scenario.faults)
    for text in spec.faults:
        # As when the scenario was read: a fault at a planned instant begins at its time.
        planned = faults_of_rows([text], scenario.installed_system, lambda _: path, scenario.marks)
        if list_injected_faults(planned)[0] not in was:
            raise InputError(path, "faults", text, f"a fault of the scenario with the hash {allowed}")
    try:
        derived = spec.load().sha256
        said = f"hash {derived[:8]}"
    except InputError as error:
        derived, said = "", str(error)
    if derived != scenario.sha256 and not spec.scenario.endswith(".toml") and _is_by_this_code(document, scenario):
        found = Words(f"{' '.join(spec.scenario_words)}: {said}")
        raise InputError(path, "scenario, settings, faults", found, f"{scenario.sha256[:8]}, {allowed}")


def _is_by_this_code(document: Mapping[str, Any], scenario: AnyScenario) -> bool:
    """Whether this installation has the shipped scenarios of the record."""
    ours = {"code_sha256": code_sha256(), "system_sha256": scenario.installed_system.code_sha256()}
    return all(document.get(key) == value for key, value in ours.items())


def _differences(ident: Ident, own: Ident) -> list[str]:
    """Disagreements of a node and the certificate; the certificate does not hold the version of the handshake."""
    return ident.differences(replace(own, version=ident.version))


def check_handshake(log: Path, scenario: AnyScenario, trace: Trace) -> None:
    """Check the handshake of a log against scenario and DBC.

    :raises InputError: they do not belong together.
    """
    ident = trace.ident(PltIdent)
    if ident is None:
        raise InputError(log, "PLT_IDENT", Words("no such telegram"), "a log that railhil recorded from its start")
    wanted_wire = int(trace.contract.sha256[:8], 16)
    if ident.wire_hash != wanted_wire:
        raise InputError(log, "DBC hash", f"{ident.wire_hash:08x}", f"{wanted_wire:08x} (the DBC of the record)")
    wanted = int(scenario.sha256[:8], 16)
    if ident.scenario_hash != wanted:
        raise InputError(log, "scenario hash", f"{ident.scenario_hash:08x}", f"{wanted:08x} ({scenario.name})")
    # The plant repeats its handshake during the run: a log that begins later has this one, and not the other two.
    if trace.ident(SupIdent) is None and trace.count(trace.contract.clock_port.name):
        raise InputError(log, "SUP_IDENT", Words("no such telegram"), "a log that railhil recorded from its start")
