"""Branches of recorded runs that a page asks for: each is made by ``railhil branch``, in a process of its own."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError
from railhil.common.python_process import WITH_PARENT
from railhil.common.user_files import RecordFailed
from railhil.record.documents import read_certificate
from railhil.record.hash_list import REPORT
from railhil.record.run_folder import run_folder

_END_S = 5.0
#: No run lasts so long.
_AT_MAX_S = 1e9


class Branches:
    """The branches of some run folders, one at a time; those made are kept for pages that connect later.

    Each has a folder of its own in ``runs``, as a run without ``--out``.
    """

    def __init__(self, folders: Sequence[str | Path]) -> None:
        self._folders = [Path(folder) for folder in folders]
        self._made: list[dict[str, Any]] = []
        self._process: subprocess.Popen[bytes] | None = None
        self._is_told = True

    def begin(self, asked: dict[str, Any]) -> str:
        """Begin a branch: ``run`` (place among the folders), ``at_s`` and ``fault``, a text of the fault language.

        :returns: the reason if it was refused, else empty.
        """
        wanted = self._parse(asked)
        if wanted is None:
            return "found no branch, allowed a run, an instant and a fault such as TRN_SPEED loss for 2s"
        if self._process is not None:
            return "another branch is being made"
        folder, at_s, text = wanted
        try:
            certificate = read_certificate(folder)
            if certificate is None:
                return "the run has not ended: a branch is made from its record"
            scenario, controller = (str(certificate.get(key)) for key in ("scenario", "controller"))
            # A scenario is a name or a file.
            place, _ = run_folder(None, Path(scenario).stem, controller)
        except (InputError, RecordFailed) as error:
            return str(error)
        words = ["branch", str(folder), f"@{at_s:.3f}s", f"--fault={text}", f"--out={place}"]
        # Also a panel that is killed leaves no branch behind, where the system has a command for this.
        with_parent = WITH_PARENT if shutil.which(WITH_PARENT[0]) else ()
        # Its errors are read when it has ended.
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        self._process = subprocess.Popen(
            [*with_parent, sys.executable, "-P", "-m", "railhil.cli", *words],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=self._errors,
        )  # fmt: skip
        self._is_told = False
        self._made.append({"run": asked["run"], "at_s": round(at_s, 3), "fault": text, "folder": str(place)})
        return ""

    def _parse(self, asked: dict[str, Any]) -> tuple[Path, float, str] | None:
        run, at_s, text = asked.get("run"), asked.get("at_s"), asked.get("fault")
        if not isinstance(run, int) or isinstance(run, bool) or not 0 <= run < len(self._folders):
            return None
        if not isinstance(at_s, int | float) or isinstance(at_s, bool) or not 0 <= at_s < _AT_MAX_S:
            return None
        # No command line has a NUL or half a surrogate.
        if not isinstance(text, str) or not text.strip() or not text.isprintable():
            return None
        return self._folders[run], float(at_s), text.strip()

    def describe(self, problem: str = "") -> str:
        """A message with all branches; one without a verdict is being made. ``problem``: why the last one failed."""
        return json.dumps({"branches": self._made, "problem": problem})

    def look(self) -> list[str | bytes]:
        """The news: a branch that has begun or ended."""
        if self._process is None or self._process.poll() is None:
            is_told, self._is_told = self._is_told, True
            return [] if is_told else [self.describe()]
        exit_code, self._process = self._process.returncode, None
        last, problem = self._made[-1], ""
        folder = Path(last["folder"])
        certificate = read_certificate(folder)
        if certificate is not None:
            last |= {name: certificate.get(name) or "" for name in ("verdict", "line")}
            last["report"] = (folder / REPORT).is_file()
        else:
            self._errors.seek(0)
            lines = self._errors.read().decode(errors="replace").split("\n")
            said = [line for line in lines if line.strip()]
            problem = said[-1].removeprefix("railhil: ") if said else f"it has ended with exit code {exit_code}"
            self._forget_last()
        self._errors.close()
        return [self.describe(problem)]

    def _forget_last(self) -> None:
        shutil.rmtree(self._made.pop()["folder"], ignore_errors=True)

    def report(self, number: str) -> bytes | None:
        """The report of a branch by its number, from 0 on; None: there is none."""
        place = int(number) if number.isascii() and number.isdigit() else -1
        if not 0 <= place < len(self._made) or not self._made[place].get("report"):
            return None
        try:
            return (Path(self._made[place]["folder"]) / REPORT).read_bytes()
        except OSError:
            return None

    def close(self) -> None:
        """End the branch that is being made, and remove its folder."""
        process, self._process = self._process, None
        if process is None:
            return
        process.terminate()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self._forget_last()
