"""Checking a DBC file that a user brings against the wire contract."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cantools

from scenarios.errors import InputError


def _load(path: Path) -> Any:
    if not path.is_file():
        raise InputError(path, "file", "no such file", "a DBC file")
    try:
        return cantools.database.load_file(path, database_format="dbc")
    except (cantools.database.errors.Error, UnicodeDecodeError, ValueError) as error:
        raise InputError(path, "file", " ".join(str(error).split()), "a DBC file") from error


def _layout(message: Any) -> list[tuple[Any, ...]]:
    return sorted(
        (signal.name, signal.start, signal.length, signal.byte_order, signal.is_signed, signal.scale, signal.offset)
        for signal in message.signals
    )


def check_foreign_dbc(file: str) -> None:
    """Compare a DBC file with the wire contract, message by message.

    :raises InputError: first difference, one line.
    """
    path = Path(file)
    theirs = {message.frame_id: message for message in _load(path).messages}
    ours = _load(Path(__file__).resolve().parents[2] / "dbc" / "railhil.dbc")
    for message in ours.messages:
        other = theirs.get(message.frame_id)
        key = f"message {message.name} ({message.frame_id:#05x})"
        if other is None:
            raise InputError(path, key, "no such message", "the telegrams of `railhil ports`")
        if other.length != message.length:
            raise InputError(path, f"{key} length", other.length, str(message.length))
        if _layout(other) != _layout(message):
            differing = [row for row in _layout(other) if row not in _layout(message)] or [("missing signals",)]
            raise InputError(path, f"{key} signals", str(differing[0]), "the layout of `railhil ports`")
