"""Files that users name: read only if they are regular and of a bounded size, written completely or not at all.

Opening a named pipe would wait for its writer, and a device has no end. A failed attempt to write leaves the old file
intact.
"""

from __future__ import annotations

import errno
import fcntl
import json
import os
import stat
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Sentence, Words, describe_os_error, near_file, short_repr

#: Errors of the operating system when the disk is full.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
#: Largest file with settings, tables or results; the largest that railhil writes itself have some MB.
BYTES_MAX = 64_000_000
_ALLOWED = "a regular file"


def open_given(path: Path, bytes_max: int = BYTES_MAX) -> BufferedReader:
    """The file, open for reading.

    :raises InputError: it is no regular file, or it is larger.
    :raises OSError: it cannot be opened.
    """
    stream = open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb")  # noqa: SIM115
    try:
        found = os.fstat(stream.fileno())
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(found.st_mode):
            kind = "is a pipe" if stat.S_ISFIFO(found.st_mode) else "is a device or socket"
            raise InputError(path, "", Words(kind), _ALLOWED)
        if found.st_size > bytes_max:
            raise InputError(path, "", Words(f"has {found.st_size} bytes"), f"at most {bytes_max} bytes")
    except BaseException:
        stream.close()
        raise
    return stream


def given_bytes(path: Path, bytes_max: int = BYTES_MAX) -> bytes:
    """Content of the file, as :func:`open_given`."""
    with open_given(path, bytes_max) as stream:
        return stream.read(bytes_max)


def given_text(path: Path, encoding: str = "utf-8", errors: str = "strict") -> str:
    """Text of the file, as :func:`open_given`, with line ends as ``\\n``.

    :raises UnicodeDecodeError: it is no text.
    """
    text = given_bytes(path).decode(encoding, errors)
    return text.replace("\r\n", "\n").replace("\r", "\n")


@contextmanager
def refuse_unreadable(path: Path, expected: str) -> Iterator[None]:
    """Reading and parsing a user's file, inside ``with``.

    :param expected: the kind of file that belongs there.
    :raises InputError: the block could not read the file (the cause is the OSError), or its text is not UTF-8 or not
        in the format of the parser (ValueError).
    """
    try:
        yield
    except OSError as error:
        hint = None
        if isinstance(error, FileNotFoundError):
            words, hint = "does not exist", near_file(path)
        elif isinstance(error, IsADirectoryError):
            words = "is a directory"
        else:
            words = f"cannot be read: {describe_os_error(error)}"
        raise InputError(path, "", Words(words), expected, hint) from error
    except UnicodeDecodeError as error:
        raise InputError(path, "", Words(f"is not UTF-8 text (byte {error.start})"), expected) from None
    except (ValueError, RecursionError) as error:
        raise InputError(path, "", Words("cannot be read"), expected, str(error)) from None


def given_json(path: Path, expected: str) -> dict[str, Any]:
    """The JSON object in a file, as :func:`open_given`.

    :param expected: what should be there.
    :raises InputError: the file cannot be read (its cause is the OSError), or has something else.
    """
    with refuse_unreadable(path, expected):
        content = given_bytes(path)
    return json_object(path, content, expected)


def json_object(path: Path, content: bytes, expected: str) -> dict[str, Any]:
    """The JSON object that a file contains; arguments and errors as :func:`given_json`."""
    with refuse_unreadable(path, expected):
        document = parse_json(content.decode("utf-8"))
    if not isinstance(document, dict):
        raise InputError(path, "", Words("has no JSON object"), expected)
    return document


def without_mark(text: str) -> str:
    """The text, which has no byte order mark.

    :raises ValueError: it begins with one.
    """
    if text.startswith("\N{BYTE ORDER MARK}"):
        raise ValueError("it begins with a byte order mark (BOM): save it as UTF-8 without one")
    return text


def parse_json(text: str) -> Any:
    """The document of a JSON text of a user.

    :raises ValueError: it is not JSON, begins with a byte order mark, or an object has the same key twice.
    """
    return json.loads(without_mark(text), object_pairs_hook=_object)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object, none of whose keys hides another one. Raises ValueError."""
    found = dict(pairs)
    if len(found) < len(pairs):
        times = Counter(key for key, _ in pairs)
        raise ValueError(f"the key {short_repr(times.most_common(1)[0][0])} stands there twice")
    return found


class RecordFailed(Exception):
    """Results cannot be written (disk full); the frames already in the log are kept."""

    exit_code = 4


def not_written(key: str, path: Path, kind: str, error: OSError) -> InputError | RecordFailed:
    """The error for a user's file or folder that cannot be written: bad input, unless the disk is full.

    :param key: option that named it.
    :param kind: ``file`` or ``folder``.
    """
    reason = describe_os_error(error)
    if error.errno in NO_ROOM:
        return RecordFailed(f"{path} cannot be written: {reason}")
    return InputError("command line", key, str(path), Sentence(f"the {kind} {path} cannot be written: {reason}"))


@contextmanager
def refuse_unwritable(key: str, path: Path, kind: str) -> Iterator[None]:
    """Writing a user's file or folder, inside ``with``; arguments and errors as :func:`not_written`."""
    try:
        yield
    except OSError as error:
        raise not_written(key, path, kind, error) from None


_NEW_FILE_MODE = 0o666
#: Interval between attempts to get a lock.
_LOCK_LOOK_S = 0.01
_DRAFT = ".part-"
#: Names of files that are being written.
DRAFTS = f"{_DRAFT}*"


def _mode(path: Path) -> int | None:
    """Mode of the file that a path leads to, None when there is none.

    :raises OSError: it cannot be determined (a loop of links, a file instead of a folder).
    """
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return None


def _new_file_mode() -> int:
    """Permissions of a new file. The mask can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return _NEW_FILE_MODE & ~mask


def check_writable(path: Path) -> None:
    """Check that :func:`whole_file` will succeed, before the work that fills the file; leaves nothing behind.

    :raises OSError: the file cannot be written.
    """
    mode = _mode(path)
    if mode is not None:
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    if mode is None or stat.S_ISREG(mode):
        # Checking permissions would not detect a read-only file system.
        tempfile.TemporaryFile(dir=path.resolve().parent).close()


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Path to write to, inside ``with``, so that the file appears complete when the block ends, or not at all.

    The path is a temporary file in the same folder, with the same suffix. It replaces the target of a link, not the
    link, and takes the permissions of the file it replaces. An existing file that is not a regular one (a device, a
    pipe) is written directly.

    :raises OSError: the file cannot be written. Exceptions of the block are passed on; the temporary file is removed.
    """
    mode = _mode(path)
    if mode is not None and not stat.S_ISREG(mode):
        yield path
        return
    target = path.resolve()
    handle, name = tempfile.mkstemp(prefix=_DRAFT, suffix=target.suffix, dir=target.parent)
    os.close(handle)
    draft = Path(name)
    try:
        yield draft
        draft.chmod(_new_file_mode() if mode is None else stat.S_IMODE(mode))
        draft.replace(target)
    finally:
        draft.unlink(missing_ok=True)


def write_synced(path: Path, content: bytes) -> None:
    """Write a file completely or not at all, so that it survives a power cut: temporary file, fsync, rename.

    :raises OSError: it cannot be written; the previous file is kept.
    """
    with whole_file(path) as draft, draft.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    sync_folder(path.resolve().parent)


def lock_within(descriptor: int, wait_s: float, mode: int = fcntl.LOCK_EX) -> bool:
    """Lock an open file or folder for this process; False if another process holds the lock for this time.

    The lock ends with the process or the descriptor.

    :param mode: ``LOCK_EX``: alone; ``LOCK_SH``: beside others of this mode.
    :raises OSError: it cannot be locked at all.
    """
    deadline_s = time.monotonic() + wait_s
    while True:
        try:
            fcntl.flock(descriptor, mode | fcntl.LOCK_NB)
        except OSError as error:
            # Some file systems say so of a lock that is held.
            if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                raise
            if time.monotonic() > deadline_s:
                return False
            time.sleep(_LOCK_LOOK_S)
        else:
            return True


@contextmanager
def hold_alone(place: Path) -> Iterator[None]:
    """Inside ``with``, other processes that ask for the same place wait. Nothing is left behind.

    :param place: file or folder that stands for what is made.
    :raises OSError: it cannot be opened, or locked at all.
    """
    descriptor = os.open(place, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def sync_folder(path: Path) -> None:
    """Make the names in a folder survive a power cut. Raises OSError."""
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
