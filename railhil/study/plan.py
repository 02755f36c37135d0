"""The plan of a study: runs in chunks, an identity that must not change, and its kind's description of the rows."""

from __future__ import annotations

import argparse
import hashlib
import json
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from railhil.common.exit_codes import PASS
from railhil.common.held_code import held_sha256
from railhil.common.plug_ins import entries
from railhil.controller_node import laws as registered
from railhil.judge.folder import code_sha256
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.scenarios.system import system_named

if TYPE_CHECKING:
    import pyarrow as pa
    from rich.table import Table
    from rich.text import Text

    from railhil.study.engines import Engine, Say
    from railhil.study.execute import Outcome
    from railhil.study.finished import Verified
    from railhil.study.work import Work

#: Code on which the figures of perturbed runs depend, in addition to the bench's (``certificate.json``).
_OWN_CODE = ("batch", "study/table.py", "study/work.py", "campaign/rows.py", "campaign/study.py")
_SHARD = re.compile(r"([0-9]{1,6})/([0-9]{1,6})", re.ASCII)


class AnyChunk(Protocol):
    """The unit of work, of repetition and of loss: ``name`` of its part without suffix, and how many ``runs``."""

    @property
    def name(self) -> str: ...

    @property
    def runs(self) -> int: ...


C = TypeVar("C", bound=AnyChunk)


class AnyPlan(Protocol[C]):
    """The runs of a study. ``request``: as given. ``identity``: must be the same when the study is resumed.
    ``results_origin``: identifies the table of all runs."""

    @property
    def scenario(self) -> AnyScenario: ...

    @property
    def request(self) -> Any: ...

    @property
    def identity(self) -> dict[str, Any]: ...

    @property
    def results_origin(self) -> str: ...

    def chunks(self) -> Sequence[C]:
        """All chunks, in the order of the rows of the results."""

    def origin(self, chunk: C) -> str:
        """Identity of the part of a chunk: the data that determine its rows."""


class PlanOfSubject(ABC):
    """A plan whose ``subject``, everything that determines a row, identifies results and parts by its hash."""

    @property
    @abstractmethod
    def subject(self) -> dict[str, Any]:
        """As JSON."""

    @property
    def identity(self) -> dict[str, Any]:
        """The values that must be unchanged when the study is resumed."""
        return self.subject

    @property
    def results_origin(self) -> str:
        """Hash of :attr:`subject`; recorded in the results and in every part."""
        return sha256_of_json(self.subject)

    def origin(self, chunk: Any) -> str:
        """The identification of a part. A longer study has the same first parts."""
        return f"{self.results_origin} {chunk.name}"


P = TypeVar("P", bound=AnyPlan[Any])


@dataclass(frozen=True)
class Study(Generic[P, C]):
    """One kind of study.

    ``name``: of the command, and of its folders and manifests. ``kind``: what is in these folders, also the key of the
    identity in the manifest. ``request``: class of the
    requests, a dataclass whose annotations have the bounds of the command line. ``make_plan``: (request) -> plan;
    raises InputError. ``columns``: (plan) -> columns of its rows. ``check_rows``: (rows of a part, plan, chunk);
    raises NotThePart. ``work``: (plan, chunk) -> the work of a worker. ``summary``: (plan, rows) -> ``summary.json``.
    ``explained``: (plan) -> further entries of the manifest for people. ``items``: (plan) -> how many there are of what
    ``--verify`` makes again; ``repeat``: (plan, rows, place of one) -> its runs made again on the bench, and how they
    differ. ``lines``: (plan, summary, folder) -> what is printed of the results, lines and tables. ``page``:
    ``module:function`` of (plan, outcome, sentence of its origin) -> its page, which needs the extra ``report``; empty:
    it has none. ``ends_with_page``: whether the page is written at the end; else only ``railhil report`` writes it.
    ``finish``: (plan, outcome, engine, say) -> the outcome with what is made of all rows by further runs;
    ``completed``: (outcome without these) -> the same, read from its folder; raises InputError. ``controllers``:
    (request, identity) -> entries of the identity of the user's controllers, by their texts. ``exit_code``: (plan,
    outcome) -> of the finished command.
    ``cut``: (plan, n) -> the plan of its first n chunks, for a study that may end by time; None: it may not. ``grown``:
    (plan, rows) -> the plan with the chunks of these rows, where ``finish`` adds some. ``unit``: what a row is.
    """

    name: str
    kind: str
    request: type[Any]
    make_plan: Callable[..., P]
    columns: Callable[[P], pa.Schema]
    check_rows: Callable[[pa.Table, P, C], None]
    work: Callable[[P, C], Work]
    summary: Callable[[P, pa.Table], dict[str, Any]]
    items: Callable[[P], int]
    repeat: Callable[[P, pa.Table, int], Iterable[Verified]]
    lines: Callable[[P, Mapping[str, Any], Path], Iterable[str | Text | Table]]
    explained: Callable[[P], Mapping[str, Any]] = lambda plan: {}
    page: str = ""
    ends_with_page: bool = True
    finish: Callable[[P, Outcome, Engine, Say], Outcome] = lambda plan, made, engine, say: made
    completed: Callable[[Outcome], Outcome] = lambda made: made
    controllers: Callable[[Any, Mapping[str, Any]], Mapping[str, Mapping[str, Any]]] = lambda request, identity: {}
    exit_code: Callable[[P, Outcome], int] = lambda plan, made: PASS
    cut: Callable[[P, int], P] | None = None
    grown: Callable[[P, pa.Table], P] = lambda plan, rows: plan
    unit: str = "run"

    @property
    def command(self) -> str:
        """The command, which continues a study with ``--resume``."""
        return f"railhil {self.name}"

    @property
    def manifest(self) -> str:
        """Name of the manifest."""
        return f"{self.name}.json"


@dataclass(frozen=True, slots=True)
class Shard:
    """Every ``count``-th chunk from ``number`` (from 1) on."""

    number: int
    count: int

    @classmethod
    def parse(cls, text: str) -> Shard:
        """An option's type: ``K/N``."""
        match = _SHARD.fullmatch(text)
        if match is None or not 1 <= int(match[1]) <= int(match[2]):
            raise argparse.ArgumentTypeError(f"found {text}, allowed K/N with K from 1 to N, such as 2/4")
        return cls(int(match[1]), int(match[2]))

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def of(self, chunks: Sequence[C]) -> Sequence[C]:
        """Its chunks."""
        return chunks[self.number - 1 :: self.count]


def sha256_of_json(document: Mapping[str, Any]) -> str:
    """Hash of a document, independent of the order of its keys."""
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()


@lru_cache(maxsize=8)
def batch_sha256(*further: str) -> str:
    """Hash over the code, beyond the bench's own, on which the figures depend.

    :param further: packages and modules.
    """
    return code_sha256((*_OWN_CODE, *further))


def origin_of(scenario: AnyScenario, own_code: Sequence[str] = (), law: LawSpec | None = None) -> dict[str, Any]:
    """What determines the rows of every study: hashes of its scenario and of all code.

    :param own_code: as for :func:`batch_sha256`.
    :param law: of all runs; None: the study has several.
    """
    return {
        "scenario": scenario.name,
        "scenario_sha256": any_judged_sha256(scenario),
        **({} if law is None else {"law_sha256": controller_sha256(law, scenario.system)}),
        "code_sha256": bench_sha256(),
        "batch_sha256": batch_sha256(*own_code),
        "system_sha256": scenario.installed_system.code_sha256(),
    }


def code_of(law: LawSpec, system: str, own_code: Sequence[str] = ()) -> tuple[str, ...]:
    """Hashes of the code in this process on which the rows of a law depend. Raises InputError: there is no such law."""
    return bench_sha256(), batch_sha256(*own_code), controller_sha256(law, system)


@lru_cache(maxsize=1)
def bench_sha256() -> str:
    """:func:`railhil.judge.folder.code_sha256`, once per process."""
    return code_sha256()


@lru_cache(maxsize=64)
def law_named(name: str, system: str) -> Any:
    """:func:`railhil.controller_node.laws.find`, which searches all installed packages, called once per law."""
    return registered.find(name, system_named(system).laws)


@lru_cache(maxsize=64)
def law_sha256(name: str, system: str) -> str:
    """Hash of all code on which a law may depend: :func:`~railhil.common.held_code.held_sha256`. Raises InputError."""
    law_named(name, system)
    entry = entries(system_named(system).laws)[name]
    return held_sha256(entry.module, entry.dist)


def controller_sha256(law: LawSpec, system: str) -> str:
    """:func:`law_sha256` of a law, or the digest of a controller of the user. Raises InputError."""
    return law_sha256(law.controller, system) if law.given is None else law.given.digest
