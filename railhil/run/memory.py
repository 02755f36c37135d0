"""A law's memory around a run: read before the run, copied into its folder, updated after a good run.

At its end the controller, which may run in its own process or in this one, writes the memory that its law wants to
keep, and the stored record that it has used, into ``telemetry.json``; from there the new record goes into
``memory.json`` of the run folder and into the memory store of the run.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Sentence, describe_os_error
from railhil.common.user_files import RecordFailed, refuse_unwritable
from railhil.record.telemetry import Kept, Learned
from railhil.scenarios.memory import MEMORY_AFTER, MEMORY_BEFORE, MemoryRecord, next_record, write_memory
from railhil.scenarios.memory_store import MemoryStore, StoreChanged
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.judge.result import Result


def with_memory(spec: RunSpec, folder: Path) -> RunSpec:
    """The run with its initial memory, copied into its folder; the same run if it has none.

    :raises InputError: the store belongs to another law, or it could not be written after the run.
    :raises OSError: the folder cannot be written.
    """
    memory = spec.law.memory
    if spec.memory_store is not None:
        store = MemoryStore(Path(spec.memory_store))
        if memory is not None:
            raise InputError(
                "run", "memory_store", str(store.path), Sentence("cannot be given with another memory (memory)")
            )
        memory = store.read(spec.law.controller)
        with refuse_unwritable("--memory", store.path, "folder"):
            store.check_writable()
    if memory is None:
        return spec
    placed = memory.move_to(folder.resolve() / MEMORY_BEFORE)
    write_memory(placed, placed.source)
    return replace(spec, law=replace(spec.law, memory=placed))


def learned(result: Result) -> Learned | None:
    """The memory left by a run that began with :func:`with_memory`; None if it cannot be trusted, or the law keeps
    nothing."""
    from railhil.record.telemetry import read_kept

    kept = read_kept(result.place) if result.trusted else None
    return None if kept is None else Learned(kept, record_after(result.scenario, result.spec, kept))


def record_after(scenario: AnyScenario, spec: RunSpec, kept: Kept) -> MemoryRecord | None:
    """The record of a law after a run; None if it has learned from this run before.

    It counts under the number of the run, or where runs have none under the next one.
    """
    before = None if spec.law.memory is None else spec.law.memory.find_record(kept.used)
    number = spec.run_number if scenario.installed_system.numbered else 1 if before is None else before.last_run + 1
    return next_record(spec.law.controller, kept.key, kept.values, before, number)


def keep_memory(result: Result) -> None:
    """Write the record of a run into the memory store of the run, completely or not at all.

    :raises RecordFailed: it cannot be written, or the store has changed since the run began; it is left as it is.
    """
    spec, after = result.spec, result.memory
    if spec.memory_store is None or after is None or after.record is None:
        return
    assert spec.law.memory is not None
    store, new = MemoryStore(Path(spec.memory_store)), result.place.resolve() / MEMORY_AFTER
    refused = {slot: fault for slot, (fault, _) in after.kept.refused.items()}
    try:
        store.write(after.record, spec.law.memory, after.kept.used, refused)
    except (StoreChanged, InputError):
        raise RecordFailed(f"memory {store.path} was changed during the run and is kept; {new} is new") from None
    except OSError as error:
        reason = describe_os_error(error)
        raise RecordFailed(f"memory {store.path} cannot be written: {reason}; {new} holds it") from None


def memory_lines(result: Result) -> list[str]:
    """Lines on the memory: each place that could not be used, then the records that the run began with and left.

    Empty for a law that keeps none.
    """
    spec = result.spec
    memory, after = spec.law.memory, result.memory
    if memory is None and after is None:
        return []
    lines, used = [], memory.newest if memory is not None and after is None else None
    where = ""
    if after is not None:
        lines = [f"memory: slot {slot} cannot be used: {detail}" for slot, (_, detail) in after.kept.refused.items()]
        used = None if memory is None else memory.find_record(after.kept.used)
        where = f" ({_place(after.kept.used)})" if used is not None else ""
    began = "none" if used is None else f"that of {count_of(used.runs, 'run')}{where}"
    if after is None:
        why = "the law supplied no memory" if result.trusted else "the run is INVALID"
        return [*lines, f"memory: began with {began}; nothing kept: {why}"]
    if after.record is None:
        assert used is not None
        why = f"run {spec.run_number} is not after run {used.last_run}, the last one learned"
        return [*lines, f"memory: began with {began}; nothing kept: {why}"]
    to = "the run folder only" if spec.memory_store is None else spec.memory_store
    kept = f"that of {count_of(after.record.runs, 'run')} ({after.record.digest})"
    return [*lines, f"memory: began with {began}; kept {kept} in {to}"]


def _place(used: str) -> str:
    return f"slot {used}" if len(used) == 1 else used
