"""Checks a user's DBC file against the wire contract."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.common.given_file import given_text
from railhil.dbc import Contract
from railhil.dbc.text import dbc_text


def _load(path: Path) -> Any:
    # Imported here, because no other command needs it, and it takes a sixth of a second.
    import cantools

    try:
        text = given_text(path, "cp1252", "replace")
    except OSError as error:
        raise InputError(path, "file", Words((error.strerror or str(error)).lower()), "a readable DBC file") from None
    try:
        return cantools.database.load_string(text, database_format="dbc")
    except Exception as error:
        # The file may contain anything; whatever the parser raises, it is not a usable DBC.
        reason = " ".join(str(error).split()).removeprefix('DBC: "').removesuffix('"') or type(error).__name__
        raise InputError(path, "file", Words("no DBC that can be read"), "a DBC file", reason[:200]) from None


def _layout(message: Any) -> dict[str, dict[str, Any]]:
    return {
        signal.name: {
            "start bit": signal.start,
            "length": signal.length,
            "byte order": signal.byte_order,
            "signed": signal.is_signed,
            "scale": signal.scale,
            "offset": signal.offset,
            "unit": signal.unit or "",
        }
        for signal in message.signals
    }


def check_foreign_dbc(file: str, contract: Contract) -> None:
    """Compare a DBC file with a wire contract, message by message; additional messages are allowed.

    :raises InputError: first difference, one line.
    """
    path = Path(file)
    theirs = {(message.frame_id, message.is_extended_frame): message for message in _load(path).messages}
    import cantools

    ours: Any = cantools.database.load_string(dbc_text(contract), database_format="dbc")
    for message in ours.messages:
        other = theirs.get((message.frame_id, message.is_extended_frame))
        key = f"message {message.name} ({message.frame_id:#05x})"
        if other is None:
            raise InputError(path, key, Words("no such message"), "the telegrams of `railhil ports`")
        if other.length != message.length:
            raise InputError(path, f"{key}: length", other.length, f"{message.length} bytes")
        wanted, found = _layout(message), _layout(other)
        for name in sorted(wanted.keys() | found.keys()):
            if name not in found or name not in wanted:
                present = Words("no such signal" if name in wanted else "a signal more")
                raise InputError(path, f"{key}: signal {name}", present, "the layout of `railhil ports`")
            for item, value in wanted[name].items():
                if found[name][item] != value:
                    raise InputError(path, f"{key}: signal {name}: {item}", found[name][item], repr(value))
