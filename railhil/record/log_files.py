"""Files of logs: the format by the suffix of the name, in small or capital letters, and files packed by gzip."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, Final, cast

from railhil.common.errors import InputError, Words
from railhil.common.user_files import refuse_unreadable

BLF_SUFFIX: Final = ".blf"
ASC_SUFFIX: Final = ".asc"
_GZIP: Final = ".gz"


def log_suffix(path: Path) -> str:
    """The suffix that tells the format, in small letters; ``frames.LOG.gz``: ``.log``."""
    return Path(path.stem if _is_packed(path) else path.name).suffix.lower()


def is_candump(path: Path) -> bool:
    """Whether a file is read as a candump log: every file that has no suffix of another format."""
    return log_suffix(path) not in (BLF_SUFFIX, ASC_SUFFIX)


def _is_packed(path: Path) -> bool:
    return path.suffix.lower() == _GZIP


@contextmanager
def opened_log(path: Path, allowed: str) -> Iterator[BinaryIO]:
    """Content of a log, unpacked, inside ``with``.

    :param allowed: the kind of file that belongs there.
    :raises InputError: it cannot be read, or the block finds that it cannot be unpacked.
    """
    with refuse_unreadable(path, allowed):
        stream = _unpacked(path) if _is_packed(path) else path.open("rb")
    with stream:
        try:
            yield stream
        except (OSError, EOFError, zlib.error) as error:
            found = Words("cannot be unpacked" if _is_packed(path) else "cannot be read")
            raise InputError(path, "", found, f"{allowed}, whole", str(error)) from None


def _unpacked(path: Path) -> BinaryIO:
    # A log of a run is seldom packed.
    import gzip

    return cast(BinaryIO, gzip.open(path))
