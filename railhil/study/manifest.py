"""The manifest of a study (``campaign.json``, ``learn.json``): its definition, from which it is resumed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from pydantic import AfterValidator, BaseModel, ConfigDict, create_model

from railhil.common.build import machine
from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_json
from railhil.common.version import full_version
from railhil.record.documents import Recorded
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, check_document
from railhil.record.run_folder import recorded_by
from railhil.scenarios.scenario_documents import any_document
from railhil.scenarios.validation import validate
from railhil.study.plan import C, P, Study

_FORMAT = 1
#: Fields of a request that a manifest of an earlier version lacks.
_LATER = ("settings",)


@dataclass(frozen=True, slots=True)
class Manifest:
    """An existing study: its identity (:attr:`~railhil.study.plan.AnyPlan.identity`), its request, and the version of
    railhil with which it was begun, when, where and by whom (None: of an earlier version)."""

    identity: dict[str, Any]
    request: Any
    railhil: str
    recorded: dict[str, str] | None


def _model_of(request: type[Any]) -> type[BaseModel]:
    """A request as JSON: its fields, each within the bounds of its annotation."""
    fields: dict[str, Any] = {}
    for name, hint in get_type_hints(request, include_extras=True).items():
        kind = list[get_args(hint)[0]] if get_origin(hint) is tuple else hint  # type: ignore[misc]
        fields[name] = (kind, [] if name in _LATER else ...)
    return create_model(request.__name__, __config__=ConfigDict(extra="forbid", strict=True), **fields)


def one_of(names: Sequence[str] | Callable[[], Sequence[str]]) -> AfterValidator:
    """Restricts a text to some names; a function is called when the text is checked."""

    def check(text: str) -> str:
        known = names() if callable(names) else names
        if text not in known:
            raise ValueError(f"one of {', '.join(known)}")
        return text

    return AfterValidator(check)


def read_manifest(folder: Path, study: Study[P, C]) -> Manifest:
    """The manifest of a folder.

    :raises InputError: there is none, or it was not written by such a study.
    """
    path = folder / study.manifest
    document = given_json(path, f"a file of {study.command}")
    if document.get("format") != _FORMAT:
        allowed = f"{_FORMAT}, of {study.command} of this railhil"
        raise InputError(path, "format", document.get("format", Words()), allowed)
    fields: dict[str, Any] = {study.kind: (dict[str, Any], ...), "request": (_model_of(study.request), ...)}
    fields |= {"railhil": (str, ...), "recorded": (Recorded | None, None)}
    # The part that is read back; the rest is information for people.
    model = create_model("_File", __config__=ConfigDict(extra="ignore", strict=True), **fields)
    file = validate(model, document, lambda keys: path)
    check_document(folder, study.manifest, document)
    recorded = None if file.recorded is None else file.recorded.model_dump()
    return Manifest(getattr(file, study.kind), _request_of(study, file.request), file.railhil, recorded)


def _request_of(study: Study[P, C], read: BaseModel) -> Any:
    return study.request(**{name: tuple(value) if isinstance(value, list) else value for name, value in read})


def checked_request(study: Study[P, C], request: Any, file: Path) -> Any:
    """The same request, checked against the ranges of the command line.

    :param file: for the error message.
    :raises InputError: one of its values is out of range.
    """
    document = json.loads(json.dumps(asdict(request)))
    return _request_of(study, validate(_model_of(study.request), document, lambda keys: file))


def manifest_of(study: Study[P, C], plan: P) -> dict[str, Any]:
    """Content of the manifest: the identity, under the name of the kind, must be the same when resuming; the rest is
    explanation."""
    return {
        "format": _FORMAT,
        "railhil": full_version(),
        study.kind: plan.identity,
        "request": asdict(plan.request),
        "scenario": any_document(plan.scenario),
        **study.explained(plan),
        "recorded": recorded_by(),
        "machine": machine(),
        HASH_LIST_KEY: HASH_LIST,
    }


def check_same(study: Study[P, C], folder: Path, recorded: dict[str, Any], ours: dict[str, Any]) -> None:
    """Refuse to mix two studies.

    :param recorded: identity in the manifest.
    :param ours: identity of the requested study.
    :raises InputError: naming the first difference.
    """
    for key, found, now in differing_values(recorded, json.loads(json.dumps(ours)), study.kind):
        allowed = f"{shown_value(now)} to go on with it; another --out begins a new {study.kind}"
        raise InputError(folder / study.manifest, key, found, allowed)


def differing_values(found: Any, wanted: Any, key: str) -> Iterator[tuple[str, Any, Any]]:
    """The innermost keys at which two JSON values differ, with the two values there.

    :param key: of the two values; those inside are below it, as ``campaign.laws[0].law_sha256``. A value that one side
        lacks is ``Words()``.
    """
    if isinstance(found, dict) and isinstance(wanted, dict):
        for name in sorted(found | wanted):
            yield from differing_values(found.get(name, Words()), wanted.get(name, Words()), f"{key}.{name}")
    elif isinstance(found, list) and isinstance(wanted, list):
        pairs = zip_longest(found, wanted, fillvalue=Words())
        for index, (one, other) in enumerate(pairs):
            yield from differing_values(one, other, f"{key}[{index}]")
    elif found != wanted:
        yield key, found, wanted


def shown_value(value: Any) -> str:
    """A value of :func:`differing_values` that is wanted."""
    return "no such key" if isinstance(value, Words) else repr(value)
