"""Computes one chunk, from its task to the bytes of its part; run by every engine, in any process on any machine."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from typing import Protocol

import pyarrow as pa

from railhil.common.exit_codes import INVALID
from railhil.study.plan import C, P, Study
from railhil.study.table import file_bytes


class OtherCode(Exception):
    """A worker's code differs from the study's: its figures could differ too."""

    exit_code = INVALID


class Work(Protocol):
    """The work for one chunk; it is small and sent with every chunk."""

    def code(self) -> tuple[str, ...]:
        """Hashes of the code in this process on which the rows depend. Raises InputError: there is no such law."""

    def rows(self) -> pa.Table:
        """Make the runs. Raises InputError: the law has failed, or a library of the extra is missing here."""


@dataclass(frozen=True, slots=True)
class Task:
    """The data that a worker needs: ``name`` of the part, ``origin`` that identifies it, ``code`` that must make it."""

    name: str
    work: Work
    origin: str
    code: tuple[str, ...]


def task_of(study: Study[P, C], plan: P, chunk: C) -> Task:
    """The task of a chunk."""
    work = study.work(plan, chunk)
    return Task(chunk.name, work, plan.origin(chunk), work.code())


def run_task(task: Task) -> tuple[str, bytes]:
    """Run a chunk; returns its name and the bytes of its part.

    :raises OtherCode: this process runs different code from the study's.
    :raises InputError: as :meth:`Work.rows`.
    """
    if task.work.code() != task.code:
        raise OtherCode(f"worker on {platform.node()} has other code than this study: install the same railhil there")
    return task.name, file_bytes(task.work.rows(), task.origin)
