"""The folder of a run: made at the start, removed if the run never began; its inputs and its JSON documents."""

from __future__ import annotations

import getpass
import json
import os
import platform
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError
from railhil.common.user_files import not_written, whole_file
from railhil.dbc import DBC, PORTS
from railhil.dbc.text import dbc_text, table_text
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.scenario_documents import SCENARIO, any_document


def json_text(document: dict[str, Any]) -> str:
    """A JSON document as the text of a file."""
    return json.dumps(document, indent=2, allow_nan=False, default=str) + "\n"


def write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a JSON document atomically."""
    with whole_file(path) as draft:
        draft.write_text(json_text(document), encoding="utf-8")


#: Names of the nodes' files in the run folder: telemetry of the controller, timing of the plant.
TELEMETRY, TIMING = "telemetry.json", "timing.csv"
#: Free disk space required to begin a run: for the output of the nodes and the beginning of the log. A run of 3 min
#: takes 6 MB.
ROOM_MIN_BYTES = 128 * 1024


def recorded_by() -> dict[str, str]:
    """The entry ``recorded`` of a document: instant, host, and who operated it (``RAILHIL_OPERATOR``, else the user;
    empty: not known)."""
    try:
        operator = os.environ.get("RAILHIL_OPERATOR") or getpass.getuser()
    except (KeyError, OSError):
        operator = ""
    return {
        "utc": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "host": platform.node(),
        "operator": operator,
    }


def run_folder(out: str | Path | None, scenario: str, controller: str) -> tuple[Path, bool]:
    """Make the folder of a new run.

    :param out: the folder itself if the user names one; it must be empty or not exist.
    :returns: the folder, and whether it was created here.
    :raises InputError: the named folder is not empty, cannot be created or cannot be written.
    :raises RecordFailed: there is not enough disk space.
    """
    if out is not None and not str(out).strip():
        raise InputError("command line", "--out", str(out), "name of an empty or new folder")
    stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
    folder = Path(out) if out is not None else Path("runs") / f"{stamp}-{scenario}-{controller}"
    made = False
    try:
        made = out is None or not folder.exists()
        if out is None:
            folder = _new_folder(folder)
        else:
            folder.mkdir(parents=True, exist_ok=True)
        occupied = any(folder.iterdir())
        # The test file leaves nothing behind. A check of permissions would not detect a read-only or full file system.
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(ROOM_MIN_BYTES))
            probe.flush()
    except OSError as error:
        if made and folder.is_dir():
            folder.rmdir()
        raise not_written("--out", folder, "folder", error) from None
    if occupied:
        raise InputError("command line", "--out", str(folder), "an empty or new folder")
    return folder, made


def _new_folder(wanted: Path) -> Path:
    """Create a folder of this name, with a number appended if it exists: runs started in the same second never share
    one."""
    wanted.parent.mkdir(parents=True, exist_ok=True)
    folder, serial = wanted, 1
    while True:
        try:
            folder.mkdir()
        except FileExistsError:
            serial += 1
            folder = wanted.with_name(f"{wanted.name}-{serial}")
        else:
            return folder


def discard_folder(folder: Path, made: bool) -> None:
    """Remove the files of a run that never began, and the folder itself if it was created for the run."""
    for path in folder.iterdir():
        path.unlink()
    if made:
        folder.rmdir()


def remove_torn_run(folder: Path) -> None:
    """Remove what a process that died in the middle of a run has left in its folder.

    :param folder: known to have been empty, or not to exist, when the runs began.
    """
    if folder.is_dir() and any(folder.iterdir()):
        shutil.rmtree(folder)


#: Parameters of the law, if they are not the law's own.
PARAMETERS = "parameters.json"


def write_inputs(folder: Path, scenario: AnyScenario, parameters: ParameterSet | None) -> None:
    """Write resolved scenario, wire contract and parameters; always the nominal scenario.

    :raises OSError: it cannot be written.
    """
    write_json(folder / SCENARIO, any_document(scenario))
    system = scenario.installed_system
    (folder / PORTS).write_text(table_text(system.contract), encoding="utf-8")
    (folder / DBC).write_text(dbc_text(system.contract), encoding="utf-8")
    if parameters is not None:
        write_json(folder / PARAMETERS, parameters.as_json())
