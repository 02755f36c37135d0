"""Ctrl-C while a program is still loading: exit code 130 and one line, at whatever moment it comes."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys

import pytest

from hil_tests.support.paths import ROOT
from railhil.cli import programs as outside
from railhil.common.errors import InputError
from railhil.common.exit_codes import hold_back_interrupts, run_guarded

_TIMEOUT_S = 60
#: What every program with modules of weight loads early.
_WEIGHTS = ("numpy.py", "can.py", "argparse.py")
#: Becomes the program, as ``railhil`` does, with a Ctrl-C that came on the way.
_BECOME = """
import os, signal, sys
from railhil.common.exit_codes import hold_back_interrupts
signal.signal(signal.SIGINT, signal.default_int_handler)
hold_back_interrupts()
os.kill(os.getpid(), signal.SIGINT)
os.execv(sys.executable, [sys.executable, "-m", *sys.argv[1:]])
"""


def _stopped(done: subprocess.CompletedProcess[str]) -> None:
    assert (done.returncode, done.stdout) == (130, "")
    assert re.fullmatch(r"[a-z -]+: stopped by Ctrl-C\n", done.stderr), done.stderr


@pytest.mark.parametrize(
    "module",
    ["railhil.cli", "railhil.controller_node", "railhil.plant_sim", "railhil.machines.adapter", "railhil.bus.hub"],
)
def test_ctrl_c_while_the_modules_load(tmp_path, monkeypatch, module):
    for name in _WEIGHTS:
        (tmp_path / name).write_text("raise KeyboardInterrupt")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    done = subprocess.run(
        [sys.executable, "-m", module], capture_output=True, text=True, check=False, timeout=_TIMEOUT_S, cwd=ROOT
    )
    _stopped(done)


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize("module", [*outside.NODES.values(), *outside.PROGRAMS.values()], ids=str)
def test_ctrl_c_on_the_way_into_another_program(module):
    """Every program that ``railhil`` becomes takes what was held back."""
    done = subprocess.run(
        [sys.executable, "-c", _BECOME, module, "--help"],
        capture_output=True,
        text=True,
        check=False,
        timeout=_TIMEOUT_S,
        cwd=ROOT,
    )
    _stopped(done)


def test_railhil_holds_ctrl_c_back_when_it_becomes_another_program(monkeypatch):
    held: list[set[signal.Signals]] = []
    monkeypatch.setattr(os, "execv", lambda *_: held.append(signal.pthread_sigmask(signal.SIG_BLOCK, [])))
    try:
        outside.become_program(["export-c", "ipfc"])
        assert [signal.SIGINT in signals for signals in held] == [True]
        monkeypatch.setitem(outside.PROGRAMS, "export-c", "no_such_module")
        with pytest.raises(InputError):
            outside.become_program(["export-c", "ipfc"])
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])


def test_a_program_in_good_order_hears_ctrl_c():
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        hold_back_interrupts()
        assert run_guarded("program", lambda: 0) == 0
        assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
        for number, handler in handlers.items():
            signal.signal(number, handler)
