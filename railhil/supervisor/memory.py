"""The law's memory around a run: read before it, put into its folder, kept after a good one.

The controller writes what its law wants kept into ``telemetry.json`` at its end, in its own process or in this one;
from there it goes into ``memory.json`` of the run folder, and into the file that the run was asked to keep it in.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from railhil.common.errors import InputError
from railhil.common.whole_file import check_writable
from railhil.scenarios.memory import (
    MEMORY_AFTER,
    MEMORY_BEFORE,
    Memory,
    load_memory,
    no_memory,
    runs_said,
    write_memory,
)
from railhil.scenarios.run_spec import RunSpec
from railhil.supervisor.errors import RecordFailed, not_written
from railhil.supervisor.result import RunResult
from railhil.supervisor.telemetry import read_kept


def with_memory(spec: RunSpec, folder: Path) -> RunSpec:
    """The run with the memory that it begins with, which is then in its folder; the same run when it has none.

    :raises InputError: the file is damaged, or could not be written after the run.
    :raises OSError: the folder cannot be written.
    """
    memory = spec.law.memory
    if spec.memory_file is not None:
        path = Path(spec.memory_file)
        if memory is not None:
            raise InputError("run", "memory_file", str(path), "no other memory beside it (memory)")
        memory = _now(spec, path)
        try:
            check_writable(path)
        except OSError as error:
            raise not_written("--memory", path, "file", error) from None
    if memory is None:
        return spec
    placed = replace(memory, source=folder.resolve() / MEMORY_BEFORE)
    write_memory(placed, placed.source)
    return replace(spec, law=replace(spec.law, memory=placed))


def _now(spec: RunSpec, path: Path) -> Memory:
    """What the file holds; a file that is not there is a memory of no run."""
    return load_memory(path) if path.exists() else no_memory(spec.law.controller, path)


def memory_after(spec: RunSpec, folder: Path, result: RunResult) -> Memory | None:
    """What the law wants kept of a run; None when the run cannot be trusted, or the law has said nothing.

    :param spec: as :func:`with_memory` made it.
    """
    kept = read_kept(folder) if result.trusted else None
    if kept is None:
        return None
    path = folder.resolve() / MEMORY_AFTER
    return (spec.law.memory or no_memory(spec.law.controller, path)).after(*kept, path)


def keep_memory(spec: RunSpec, after: Memory) -> None:
    """Put the memory after a run into the file of the run, whole or not at all.

    :param spec: as :func:`with_memory` made it.
    :raises RecordFailed: the file cannot be written, or is no longer what the run began with; it stays as it is.
    """
    assert spec.memory_file is not None
    assert spec.law.memory is not None
    path = Path(spec.memory_file)
    try:
        if _now(spec, path).sha256 != spec.law.memory.sha256:
            raise RecordFailed(f"memory {path} was changed while the run was made, and stays so; {after.source} is new")
        write_memory(after, path)
    except InputError:
        raise RecordFailed(f"memory {path} was damaged while the run was made; {after.source} is new") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise RecordFailed(f"memory {path} cannot be written: {reason}; {after.source} holds it") from None


def memory_line(spec: RunSpec, result: RunResult) -> str:
    """One line on what has become of the memory; empty for a law that keeps none.

    :param spec: as :func:`with_memory` made it.
    """
    before, after = spec.law.memory, result.memory
    if before is None and after is None:
        return ""
    began = "none" if before is None or not before.runs else f"that of {runs_said(before.runs)} ({before.digest})"
    if after is None:
        why = "the law has said none" if result.trusted else "the run is INVALID"
        return f"memory: began with {began}; nothing kept, {why}"
    where = "the run folder only" if spec.memory_file is None else spec.memory_file
    return f"memory: began with {began}; kept that of {runs_said(after.runs)} ({after.digest}) in {where}"
