"""``SHA256SUMS``: the hashes of all files of a folder of evidence, which every reader compares with the files.

One line per file as ``sha256sum`` writes them, by name. A folder below with a list of its own is entered by that list,
so that the list of a campaign, a comparison or a sequence covers its run folders. It can be signed
(:mod:`railhil.record.signature`).

The document that marks a folder as complete names the list under :data:`HASH_LIST_KEY`, so that a deleted list is
noticed. Folders of earlier versions have none.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, NamedTuple

from railhil.common.errors import InputError, Words
from railhil.common.user_files import DRAFTS, refuse_unreadable, whole_file, write_synced
from railhil.record.documents import SCORE, SUMMARY
from railhil.record.framelog import sha256_of
from railhil.record.signature import HASH_LIST as HASH_LIST
from railhil.record.signature import SIGNATURE as SIGNATURE
from railhil.record.signature import check_signature

#: Documents that mark a folder as complete, of every kind of folder that has a list.
DOCUMENTS: Final = (
    "certificate.json",
    "compare.json",
    "campaign.json",
    "learn.json",
    "sequence.json",
    "faults.json",
    "hunt.json",
    "probability.json",
    "dossier.json",
)
#: The page of a folder.
REPORT: Final = "report.html"
#: Key of certificates and manifests: the name of the list.
HASH_LIST_KEY: Final = "hash_list"
_LINE = re.compile(r"([0-9a-f]{64})  ([^\n]+)\n")
#: How far above a folder the list is that has its list: ``again/LAW-SEED`` of a campaign.
_DEPTH_MAX = 2
_UNCHANGED = "a file that nobody changed"
_MISSING = "no such file"


class Changed(NamedTuple):
    """A file that is not as listed: its name, the hash found, and the hash in the list."""

    name: str
    found: str
    listed: str

    @property
    def is_missing(self) -> bool:
        """Whether there is no such file."""
        return self.found == _MISSING

    @property
    def sentence(self) -> str:
        """The line for a report of all such files."""
        return f"{self.name}: {self.found if self.is_missing else f'sha256 {self.found}'}, in {HASH_LIST} {self.listed}"

    def error(self, folder: Path) -> InputError:
        """As bad input."""
        found = Words(self.found) if self.is_missing else self.found
        return InputError(folder / self.name, "sha256", found, f"{self.listed} ({HASH_LIST} beside it): {_UNCHANGED}")


def listed_files(folder: Path) -> Iterator[str]:
    """Names of the files that a list of this folder covers."""
    for path in sorted(folder.iterdir()):
        if path.is_dir():
            below = (HASH_LIST,) if (path / HASH_LIST).is_file() else listed_files(path)
            yield from (f"{path.name}/{name}" for name in below)
        elif path.is_file() and path.name not in (HASH_LIST, SIGNATURE) and not path.match(DRAFTS):
            yield path.name


def write_hash_list(folder: Path, instead: Mapping[str, Path] | None = None, only: Iterable[str] | None = None) -> None:
    """Write the list of a folder; a signature of another list is removed.

    :param instead: files that come under these names when the list is written.
    :param only: the files of the list; None: all files.
    :raises OSError: a file cannot be read, or the list not be written.
    """
    instead = instead or {}
    names = {*(listed_files(folder) if only is None else only), *instead}
    write_hashes(folder, {name: sha256_of(instead.get(name, folder / name)) for name in names})


def check_free(option: str, out: Path, read: Sequence[Path] = ()) -> None:
    """Refuse to write over a file of a record, or over one that the same command reads. A page may be written again.

    :param option: that names the file. :param read: the files that the command reads.
    :raises InputError: it is such a file, or the list beside it is damaged.
    """
    if any(out.exists() and one.exists() and out.samefile(one) for one in read):
        raise InputError("command line", option, str(out), "another file than the one that is read")
    hashes = _list_of(out.parent) if out.is_file() else None
    if hashes and out.name in (HASH_LIST, SIGNATURE, *hashes) and not out.suffix.lower().startswith(".htm"):
        raise InputError("command line", option, str(out), f"no file that {HASH_LIST} beside it lists")


@contextmanager
def listed_file(path: Path) -> Iterator[Path]:
    """:func:`railhil.common.user_files.whole_file`, which also enters the file into the list of its folder if that has
    one, and that list into those of the folders above; a signed list stays as it is.

    :raises InputError: the file is in a signed list, or in a folder of one, or a list is damaged.
    :raises OSError: file or list cannot be written.
    """
    lists = list(_lists_of(path))
    for folder, name, hashes in lists:
        if name in hashes and (folder / SIGNATURE).is_file():
            raise InputError(path, "", Words(f"belongs to a signed folder ({SIGNATURE})"), "--out FILE elsewhere")
    with whole_file(path) as draft:
        yield draft
    for folder, name, hashes in lists:
        if not (folder / SIGNATURE).is_file():
            write_hashes(folder, hashes | {name: sha256_of(folder / name)})


def _lists_of(path: Path) -> Iterator[tuple[Path, str, dict[str, str]]]:
    """The lists that have a file or are to have it, the innermost first: folder, name there, hashes. Those above have
    the list below; one that does not say what is there is left as it is."""
    folder, name = path.absolute().parent, path.name
    hashes = _list_of(folder)
    while hashes is not None:
        yield folder, name, hashes
        below, hashes = folder, None
        for above in () if (below / SIGNATURE).is_file() else below.parents[:_DEPTH_MAX]:
            name = f"{below.relative_to(above).as_posix()}/{HASH_LIST}"
            found = _list_of(above) or {}
            if found.get(name) == sha256_of(below / HASH_LIST):
                folder, hashes = above, found
                break


def _list_of(folder: Path) -> dict[str, str] | None:
    """The list of a folder of evidence; None: there is none, or it is that of something else."""
    return read_hash_list(folder) if any((folder / name).is_file() for name in DOCUMENTS) else None


def enter(folder: Path, hashes: Mapping[str, str], name: str, content: bytes) -> dict[str, str]:
    """Write a list with a file of this content entered; returns it. Raises OSError."""
    entered = {**hashes, name: hashlib.sha256(content).hexdigest()}
    write_hashes(folder, entered)
    return entered


def write_hashes(folder: Path, hashes: Mapping[str, str]) -> None:
    """Write a list with these hashes by name; a signature of another list is removed. Raises OSError."""
    content = "".join(f"{sha256}  {name}\n" for name, sha256 in sorted(hashes.items())).encode()
    path = folder / HASH_LIST
    if not path.is_file() or path.read_bytes() != content:
        (folder / SIGNATURE).unlink(missing_ok=True)
        write_synced(path, content)


def read_hash_list(folder: Path) -> dict[str, str] | None:
    """Hashes by name; None if the folder has no list.

    :raises InputError: it is damaged.
    """
    path = folder / HASH_LIST
    expected = "lines as sha256sum writes them"
    with refuse_unreadable(path, expected):
        if not path.exists():
            return None
        text = path.read_text(encoding="utf-8")
    found: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        match = _LINE.fullmatch(line)
        if match is None or match[2] in found or not _is_below(match[2]):
            raise InputError(path, f"line {number}", line.rstrip("\n"), "SHA-256, two spaces, a file of the folder")
        found[match[2]] = match[1]
    if not found:
        raise InputError(path, "", Words("is empty"), expected)
    return found


def _is_below(name: str) -> bool:
    path = Path(name)
    return not path.is_absolute() and ".." not in path.parts


def changed_files(folder: Path, hashes: Mapping[str, str]) -> Iterator[Changed]:
    """The files that are not as listed, and the missing ones.

    :raises InputError: a file cannot be read.
    """
    for name, listed in hashes.items():
        path = folder / name
        with refuse_unreadable(path, "a readable file"):
            found = sha256_of(path) if path.is_file() else _MISSING
        if found != listed:
            yield Changed(name, found, listed)


def check_document(folder: Path, name: str, document: Mapping[str, Any] | None) -> dict[str, str]:
    """Refuse a folder whose complete document has changed since its list was written, or whose signature belongs to
    another list.

    :param name: of the document that marks the folder as complete; ``document``: its content, None if the folder has
        none.
    :returns: the list; empty if the folder never had one.
    :raises InputError: the document is not as listed or gone, the list is gone, or the signature is of another one.
    """
    hashes = read_hash_list(folder)
    if hashes is not None:
        check_signature(folder)
    elif (folder / SIGNATURE).is_file():
        raise InputError(folder / HASH_LIST, "", Words("does not exist"), f"the list that {SIGNATURE} beside it is of")
    if hashes is None or name not in hashes:
        if document is not None and (hashes is not None or document.get(HASH_LIST_KEY)):
            found = Words("does not exist" if hashes is None else f"has no line of {name}")
            raise InputError(folder / HASH_LIST, "", found, f"the list of the folder's files, with {name}")
        return {}
    for changed in changed_files(folder, {name: hashes[name]}):
        raise changed.error(folder)
    return hashes


def check_hash_list(folder: Path, name: str, document: Mapping[str, Any] | None) -> None:
    """As :func:`check_document`, for every file of the folder, and of those below that have lists of their own.

    :raises InputError: as :func:`check_document`, a result that is not in the list, and the first file that is not as
        listed or missing.
    """
    hashes = check_document(folder, name, document)
    for result in (SCORE, SUMMARY):
        if hashes and result not in hashes and (folder / result).is_file():
            # Without its line an edit would not be noticed.
            raise InputError(folder / HASH_LIST, "", Words(f"has no line of {result}"), "the hash of each result")
    _check_files(folder, hashes)


def _check_files(folder: Path, hashes: Mapping[str, str]) -> None:
    for changed in changed_files(folder, hashes):
        # A deleted page is no fault: it is made again from the other files.
        if not (changed.is_missing and changed.name == REPORT):
            raise changed.error(folder)
    for below in (folder / name for name in hashes if name.endswith(f"/{HASH_LIST}")):
        _check_files(below.parent, read_hash_list(below.parent) or {})
