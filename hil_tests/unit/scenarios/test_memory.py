"""Records of a law's memory: read whole or refused in one line, written whole or not at all."""

from __future__ import annotations

import json
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.paths import ROOT
from railhil.common.errors import InputError
from railhil.scenarios.memory import (
    FAULTS,
    BadRecord,
    Memory,
    MemoryPlace,
    MemoryRecord,
    load_memory,
    memory_from_json,
    next_record,
    no_memory,
    read_record,
    write_memory,
)

GOLDEN = ROOT / "hil_tests" / "data" / "memory" / "golden.json"
SOME = MemoryRecord("mylaw", "dalian_12 up", 3, 3, {"offset_m": -0.12})


def in_slots(path: Path) -> Memory:
    older = replace(SOME, runs=2, last_run=2)
    return Memory(
        "mylaw",
        (MemoryPlace("A", SOME), MemoryPlace("B", None, "crc", "found other"), MemoryPlace("default", older)),
        path,
    )


def test_the_golden_file() -> None:
    """Its CRC was computed from the text below by zlib alone."""
    text = b'{"key":"dalian_12 up","last_run":3,"law":"mylaw","runs":3,"values":{"offset_m":-0.12},"version":1}'
    assert f"{zlib.crc32(text):08x}" == json.loads(GOLDEN.read_text())["crc32"] == "ccfa25ef"
    assert read_record(GOLDEN) == SOME
    assert GOLDEN.read_text() == SOME.text


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    path.write_text(SOME.text)
    assert load_memory(path) == Memory("mylaw", (MemoryPlace("file", SOME),), path)
    for memory in (in_slots(path), no_memory("mylaw", path)):
        write_memory(memory, path)
        assert load_memory(path) == memory
        assert memory_from_json(memory.as_json(), path).sha256 == memory.sha256
        (tmp_path / "certificate.json").write_text(json.dumps({"scenario": "x", "memory": memory.as_json()}))
        assert load_memory(tmp_path / "certificate.json").stored == memory.stored
    assert {entry.name for entry in tmp_path.iterdir()} == {"memory.json", "certificate.json"}


def test_layout_of_the_file_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    path.write_text(json.dumps(SOME.document))
    assert read_record(path) == SOME


@pytest.mark.parametrize(
    ("changes", "fault", "line"),
    [
        ({"values": {"offset_m": 0.12}}, "crc", "crc32: found 'ccfa25ef', allowed [0-9a-f]{8}: values that nobody"),
        ({"crc32": "00000000"}, "crc", "crc32: found '00000000', allowed ccfa25ef"),
        ({"key": "dalian_12 down"}, "crc", "crc32: found"),
        ({"runs": 4}, "crc", "crc32: found"),
        ({"more": 1}, "crc", "crc32: found"),
        ({"values": {"offset_m": float("nan")}}, "not_finite", "values: a number that is not finite, expected"),
        ({"crc32": None}, "fields", "crc32: missing"),
    ],
)
def test_a_damaged_record_is_one_line_and_stays_as_it_is(
    changes: dict[str, Any], fault: str, line: str, tmp_path: Path
) -> None:
    path = tmp_path / "memory.json"
    changed = SOME.document | changes
    path.write_text(json.dumps({key: value for key, value in changed.items() if value is not None}))
    before = path.read_bytes()
    with pytest.raises(InputError, match=rf"memory\.json: {line}") as refused:
        load_memory(path)
    assert len(str(refused.value).splitlines()) == 1
    with pytest.raises(BadRecord) as bad:
        read_record(path)
    assert bad.value.fault == fault
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("changes", "fault", "line"),
    [
        ({"version": 2}, "version", "version: found 2, allowed 1"),
        ({"runs": 0}, "fields", "runs: found 0, allowed at least 1"),
        ({"last_run": -1}, "fields", "last_run: found -1, allowed at least 0"),
        ({"law": ""}, "fields", "law: found ''"),
        ({"values": [1]}, "fields", "values: found .*allowed a table"),
        ({"more": 1}, "fields", "more: unknown key"),
    ],
)
def test_a_record_of_something_else_with_a_good_crc(
    changes: dict[str, Any], fault: str, line: str, tmp_path: Path
) -> None:
    path = tmp_path / "memory.json"
    content = {key: value for key, value in SOME.document.items() if key != "crc32"} | changes
    text = json.dumps(content, sort_keys=True, separators=(",", ":")).encode()
    path.write_text(json.dumps(content | {"crc32": f"{zlib.crc32(text):08x}"}))
    with pytest.raises(BadRecord, match=rf"memory\.json: {line}") as bad:
        read_record(path)
    assert bad.value.fault == fault


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"[]", b"{", b"[" * 200_000], ids=lambda text: repr(text[:4]))
def test_what_is_no_memory_is_one_line(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"memory\.json: .*, expected a memory that railhil has written"):
        load_memory(path)
    with pytest.raises(InputError, match=r"memry\.json: does not exist.*did you mean .*memory\.json"):
        load_memory(tmp_path / "memry.json")


def test_a_file_that_no_memory_fills_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "memory.json"
    path.write_bytes(b" " * 1_000_001)
    with pytest.raises(InputError, match="has 1000001 bytes, expected at most 1000000"):
        load_memory(path)


def test_a_changed_memory_of_a_run_is_one_line(tmp_path: Path) -> None:
    for change in ({"slot": "B"}, {"record": SOME.document | {"runs": 9}}, {"fault": "crc"}, {"record": None}):
        document = in_slots(tmp_path).as_json()
        document["stored"][0] |= change
        with pytest.raises(InputError, match=r"crc32: found|memory\.sha256: found|with a record and a fault, or neith"):
            memory_from_json(document, tmp_path)


def test_a_run_is_learned_once() -> None:
    first = next_record("mylaw", "here", {"x": 1}, None, 5)
    assert first == MemoryRecord("mylaw", "here", 1, 5, {"x": 1})
    assert next_record("mylaw", "here", {"x": 2}, first, 6) == MemoryRecord("mylaw", "here", 2, 6, {"x": 2})
    assert next_record("mylaw", "here", {"x": 2}, first, 5) is None
    assert next_record("mylaw", "here", {"x": 2}, first, 4) is None


def test_faults_fit_into_four_bits() -> None:
    assert sorted(FAULTS.values()) == [*range(1, 9)]
