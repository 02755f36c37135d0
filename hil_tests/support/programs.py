"""Programs of ``railhil`` in this process: faster than in one of their own."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.cli import Done
from railhil.campaign import __main__ as campaign
from railhil.common.exit_codes import guarded

Program = Callable[..., Done]
Campaign = Program


def program_here(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str, main: Callable[[], int]
) -> Program:
    """A program by the ``main`` of its module; its arguments are those of the command line."""
    monkeypatch.setattr("signal.signal", lambda *given: None)

    def call(*arguments: str | Path) -> Done:
        monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
        try:
            code = guarded(f"railhil {name}", main)
        except SystemExit as end:
            code = int(end.code or 0)
        said = capsys.readouterr()
        return Done(code, said.out, said.err)

    return call


def campaign_here(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Campaign:
    """``railhil campaign``."""
    return program_here(monkeypatch, capsys, "campaign", campaign.main)
