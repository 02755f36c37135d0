"""An FMU as the plant of a run, as named on the command line."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, OptionError
from railhil.common.user_files import open_given, refuse_unreadable

OPTION, MAP_OPTION = "--plant-fmu", "--fmu-map"
#: Largest archive of an FMU.
FMU_BYTES_MAX = 500_000_000
#: Key of the certificate.
KEY = "plant_fmu"


@dataclass(frozen=True, slots=True)
class PlantFmu:
    """The file of the FMU, and the file with the names of its variables (TOML).

    An FMU is native code. It is named on the command line only: no scenario, file of a run or certificate can make a
    command load one.

    ``same_twice``: whether two equal runs gave the same; None: not checked, or unknown for the reason ``why``.
    """

    file: str
    map: str
    same_twice: bool | None = field(default=None, compare=False)
    why: str = field(default="", compare=False)

    @property
    def words(self) -> list[str]:
        """As words of a command line."""
        return [OPTION, self.file, MAP_OPTION, self.map]

    def as_json(self) -> dict[str, Any]:
        """For the certificate: both files with their hashes, and whether the FMU is deterministic.

        :raises InputError: one of them cannot be read.
        """
        return {
            "file": self.file,
            "sha256": _sha256(self.file),
            "map": self.map,
            "map_sha256": _sha256(self.map),
            "deterministic": self.same_twice,
            **({"deterministic_why": self.why} if self.why else {}),
        }


def check_recorded_fmu(document: Mapping[str, Any], file: str | Path, given: PlantFmu | None = None) -> PlantFmu | None:
    """The FMU with which the run of a document is made again, named by the command line.

    :param given: on the command line.
    :raises InputError: the document names one and the command line does not, or the other way round, or they are not
        the same files.
    """
    recorded = document.get(KEY)
    if not recorded:
        if given is not None:
            raise OptionError(OPTION, f"cannot be given: the run of {file} had no FMU")
        return None
    found = str(recorded.get("file", "an FMU") if isinstance(recorded, Mapping) else recorded)
    if given is None:
        allowed = f"{OPTION} on the command line: an FMU is native code, which no file can load"
        raise InputError(file, KEY, found, allowed)
    now = given.as_json()
    for key in ("sha256", "map_sha256"):
        if isinstance(recorded, Mapping) and recorded.get(key) not in (None, now[key]):
            name = now["file" if key == "sha256" else "map"]
            raise InputError(name, "sha256", now[key], f"{recorded[key]}, as in {file}")
    if isinstance(recorded, Mapping):
        given = replace(given, same_twice=recorded.get("deterministic"), why=str(recorded.get("deterministic_why", "")))
    return given


def _sha256(name: str) -> str:
    path = Path(name)
    expected = "an FMU, and a TOML file with the names of its variables"
    with refuse_unreadable(path, expected), open_given(path, FMU_BYTES_MAX) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
