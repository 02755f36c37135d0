"""The suite of planted defects: patches for the installed package, and copies of it with one of them."""

from __future__ import annotations

import difflib
import json
import shutil
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from string import Template
from typing import Any

import railhil
from railhil.common.errors import InputError, Sentence, Words, describe_os_error
from railhil.common.held_code import OURS, place_of
from railhil.common.version import full_version
from railhil.judge.folder import code_sha256
from railhil.judge.requirements.requirement import Requirement, named_requirements
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.scenario_documents import any_judged_sha256

_SUITE = Path(__file__).with_name("suite")
#: Law and requirements of the suite, and the runs that a search may make with each of the seeds. Chosen.
LAW = LawSpec("ipfc_plus", "iq")
REQUIREMENTS = "ato"
RUNS, SEEDS = 100, (1, 2, 3, 4, 5)
JOURNEY, PATCHES, PLANTED = "journey.toml", "patches", "planted"
JOURNEY_FILE = _SUITE / JOURNEY


@dataclass(frozen=True, slots=True)
class Defect:
    """A defect: ``find``, a text that ``file`` of the package has once, becomes ``put``."""

    id: str
    title: str
    file: str
    find: str
    put: str

    @property
    def planted(self) -> str:
        """The file with the defect.

        :raises InputError: the installed file has another text, or is compiled.
        """
        path = place_of(self.file)
        text = path.read_text("utf-8")
        if text.count(self.find) != 1:
            raise InputError(path, self.id, Words(f"{text.count(self.find)} times its text"), "once")
        if any(path.with_suffix(suffix).exists() for suffix in EXTENSION_SUFFIXES):
            raise InputError(path, self.id, None, Sentence("it is compiled: a defect in the source would not act"))
        return text.replace(self.find, self.put)

    @property
    def patch(self) -> str:
        """A unified diff for ``patch -p1`` in the folder of the package, or in a checkout."""
        lines = place_of(self.file).read_text("utf-8").splitlines(keepends=True)
        names = f"a/{self.file}", f"b/{self.file}"
        return "".join(difflib.unified_diff(lines, self.planted.splitlines(keepends=True), *names))

    @property
    def code_sha256(self) -> str:
        """That of the bench with the defect, as its runs state it."""
        return code_sha256(changed={self.file: self.planted.encode()})


@cache
def defects() -> dict[str, Defect]:
    """All defects by their ids."""
    tables = tomllib.loads((_SUITE / "defects.toml").read_text("utf-8"))["defect"]
    return {table["id"]: Defect(**table) for table in tables}


def journey() -> AnyScenario:
    """The scenario of the suite."""
    return load_any(str(JOURNEY_FILE))


def requirements() -> tuple[Requirement, ...]:
    """The sentences that a run may violate, besides the rules of every run."""
    return named_requirements([REQUIREMENTS])


def _document() -> dict[str, Any]:
    return {
        "railhil": full_version(),
        "code_sha256": code_sha256(),
        "scenario_sha256": any_judged_sha256(journey()),
        "law": LAW.controller,
        **LAW.how,
        "requirements": REQUIREMENTS,
        "runs": RUNS,
        "seeds": list(SEEDS),
        "defects": [
            {"id": one.id, "title": one.title, "file": one.file, "code_sha256": one.code_sha256}
            for one in defects().values()
        ],
    }


def _readme() -> str:
    return Template((_SUITE / "README.md.in").read_text("utf-8")).substitute(
        version=full_version(),
        controller=LAW.controller,
        arithmetic=LAW.arithmetic,
        requirements=REQUIREMENTS,
        runs=RUNS,
        seeds=", ".join(map(str, SEEDS)),
        defects="\n".join(f"| {one.id} | {one.title} |" for one in defects().values()),
    )


def write_suite(folder: Path) -> list[str]:
    """Write ``README.md``, ``suite.json``, the scenario and the patches.

    :returns: the names of the files.
    :raises InputError: the folder has other files, or cannot be written.
    """
    if folder.is_dir() and not (folder / "suite.json").is_file() and any(folder.iterdir()):
        raise InputError("command line", "DIR", str(folder), "a new or empty folder, or a suite to write anew")
    files = {
        "README.md": _readme(),
        "suite.json": json.dumps(_document(), indent=2) + "\n",
        JOURNEY: JOURNEY_FILE.read_text("utf-8"),
        **{f"{PATCHES}/{one.id}.patch": one.patch for one in defects().values()},
    }
    try:
        (folder / PATCHES).mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, "utf-8")
    except OSError as error:
        raise InputError(folder, "", None, Sentence(describe_os_error(error))) from error
    return list(files)


def plant(name: str, folder: Path) -> Path:
    """Copy the installed package, with a defect.

    :param folder: of the suite.
    :returns: the folder to be named in ``PYTHONPATH``.
    :raises InputError: there is no such defect, it does not fit, or the copy cannot be written.
    """
    if name not in defects():
        raise InputError("command line", "--plant", name, ", ".join(defects()))
    defect, place = defects()[name], folder / PLANTED / name
    text = defect.planted
    parts = {OURS: Path(railhil.__path__[0]), **{f"{OURS}/{part}": place_of(part) for part in railhil.AT_TOP}}
    try:
        if place.exists():
            shutil.rmtree(place)
        for part, source in parts.items():
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(source, place / part, ignore=ignored, dirs_exist_ok=True)
        (place / OURS / defect.file).write_text(text, "utf-8")
    except (OSError, shutil.Error) as error:
        problem = describe_os_error(error) if isinstance(error, OSError) else str(error)
        raise InputError(place, "", None, Sentence(problem)) from error
    return place
