"""``campaign.json``: the definition of a campaign, so that it is resumed as it began."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from railhil.campaign.plan import ALL_LAWS, CHUNK_MAX, RUNS_MAX, Plan, Request
from railhil.common.build import machine
from railhil.common.choices import INDEXINGS
from railhil.common.command_line import SEED_MAX
from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, check_document
from railhil.scenarios import system as systems
from railhil.scenarios.stored import any_document
from railhil.scenarios.validation import validated

MANIFEST = "campaign.json"
_FORMAT = 1
_LIBRARIES = ("numpy", "numba", "pyarrow", "scipy")


def _one_of(names: Callable[[], Sequence[str]]) -> AfterValidator:
    def check(text: str) -> str:
        if text not in names():
            raise ValueError(f"one of {', '.join(names())}")
        return text

    return AfterValidator(check)


def _known_laws() -> list[str]:
    """Laws of all installed systems; whether one fits the scenario is seen when the plan is made."""
    return [*dict.fromkeys(law for name in systems.names() for law in systems.system_named(name).law_names()), ALL_LAWS]


class _Request(BaseModel):
    """:class:`~railhil.campaign.plan.Request` as JSON, with the bounds of the command line."""

    model_config = ConfigDict(extra="forbid", strict=True)
    scenario: str = Field(min_length=1)
    settings: list[str] = []
    runs: int = Field(ge=1, le=RUNS_MAX)
    first_seed: int = Field(ge=0, le=SEED_MAX)
    laws: list[Annotated[str, _one_of(_known_laws)]]
    both: bool
    arithmetic: Annotated[str, _one_of(arithmetics)]
    indexing: Annotated[str, _one_of(lambda: INDEXINGS)]
    parameters: list[str]
    chunk: int = Field(ge=1, le=CHUNK_MAX)
    allow_training_seeds: bool


class _File(BaseModel):
    """The part that is read back; the rest is information for people."""

    model_config = ConfigDict(extra="ignore", strict=True)
    campaign: dict[str, Any]
    request: _Request


@dataclass(frozen=True, slots=True)
class Manifest:
    """An existing campaign: its identity (:attr:`~railhil.campaign.plan.Plan.identity`) and its request."""

    campaign: dict[str, Any]
    request: Request


def read_manifest(folder: Path) -> Manifest:
    """``campaign.json`` of a folder.

    :raises InputError: there is none, or it was not written by a campaign.
    """
    path = folder / MANIFEST
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, "", Words((error.strerror or str(error)).lower()), "folder of a campaign") from None
    except (ValueError, RecursionError):
        raise InputError(path, "", Words("no JSON"), "what `railhil campaign` has written") from None
    if not isinstance(document, dict) or document.get("format") != _FORMAT:
        raise InputError(path, "format", Words("something else"), f"{_FORMAT}, of a campaign of this railhil")
    file = validated(_File, document, lambda keys: path)
    check_document(folder, MANIFEST, document)
    return Manifest(file.campaign, _request_of(file.request))


def _request_of(read: _Request) -> Request:
    values: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in read}
    return Request(**values)


def checked_request(request: Request, file: Path) -> Request:
    """The same request, checked against the ranges of the command line.

    :param file: for the error message.
    :raises InputError: one of its values is out of range.
    """
    return _request_of(validated(_Request, json.loads(json.dumps(asdict(request))), lambda keys: file))


def manifest(plan: Plan) -> dict[str, Any]:
    """Content of ``campaign.json``: ``campaign`` must be the same when resuming, the rest is explanation."""
    return {
        "format": _FORMAT,
        "railhil": version("railhil"),
        "campaign": plan.identity,
        "request": plan.request_document(),
        "scenario": any_document(plan.scenario),
        "parameters": {
            entry.label: dict(entry.parameters.values) for entry in plan.entries if entry.parameters is not None
        },
        "machine": machine(),
        HASH_LIST_KEY: HASH_LIST,
        "libraries": {name: version(name) for name in _LIBRARIES},
    }
