"""The slots of a law's memory: the other one if one is damaged, and one that is whole whenever writing is killed."""

from __future__ import annotations

import fcntl
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.scenarios.memory import Memory, MemoryRecord
from railhil.scenarios.memory_store import MemoryStore, StoreChanged, read_memory


def record(runs: int, law: str = "mylaw") -> MemoryRecord:
    return MemoryRecord(law, "here", runs, runs, {"offset_m": runs / 10})


def after(path: Path, runs: int) -> MemoryStore:
    """A store after so many runs."""
    store, used = MemoryStore(path), ""
    for number in range(1, runs + 1):
        used = store.write(record(number), store.read("mylaw"), used, {})
    return store


def places(memory: Memory) -> list[tuple[str, int, str]]:
    return [(one.slot, 0 if one.record is None else one.record.runs, one.fault) for one in memory.stored]


def test_slots_are_written_by_turns(tmp_path: Path) -> None:
    path = tmp_path / "new" / "store"
    assert places(MemoryStore(path).read("mylaw")) == []
    assert places(after(path, 1).read()) == [("A", 1, "")]
    assert places(after(tmp_path / "2", 2).read()) == [("B", 2, ""), ("A", 1, "")]
    store = after(tmp_path / "3", 3)
    assert places(store.read()) == [("A", 3, ""), ("B", 2, "")]
    assert sorted(entry.name for entry in store.path.iterdir()) == ["a.json", "b.json"]
    assert (store.path / "a.json").read_text() == record(3).text


@pytest.mark.parametrize(
    ("damage", "fault"),
    [
        (lambda text: text[: len(text) // 2], "json"),
        (lambda text: "", "json"),
        (lambda text: text.replace("0.3", "-0.3"), "crc"),
        (lambda text: text.replace("0.3", "NaN"), "not_finite"),
        (lambda text: text.replace('"version": 1', '"version": 7'), "crc"),
    ],
)
def test_a_damaged_slot_costs_one_run(damage: object, fault: str, tmp_path: Path) -> None:
    store = after(tmp_path, 3)
    bad = damage(record(3).text)  # type: ignore[operator]
    (tmp_path / "a.json").write_text(bad)
    found = store.read("mylaw")
    assert places(found) == [("B", 2, ""), ("A", 0, fault)]
    # The run goes on from slot B; the damaged file is kept aside.
    assert store.write(record(3), found, "B", {}) == "A"
    assert places(store.read()) == [("A", 3, ""), ("B", 2, "")]
    (aside,) = (tmp_path / "refused").iterdir()
    assert aside.read_text() == bad


def test_any_changed_byte_is_noticed(tmp_path: Path) -> None:
    """Random bytes never pass: a CRC finds every change of one byte, and JSON most others."""
    store, text = after(tmp_path, 3), record(3).text.encode()
    for place in range(len(text)):
        for bits in (0x01, 0x20, 0x80):
            changed = bytearray(text)
            changed[place] ^= bits
            (tmp_path / "a.json").write_bytes(changed)
            first = store.read("mylaw").stored[0]
            # Blanks and the case of nothing else are not part of what the CRC covers.
            assert first.slot == "B" or first.record == record(3), (place, bits)


def test_both_slots_damaged_then_the_default_then_nothing(tmp_path: Path) -> None:
    store = after(tmp_path, 2)
    for name in ("a.json", "b.json"):
        (tmp_path / name).write_text("torn")
    assert places(store.read("mylaw")) == [("A", 0, "json"), ("B", 0, "json")]
    (tmp_path / "default.json").write_text(record(40).text)
    found = store.read("mylaw")
    assert places(found) == [("default", 40, ""), ("A", 0, "json"), ("B", 0, "json")]
    assert store.write(record(41), found, "default", {}) == "A"
    # A slot is better than the default, however many runs that has.
    (tmp_path / "default.json").write_text(record(400).text)
    assert places(store.read("mylaw")) == [("A", 41, ""), ("default", 400, "")]
    assert len([*(tmp_path / "refused").iterdir()]) == 2


def test_what_the_law_refused_is_kept_aside(tmp_path: Path) -> None:
    store = after(tmp_path, 3)
    assert store.write(record(3), store.read(), "B", {"A": "values"}) == "A"
    assert [one.name[0] for one in (tmp_path / "refused").iterdir()] == ["a"]
    assert places(store.read()) == [("A", 3, ""), ("B", 2, "")]


def test_a_memory_goes_on_without_a_store_as_with_it(tmp_path: Path) -> None:
    """Also after faults, and with a default."""
    store = MemoryStore(tmp_path)
    (tmp_path / "default.json").write_text(record(3).text)
    memory = store.read("mylaw")
    for number in range(4, 16):
        used = memory.stored[0].slot
        refused = {"A": "key"} if number == 8 and used == "B" else {}
        store.write(record(number), memory, used, refused)
        memory = memory.add_run(record(number), used, refused)
        assert memory == store.read("mylaw")
        if number in (6, 9, 12):
            for name in ("a.json", "b.json")[: number // 6]:
                (tmp_path / name).write_text("torn")
            memory = store.read("mylaw")


def test_a_slot_that_is_a_folder_or_a_dead_link_is_no_crash(tmp_path: Path) -> None:
    store = after(tmp_path, 1)
    (tmp_path / "b.json").mkdir()
    assert places(store.read("mylaw")) == [("A", 1, ""), ("B", 0, "unreadable")]
    store.check_writable()
    assert store.write(record(2), store.read("mylaw"), "A", {}) == "B"
    (tmp_path / "a.json").unlink()
    (tmp_path / "a.json").symlink_to(tmp_path / "nowhere")
    assert places(store.read("mylaw")) == [("B", 2, ""), ("A", 0, "unreadable")]
    assert store.write(record(3), store.read("mylaw"), "B", {}) == "A"
    assert places(store.read()) == [("A", 3, ""), ("B", 2, "")]


@pytest.mark.timeout(20)
def test_a_slot_that_is_a_pipe_or_a_device_is_not_read(tmp_path: Path) -> None:
    """Opening a pipe waits for its writer, and a device has no end."""
    store = after(tmp_path, 1)
    os.mkfifo(tmp_path / "b.json")
    (tmp_path / "default.json").symlink_to("/dev/zero")
    found = store.read("mylaw")
    assert places(found) == [("A", 1, ""), ("B", 0, "unreadable"), ("default", 0, "unreadable")]
    assert [one.detail for one in found.stored[1:]] == [
        "is a pipe, expected a regular file",
        "is a device or socket, expected a regular file",
    ]
    assert store.write(record(2), found, "A", {}) == "B"
    assert (tmp_path / "refused" / "b-unreadable.json").is_fifo()


def test_a_lock_of_another_program_ends_the_wait(tmp_path: Path) -> None:
    store = after(tmp_path, 1)
    holder = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(holder, fcntl.LOCK_EX)
    with pytest.raises(OSError, match=r"locked by another program for 0\.05 s"):
        MemoryStore(tmp_path, 0.05).write(record(2), store.read(), "A", {})
    os.close(holder)
    assert store.write(record(2), store.read(), "A", {}) == "B"


def test_a_store_that_somebody_else_has_written_stays(tmp_path: Path) -> None:
    store = after(tmp_path, 1)
    began = store.read()
    store.write(record(2), began, "A", {})
    with pytest.raises(StoreChanged):
        store.write(record(2), began, "A", {})
    assert places(store.read()) == [("B", 2, ""), ("A", 1, "")]


def test_a_full_disk_leaves_the_old_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = after(tmp_path, 2)
    began = store.read()

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space left"):
        store.write(record(3), began, "B", {})
    assert store.read() == began


def test_a_store_of_another_law_and_a_file_are_one_line(tmp_path: Path) -> None:
    after(tmp_path / "store", 1)
    with pytest.raises(InputError, match=r"a\.json: law: found 'mylaw', allowed other, the law of this store"):
        MemoryStore(tmp_path / "store").read("other")
    with pytest.raises(InputError, match=r"a\.json: is a file, expected a folder .*copy it to FOLDER/default\.json"):
        MemoryStore(tmp_path / "store" / "a.json").read("mylaw")


def test_a_memory_is_named_by_its_store_or_a_file(tmp_path: Path) -> None:
    store = after(tmp_path / "store", 2)
    assert read_memory(store.path) == store.read()
    assert places(read_memory(store.path / "a.json")) == [("file", 1, "")]
    with pytest.raises(InputError, match="has no record, expected a folder in which railhil keeps"):
        read_memory(tmp_path)
    (tmp_path / "a.json").write_text("torn")
    with pytest.raises(InputError, match="slot A cannot be used: cannot be read"):
        read_memory(tmp_path)


#: Runs of a train whose computer is killed at any instant: each is started again until its record is stored.
_KILLED = """
import os, random, signal, sys, time
from pathlib import Path
from railhil.scenarios.memory import next_record
from railhil.scenarios.memory_store import MemoryStore

store = MemoryStore(Path(sys.argv[1]))
random.seed(7)

def run(number):
    began = store.read("mylaw")
    before = began.newest
    learned = 0 if before is None else before.values["learned"]
    record = next_record("mylaw", "here", {"learned": learned + 1, "pad": "x" * 20_000}, before, number)
    if record is not None:
        used = began.stored[0].slot if began.stored else ""
        store.write(record, began, used, {})

took_s = 1.0
for number in range(1, 6):
    begun = time.perf_counter()
    run(number)
    took_s = min(took_s, time.perf_counter() - begun)
number, kills, ended = 6, 0, 0
# How long a child lives is found while it runs, so that on any machine about half of them come to their end.
span_s = 2 * took_s
while kills < 200 or number <= 20:
    child = os.fork()
    if child == 0:
        run(number)
        os._exit(0)
    time.sleep(random.uniform(0, span_s))
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    killed = os.WIFSIGNALED(status)
    kills += killed
    ended += not killed
    span_s *= 1.05 if killed else 0.95
    found = store.read("mylaw")
    assert not any(one.fault for one in found.stored), found
    newest = found.newest
    assert newest.values["learned"] == newest.runs == newest.last_run in (number - 1, number), (newest.runs, number)
    # A record that is stored was learned from, killed or not: the run counts as made, sometimes even twice.
    if newest.last_run == number and random.random() < 0.7:
        number += 1
print(kills, ended, number)
"""


@pytest.mark.long
@pytest.mark.slow
def test_killed_200_times_while_writing_there_is_always_a_slot_and_nothing_is_learned_twice(tmp_path: Path) -> None:
    store = tmp_path / "store"
    done = subprocess.run(
        [sys.executable, "-c", _KILLED, str(store)], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    kills, ended, number = map(int, done.stdout.split())
    assert kills >= 200
    assert ended
    # What is left of killed writes goes with the next one.
    found = MemoryStore(store).read("mylaw")
    newest = found.stored[0]
    assert newest.record is not None
    MemoryStore(store).write(record(number + 1), found, newest.slot, {})
    assert sorted(entry.name for entry in store.iterdir()) == ["a.json", "b.json"]
    assert json.loads((store / "a.json").read_text())["version"] == 1
