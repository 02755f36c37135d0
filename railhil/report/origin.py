"""Where the runs of a page come from: when, where and by whom they were recorded, and the files of their folders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from railhil.judge.record import Record
from railhil.record.documents import CERTIFICATE
from railhil.record.hash_list import HASH_LIST, REPORT, listed_files
from railhil.report.templates import Link, address_of


def recorded_sentence(documents: Sequence[Mapping[str, Any]]) -> str:
    """When, where, by whom and with which version runs were recorded, as far as their certificates, or the table of
    the runs, say it."""
    known = [one for document in documents if (one := document.get("recorded"))]
    instants = sorted(one["utc"][:16].replace("T", " ") for one in known)
    said = " to ".join(f"{one} UTC" for one in dict.fromkeys(instants[:1] + instants[-1:]))
    for word, key in (("on", "host"), ("by", "operator")):
        names = dict.fromkeys(one[key] for one in known if one[key])
        said += f" {word} {', '.join(names)}" if names else ""
    versions = dict.fromkeys(str(document["railhil"]) for document in documents if "railhil" in document)
    said += f" with railhil {', '.join(versions)}" if versions else ""
    return f"Recorded {said.strip()}." if said else ""


def folder_files(run: Record, out: Path) -> list[Link]:
    """The files of a run folder without its report; of a log elsewhere the log alone."""
    if not (run.folder / CERTIFICATE).is_file():
        return [Link(run.log.name, address_of(run.log, out))] if run.log.is_file() else []
    names = [name for name in listed_files(run.folder) if "/" not in name and name != REPORT]
    # Folders of version 0.1.0 have no list.
    names += [HASH_LIST] if (run.folder / HASH_LIST).is_file() else []
    return [Link(name, address_of(run.folder / name, out)) for name in names]
