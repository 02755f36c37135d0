"""Parameter files of control laws: written by ``railhil tune`` or by hand, read by every command that runs a law.

::

    law = "ipfc"
    [parameters]
    softening_max = 0.83
    [training]                       # only in files that a search has written
    scenario = "lvshun_tieshan"
    seeds = [0, 1, 2, 3, 4, 5, 6, 7]

Only the controller knows which parameters a law has and what they mean: for this module they are names and values.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_text, parse_json, refuse_unreadable
from railhil.scenarios.tomlfile import parse_toml, toml_table, toml_value
from railhil.scenarios.validation import validate

#: Digits of the hash that identify a set of parameters in names, tables and the handshake.
DIGEST_DIGITS = 8


class _Training(BaseModel):
    model_config = ConfigDict(defer_build=True, extra="forbid", strict=True)
    #: Name of the scenario.
    scenario: str
    seeds: list[int] = Field(min_length=1)
    #: Notes of the search about itself.
    notes: dict[str, Any] = Field(default_factory=dict)


class _File(BaseModel):
    model_config = ConfigDict(defer_build=True, extra="forbid", strict=True)
    law: str = Field(min_length=1)
    parameters: dict[str, Any]
    training: _Training | None = None


class _StoredSet(BaseModel):
    """:meth:`ParameterSet.as_json`."""

    model_config = ConfigDict(defer_build=True, extra="forbid", strict=True)
    law: str = Field(min_length=1)
    sha256: str
    values: dict[str, Any]
    training: _Training | None = None


#: Text on the allowed seeds, for a refusal of seeds on which parameters were tuned or chosen.
OTHER_SEEDS = "other seeds for an evaluation, or --allow-training-seeds, which every table then says"


@dataclass(frozen=True)
class ParameterSet:
    """Parameters of one law, from a file.

    ``training_seeds`` are the seeds of the perturbed runs on ``training_scenario`` that a search used: the parameters
    must not be evaluated on them. ``notes`` of the search about itself are no part of the set.
    """

    law: str
    values: Mapping[str, Any]
    source: Path
    training_scenario: str = ""
    training_seeds: frozenset[int] = frozenset()
    notes: Mapping[str, Any] = field(default_factory=dict, compare=False)

    @property
    def sha256(self) -> str:
        """Hash of the law's name and its parameters, independent of the layout of the file."""
        content = json.dumps({"law": self.law, "parameters": self.values}, sort_keys=True, default=str)
        return hashlib.sha256(content.encode()).hexdigest()

    @property
    def digest(self) -> str:
        """First digits of the hash."""
        return self.sha256[:DIGEST_DIGITS]

    @property
    def controller(self) -> str:
        """Name of law and parameters in the handshake."""
        return f"{self.law}+{self.digest}"

    @property
    def text(self) -> str:
        """Content of a file that :func:`load_parameters` reads as this set."""
        found = f"law = {toml_value(self.law)}\n{toml_table('parameters', self.values)}"
        if not self.training_seeds:
            return found
        return found + toml_table(
            "training", {"scenario": self.training_scenario, "seeds": sorted(self.training_seeds)}
        )

    def as_json(self) -> dict[str, Any]:
        """The parameters' entry in a certificate: enough to write the file again."""
        training = {"scenario": self.training_scenario, "seeds": sorted(self.training_seeds)}
        return {
            "law": self.law,
            "sha256": self.sha256,
            "values": dict(self.values),
            "training": training if self.training_seeds else None,
        }

    def find_seen(self, seeds: Iterable[int]) -> list[int]:
        """The given seeds that the search used, in order, for any scenario.

        A seed draws the same mass, resistance, force and delay for every scenario.
        """
        return sorted(self.training_seeds.intersection(seeds))

    def check_unseen(self, seeds: Iterable[int], allowed: str = OTHER_SEEDS) -> None:
        """Refuse to evaluate the parameters on runs that were used to find them.

        :param allowed: what the user can do instead.
        :raises InputError: one of the seeds is a training seed.
        """
        if seen := self.find_seen(seeds):
            found = Words(f"seed {seen[0]}, on which these parameters were tuned")
            raise InputError(self.source, "training.seeds", found, allowed)


def parameters_from_json(document: Mapping[str, Any], source: Path) -> ParameterSet:
    """The parameters in a document made by :meth:`ParameterSet.as_json`.

    :param source: the file that it comes from.
    :raises InputError: it is not such a document, or its values do not match its hash.
    """
    file = validate(_StoredSet, dict(document), lambda keys: source)
    found = _check_finite(_parameter_set(file.law, file.values, source, file.training))
    if file.sha256 != found.sha256:
        raise InputError(source, "parameters.sha256", file.sha256, f"{found.sha256}: values that nobody changed")
    return found


def _parameter_set(law: str, values: Mapping[str, Any], source: Path, training: _Training | None) -> ParameterSet:
    if training is None:
        return ParameterSet(law, values, source)
    return ParameterSet(law, values, source, training.scenario, frozenset(training.seeds), training.notes)


def _check_finite(given: ParameterSet) -> ParameterSet:
    for key, value in given.values.items():
        if isinstance(value, float) and not math.isfinite(value):
            raise InputError(given.source, f"parameters.{key}", value, "a finite number")
    return given


def _read_json(path: Path, text: str) -> ParameterSet:
    try:
        document = parse_json(text)
    except RecursionError:
        document = None
    # A certificate contains the same document among other things.
    document = document.get("parameters", document) if isinstance(document, dict) else None
    if not isinstance(document, dict):
        raise ValueError("no JSON object with parameters")
    return parameters_from_json(document, path)


def load_parameters(path: Path) -> ParameterSet:
    """Read a parameter file, or ``parameters.json`` or ``certificate.json`` of a run folder.

    :raises InputError: it cannot be read, or does not have the format described at the top of this module.
    """
    with refuse_unreadable(path, "a parameter file (TOML)"):
        text = given_text(path)
        if path.suffix.lower() == ".json":
            return _read_json(path, text)
        content = parse_toml(text)
    file = validate(_File, content, lambda keys: path)
    return _check_finite(_parameter_set(file.law, file.parameters, path, file.training))
