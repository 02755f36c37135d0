"""Folders for the sockets of runs: removed after the run, also after a killed one."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from railhil.live import sockets
from railhil.live.sockets import make_private_socket

#: Holds a folder until its end of the pipe is closed.
HOLDER = """
import sys
from railhil.live.sockets import make_private_socket
with make_private_socket() as path:
    path.touch()
    print(path, flush=True)
    sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder for temporary files, of this process and its children."""
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


def holder() -> tuple[subprocess.Popen[str], Path]:
    process = subprocess.Popen([sys.executable, "-c", HOLDER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip()).parent


def failing_run() -> None:
    with make_private_socket() as path:
        path.touch()
        assert path.parent.stat().st_mode & 0o777 == 0o700
        raise ValueError("a run that fails")


def test_the_folder_is_gone_after_the_run(folder: Path) -> None:
    with pytest.raises(ValueError, match="a run"):
        failing_run()
    assert not list(folder.iterdir())


def test_what_a_killed_run_has_left_goes_at_the_next_start_and_nothing_else(folder: Path) -> None:
    killed, stale = holder()
    alive, used = holder()
    killed.kill()
    assert killed.wait() == -signal.SIGKILL
    other = folder / "railhil-run-other"
    other.mkdir()
    (folder / "railhil-run-link").symlink_to(used)
    (stale / "notes.txt").touch()
    with make_private_socket() as path:
        assert sorted(folder.iterdir()) == sorted([stale, used, other, folder / "railhil-run-link", path.parent])
        # A file of somebody else's stays, and with it the folder.
        assert [file.name for file in stale.iterdir()] == ["notes.txt"]
        assert sorted(file.name for file in used.iterdir()) == ["hub.sock", "lock"]
    alive.communicate("")
    assert not used.exists()


def test_the_owner_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    killed, stale = holder()
    killed.kill()
    killed.wait()
    with monkeypatch.context() as somebody:
        somebody.setattr(sockets.os, "geteuid", lambda: 12345)
        with make_private_socket():
            assert stale.exists()
    with make_private_socket():
        assert not stale.exists()
