"""The file with a law's memory: read whole or refused in one line, written whole or not at all."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from railhil.common.errors import InputError
from railhil.scenarios.memory import Memory, crc32, load_memory, memory_from_json, no_memory, write_memory

_VALUES = {"offset_m": -0.12}
#: The example in the head of the module.
_CRC32 = "828a393a"


def some(path: Path, runs: int = 3) -> Memory:
    return Memory("mylaw", "dalian_12 up", runs, _VALUES, path)


def damaged(path: Path, **changes: Any) -> None:
    """A memory with other content under its old CRC."""
    path.write_text(json.dumps(json.loads(some(path).text) | changes))


def test_the_crc_is_that_of_the_canonical_json(tmp_path: Path) -> None:
    text = '{"key":"dalian_12 up","law":"mylaw","runs":3,"values":{"offset_m":-0.12},"version":1}'
    assert crc32(json.loads(text)) == _CRC32
    assert json.loads(some(tmp_path).text)["crc32"] == _CRC32


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    for memory in (some(path), no_memory("mylaw", path), some(path).after("other", {"é": [1, 2.5, "a"]}, path)):
        write_memory(memory, path)
        assert load_memory(path) == memory
        assert load_memory(path).sha256 == memory.sha256
        assert memory_from_json(memory.as_json(), path) == memory
    assert [entry.name for entry in tmp_path.iterdir()] == ["memory.json"]


def test_layout_of_the_file_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    path.write_text(json.dumps(json.loads(some(path).text)))
    assert load_memory(path) == some(path)


def test_it_is_also_read_from_a_certificate(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps({"scenario": "x", "memory": some(path).as_json()}))
    assert load_memory(path) == some(path)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"values": {"offset_m": 0.12}}, f"crc32: found '{_CRC32}', allowed [0-9a-f]{{8}}: values that nobody changed"),
        ({"crc32": "00000000"}, f"crc32: found '00000000', allowed {_CRC32}"),
        ({"key": "dalian_12 down"}, "crc32: found"),
        ({"runs": 4}, "crc32: found"),
        ({"runs": -1}, "runs: found -1, allowed at least 0"),
        ({"version": 2}, "version: found 2, allowed 1"),
        ({"law": ""}, "law: found ''"),
        ({"more": 1}, "more: found the unknown key more"),
        ({"values": {"offset_m": float("nan")}}, "values: found a number that is not finite, allowed finite numbers"),
        ({"values": [1]}, "values: found .*allowed a table"),
    ],
)
def test_a_damaged_file_is_one_line_and_stays_as_it_is(changes: dict[str, Any], line: str, tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    damaged(path, **changes)
    before = path.read_bytes()
    with pytest.raises(InputError, match=rf"memory\.json: {line}") as refused:
        load_memory(path)
    assert len(str(refused.value).splitlines()) == 1
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    "content", [b"", b"\xff\xfe", b"[]", b"{", b"[" * 200_000, b" " * 1_000_001], ids=lambda text: repr(text[:4])
)
def test_what_is_no_memory_is_one_line(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"memory\.json: found no JSON .*allowed a memory that railhil has written"):
        load_memory(path)
    with pytest.raises(InputError, match=r"No such file or directory.*did you mean .*memory\.json"):
        load_memory(tmp_path / "memry.json")


_KILLED = """
import os, signal, sys
from pathlib import Path
from railhil.scenarios.memory import load_memory, write_memory
path = Path(sys.argv[1])
memory = load_memory(path)
setattr(os, sys.argv[2], lambda *given: os.kill(os.getpid(), signal.SIGKILL))
write_memory(memory.after("other", {"x": "y" * 100_000}, path), path)
"""


@pytest.mark.parametrize("at", ["fsync", "replace"])
def test_a_kill_in_the_middle_of_writing_leaves_the_old_memory(at: str, tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    write_memory(some(path), path)
    done = subprocess.run([sys.executable, "-c", _KILLED, str(path), at], check=False, timeout=60)
    assert done.returncode == -signal.SIGKILL
    assert load_memory(path) == some(path)
    write_memory(some(path, 4), path)
    assert load_memory(path).runs == 4


def test_a_full_disk_leaves_the_old_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "memory.json"
    write_memory(some(path), path)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_memory(some(path, 4), path)
    assert load_memory(path) == some(path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["memory.json"]
