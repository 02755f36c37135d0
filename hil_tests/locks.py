"""Lock files of hosted CI: ``python3.12 hil_tests/locks.py`` (``make locks``) writes those of the Python that runs it.

pip resolves the project's extras and says in its report (``--report``) which files it would install; each becomes a
line with its SHA-256 in ``requirements/NAME-VERSION.txt``, in pip's own format. Nothing is installed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "requirements"
#: Name of a lock -> the extras in it, and the Python versions with which a workflow installs it: `ci` for the tests,
#: `bench` for a run with its report.
LOCKS = {
    "ci": (("dev", "report", "campaign", "dask"), ("3.11", "3.12", "3.13")),
    "bench": (("report",), ("3.11",)),
}
_INDEX = "https://pypi.org/simple"


def requirements(extras: tuple[str, ...]) -> list[str]:
    """Requirements of the project with these extras, and of its build, which is then not isolated."""
    document = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project = document["project"]
    found = [*document["build-system"]["requires"], *project["dependencies"]]
    return found + [line for extra in extras for line in project["optional-dependencies"][extra]]


def report_of(wanted: list[str]) -> dict[str, Any]:
    """pip's report on what it would install from the public index, as wheels.

    :raises subprocess.CalledProcessError: pip cannot resolve it; it has said why.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "report.json"
        words = ["--dry-run", "--ignore-installed", "--only-binary=:all:", "--quiet", "--index-url", _INDEX]
        command = [sys.executable, "-m", "pip", "--isolated", "--disable-pip-version-check", "install", *words]
        subprocess.run([*command, "--report", str(file), *wanted], check=True)
        report: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return report


def lock_text(report: dict[str, Any]) -> str:
    """The lock file for a report of pip."""
    made = report["environment"]
    machine = f"{made['sys_platform']} {made['platform_machine']}"
    lines = [
        f"# Made by `make locks` for Python {made['python_version']} on {machine}:",
        "# the files that hosted CI installs, with pip install --require-hashes.",
    ]
    for item in sorted(report["install"], key=lambda item: item["metadata"]["name"].lower()):
        metadata, hashes = item["metadata"], item["download_info"]["archive_info"]["hashes"]
        lines.append(f"{metadata['name']}=={metadata['version']} \\\n    --hash=sha256:{hashes['sha256']}")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the lock files for this Python."""
    FOLDER.mkdir(exist_ok=True)
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    for name, (extras, versions) in LOCKS.items():
        if version not in versions:
            continue
        try:
            report = report_of(requirements(extras))
        except subprocess.CalledProcessError as error:
            return error.returncode
        path = FOLDER / f"{name}-{version}.txt"
        path.write_text(lock_text(report), encoding="utf-8")
        print(f"{os.path.relpath(path)}: {len(report['install'])} packages")
    return 0


if __name__ == "__main__":
    sys.exit(main())
