"""A zip of the tree, and wheel and source archive built of it once."""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.venvs import MissingCapabilityError, project

_BACKEND = "import setuptools.build_meta as build, sys; print(getattr(build, 'build_' + sys.argv[1])(sys.argv[2]))"


@dataclass(frozen=True, slots=True)
class Built:
    """The files of a release."""

    wheel: Path
    sdist: Path
    #: That of the commit from which they were built.
    version: str


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    folder = Path(__file__).parent
    for item in items:
        if item.path.parent == folder:
            item.add_marker(pytest.mark.slow)
            # Libraries for other interpreters are downloaded once.
            item.add_marker(pytest.mark.timeout(900))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    """Skip by capability, naming it."""
    try:
        return (yield)
    except MissingCapabilityError as error:
        pytest.skip(str(error))


def _build(source: Path, kind: str, folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    done = subprocess.run(
        [sys.executable, "-c", _BACKEND, kind, str(folder)], cwd=source, capture_output=True, text=True, timeout=300,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    # What setuptools says of a folder that will not be a package one day.
    assert "Package would be ignored" not in done.stderr
    return folder / done.stdout.splitlines()[-1]


@pytest.fixture(scope="session")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A zip of what git would check out: other files in the work tree must not matter."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    path = tmp_path_factory.mktemp("zip") / "railhil.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for name in listed.stdout.splitlines():
            if (ROOT / name).exists():
                archive.write(ROOT / name, name)
    return path


@pytest.fixture(scope="session")
def built(archive: Path, tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Wheel and source archive, built in a repository with the files of the tree."""
    folder = tmp_path_factory.mktemp("build")
    source = folder / "source"
    shutil.unpack_archive(archive, source)
    own = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "Tree"]):
        subprocess.run([*own, *words], cwd=source, check=True)
    head = subprocess.run(["git", "rev-parse", "--short=7", "HEAD"], cwd=source, check=True, capture_output=True)
    version = f"{project()['version']}+g{head.stdout.decode().strip()}"
    return Built(_build(source, "wheel", folder / "wheel"), _build(source, "sdist", folder / "sdist"), version)


@pytest.fixture
def wheel_of_sdist(built: Built, tmp_path: Path) -> Path:
    """The wheel built from the source archive."""
    # The filters of shutil and tarfile are not in every Python 3.11.
    subprocess.run(["tar", "-xf", built.sdist, "-C", tmp_path], check=True)
    return _build(tmp_path / built.sdist.name.removesuffix(".tar.gz"), "wheel", tmp_path / "again")
