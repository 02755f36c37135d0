"""A law's memory around a run: read before the run, copied into its folder, updated after a good run.

At its end the controller, which may run in its own process or in this one, writes what its law wants to keep into
``telemetry.json``; from there it is copied into ``memory.json`` of the run folder and into the memory file of the run.
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
    """The run with its initial memory, copied into its folder; the same run if it has none.

    :raises InputError: the file is damaged, or it could not be written after the run.
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
    """The content of the file; without a file, an empty memory of no runs."""
    return load_memory(path) if path.exists() else no_memory(spec.law.controller, path)


def memory_after(spec: RunSpec, folder: Path, result: RunResult) -> Memory | None:
    """The memory after a run; None if the run cannot be trusted, or the law keeps nothing.

    :param spec: the result of :func:`with_memory`.
    """
    kept = read_kept(folder) if result.trusted else None
    if kept is None:
        return None
    path = folder.resolve() / MEMORY_AFTER
    return (spec.law.memory or no_memory(spec.law.controller, path)).after(*kept, path)


def keep_memory(spec: RunSpec, after: Memory) -> None:
    """Write the memory after a run into the memory file of the run, completely or not at all.

    :param spec: the result of :func:`with_memory`.
    :raises RecordFailed: the file cannot be written, or has changed since the run began; it is left as it is.
    """
    assert spec.memory_file is not None
    assert spec.law.memory is not None
    path = Path(spec.memory_file)
    try:
        if _now(spec, path).sha256 != spec.law.memory.sha256:
            raise RecordFailed(f"memory {path} was changed during the run and is kept; {after.source} is new")
        write_memory(after, path)
    except InputError:
        raise RecordFailed(f"memory {path} was damaged during the run; {after.source} is new") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise RecordFailed(f"memory {path} cannot be written: {reason}; {after.source} holds it") from None


def memory_line(spec: RunSpec, result: RunResult) -> str:
    """One line on what happened to the memory; empty for a law that keeps none.

    :param spec: the result of :func:`with_memory`.
    """
    before, after = spec.law.memory, result.memory
    if before is None and after is None:
        return ""
    began = "none" if before is None or not before.runs else f"that of {runs_said(before.runs)} ({before.digest})"
    if after is None:
        why = "the law supplied no memory" if result.trusted else "the run is INVALID"
        return f"memory: began with {began}; nothing kept: {why}"
    where = "the run folder only" if spec.memory_file is None else spec.memory_file
    return f"memory: began with {began}; kept that of {runs_said(after.runs)} ({after.digest}) in {where}"
