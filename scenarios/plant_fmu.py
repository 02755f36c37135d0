"""An FMU as the plant of a run, as named on the command line."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words

OPTION, MAP_OPTION = "--plant-fmu", "--fmu-map"
#: Key of the certificate.
KEY = "plant_fmu"


@dataclass(frozen=True, slots=True)
class PlantFmu:
    """The file of the FMU, and that of the names of its variables (TOML).

    An FMU is native code. It is named on the command line only: no scenario, file of a run or certificate can make a
    command load one.
    """

    file: str
    map: str

    @property
    def words(self) -> list[str]:
        """As words of a command line."""
        return [OPTION, self.file, MAP_OPTION, self.map]

    def as_json(self) -> dict[str, Any]:
        """For the certificate: both files with their hashes.

        :raises InputError: one of them cannot be read.
        """
        return {
            "file": self.file,
            "sha256": _sha256(self.file),
            "map": self.map,
            "map_sha256": _sha256(self.map),
        }


def add_fmu_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that name the FMU."""
    parser.add_argument(
        OPTION, metavar="FILE", help="simulate the train by this FMU, native code (needs the extra [fmi])"
    )
    parser.add_argument(
        MAP_OPTION, metavar="FILE", help=f"names and units of its variables (default: FILE of {OPTION} with .toml)"
    )


def fmu_of(namespace: argparse.Namespace) -> PlantFmu | None:
    """The FMU that a command line names.

    :raises InputError: a map without an FMU, or a file that cannot be read.
    """
    if namespace.plant_fmu is None:
        if namespace.fmu_map is not None:
            raise InputError("command line", MAP_OPTION, namespace.fmu_map, f"only with {OPTION}")
        return None
    file = Path(namespace.plant_fmu)
    found = PlantFmu(str(file), namespace.fmu_map or str(file.with_suffix(".toml")))
    found.as_json()
    return found


def refuse_fmu(document: Mapping[str, Any], file: str | Path) -> None:
    """Refuse a document that names an FMU.

    :raises InputError: it does.
    """
    named = document.get(KEY)
    if named:
        found = Words(str(named.get("file", "an FMU") if isinstance(named, Mapping) else named))
        raise InputError(file, KEY, found, f"{OPTION} on the command line of railhil run: an FMU is native code")


def _sha256(name: str) -> str:
    try:
        return hashlib.sha256(Path(name).read_bytes()).hexdigest()
    except OSError as error:
        reason = Words((error.strerror or str(error)).lower())
        raise InputError(name, "file", reason, "an FMU, and a TOML file with the names of its variables") from None
