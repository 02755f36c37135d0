"""Fixtures for tests of the commands."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from hil_tests.support.cli import Done
from railhil import cli

Railhil = Callable[..., Done]


@pytest.fixture
def here(monkeypatch, capsys, tmp_path) -> Iterator[Railhil]:
    """The command in this process, in an empty folder: like in a separate process, but faster."""
    monkeypatch.chdir(tmp_path)
    handlers = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}

    def call(*arguments: str | Path) -> Done:
        try:
            code = cli.main([str(word) for word in arguments])
        except SystemExit as end:
            code = int(end.code or 0)
        said = capsys.readouterr()
        return Done(code, said.out, said.err)

    yield call
    for number, handler in handlers.items():
        signal.signal(number, handler)
