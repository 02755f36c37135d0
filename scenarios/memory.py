"""A law's memory from run to run: a JSON file with version, law, key and CRC, and values interpreted only by the law.

::

    {"version": 1, "law": "mylaw", "key": "dalian_12 up", "runs": 3, "values": {"offset_m": -0.12},
     "crc32": "828a393a"}

``key`` is chosen by the law and says where the values apply (train, platform, load class, ...); ``runs`` is the number
of runs from which they were obtained. The CRC-32 (that of zlib) covers everything except itself as canonical JSON: keys
sorted, no blanks, ASCII. A memory before the first run has neither key nor values.
"""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from railhil.common import whole_file as wholefile
from railhil.common.errors import InputError, Words, near_file
from railhil.scenarios.validation import validated

VERSION = 1
#: Names in a run folder: the memory with which the run began, and the one that the law wants to keep.
MEMORY_BEFORE, MEMORY_AFTER = "memory_before.json", "memory.json"
#: Number of hash digits that identify a memory in names and in the handshake.
_DIGEST_DIGITS = 8
_BYTES_MAX = 1_000_000
_ALLOWED = "a memory that railhil has written"


class _Content(BaseModel):
    model_config = ConfigDict(defer_build=True, extra="forbid", strict=True, allow_inf_nan=False)
    version: Literal[1]
    law: str = Field(min_length=1)
    key: str
    runs: int = Field(ge=0)
    values: dict[str, Any]


class _File(_Content):
    crc32: str


class _Certified(_Content):
    """:meth:`Memory.as_json`."""

    sha256: str


@dataclass(frozen=True)
class Memory:
    """What a law keeps; see the top of this module.

    :param source: the file that it was read from, or whose name is used for it.
    """

    law: str
    key: str
    runs: int
    values: Mapping[str, Any]
    source: Path

    @property
    def _content(self) -> dict[str, Any]:
        return {"version": VERSION, "law": self.law, "key": self.key, "runs": self.runs, "values": dict(self.values)}

    @property
    def text(self) -> str:
        """Content of the file, always the same for the same memory."""
        content = self._content
        return json.dumps(content | {"crc32": crc32(content)}, indent=2, sort_keys=True, allow_nan=False) + "\n"

    @property
    def sha256(self) -> str:
        """Hash of :attr:`text`, and therefore of the file in a run folder."""
        return hashlib.sha256(self.text.encode("ascii")).hexdigest()

    @property
    def digest(self) -> str:
        """First digits of the hash."""
        return self.sha256[:_DIGEST_DIGITS]

    def as_json(self) -> dict[str, Any]:
        """The memory in a certificate: enough to begin the run again."""
        return self._content | {"sha256": self.sha256}

    def after(self, key: str, values: Mapping[str, Any], source: Path) -> Memory:
        """The memory after one more run."""
        return replace(self, key=key, runs=self.runs + 1, values=values, source=source)


def crc32(content: Mapping[str, Any]) -> str:
    """CRC-32 of the canonical JSON of a memory without its CRC, eight hexadecimal digits."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return f"{zlib.crc32(text.encode('ascii')):08x}"


def no_memory(law: str, source: Path) -> Memory:
    """The memory of a law that has not run yet."""
    return Memory(law, "", 0, {}, source)


def load_memory(path: Path) -> Memory:
    """Read a memory file, or the initial memory from a run's ``certificate.json``.

    :raises InputError: it cannot be read or is damaged: one line, and the file is left unchanged.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(_BYTES_MAX + 1)
        document = json.loads(data.decode("utf-8")) if len(data) <= _BYTES_MAX else None
    except OSError as error:
        raise InputError(path, "", Words(error.strerror or str(error)), _ALLOWED, near_file(path)) from None
    except (ValueError, RecursionError) as error:
        raise InputError(path, "", Words(f"no JSON document ({error})"), _ALLOWED) from None
    if not isinstance(document, dict):
        raise InputError(path, "", Words("no JSON object, or a larger one than 1 MB"), _ALLOWED)
    if "crc32" not in document and isinstance(document.get("memory"), dict):
        return memory_from_json(document["memory"], path)
    file = validated(_File, document, lambda keys: path)
    found = Memory(file.law, file.key, file.runs, file.values, path)
    wanted = _checked(found, lambda: crc32(found._content))
    if file.crc32 != wanted:
        raise InputError(path, "crc32", file.crc32, f"{wanted}: values that nobody changed")
    return found


def memory_from_json(document: Mapping[str, Any], source: Path) -> Memory:
    """The memory of a document made by :meth:`Memory.as_json`.

    :param source: the file that contains the document.
    :raises InputError: it is not a memory, or its values do not match its hash.
    """
    file = validated(_Certified, dict(document), lambda keys: source)
    found = Memory(file.law, file.key, file.runs, file.values, source)
    wanted = _checked(found, lambda: found.sha256)
    if file.sha256 != wanted:
        raise InputError(source, "memory.sha256", file.sha256, f"{wanted}: values that nobody changed")
    return found


def _checked(memory: Memory, hashed: Any) -> str:
    try:
        return str(hashed())
    except ValueError:
        # NaN and infinity are not JSON, though Python reads them.
        raise InputError(memory.source, "values", Words("a number that is not finite"), "finite numbers") from None


def write_memory(memory: Memory, path: Path) -> None:
    """Write the file completely or not at all, even if interrupted: temporary file, fsync, rename.

    :raises OSError: it cannot be written; the previous file is kept.
    """
    with wholefile.whole_file(path) as draft, draft.open("w", encoding="ascii") as stream:
        stream.write(memory.text)
        stream.flush()
        os.fsync(stream.fileno())
    folder = os.open(path.resolve().parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def runs_said(runs: int) -> str:
    """``3 runs``."""
    return "1 run" if runs == 1 else f"{runs} runs"
