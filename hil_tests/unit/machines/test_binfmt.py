"""The emulator of aarch64 in binfmt_misc: registered only where there is none, and taken out again.

A folder stands for the file system, so an entry is not made by a write to ``register`` and is a file of the test's own.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.machines import binfmt
from railhil.machines import debian

_ENTRY = """enabled
interpreter /usr/libexec/qemu-binfmt/aarch64-binfmt-P
flags: POF
offset 0
magic 7f454c460201010000000000000000000200b700
mask ffffffffffffff00fffffffffffffffffeffffff
"""
_RULE = r":qemu-aarch64:M::\x7f\x45\x4c\x46:\xff\xff\xff\xff:/usr/libexec/qemu-binfmt/aarch64-binfmt-P:OPF"
_OURS = _RULE.replace("qemu-aarch64:", "railhil-aarch64:", 1)


@pytest.fixture
def rule(tmp_path: Path) -> Path:
    """Debian's file."""
    path = tmp_path / "qemu-aarch64.conf"
    path.write_text(f"{_RULE}\n")
    return path


@pytest.fixture
def mounted(tmp_path: Path) -> Path:
    """The file system without an entry."""
    folder = tmp_path / "binfmt_misc"
    folder.mkdir()
    (folder / "status").write_text("enabled\n")
    (folder / "register").write_text("")
    return folder


@pytest.mark.parametrize(
    ("found", "put", "serves"),
    [
        ("", "", True),
        ("flags: POF", "flags: F", True),
        ("flags: POF", "flags: OC", False),
        ("flags: POF", "flags: ", False),
        ("enabled", "disabled", False),
        # EM_ARM
        ("0200b700", "02002800", False),
    ],
)
def test_emulator_serves_containers_only_when_enabled_for_aarch64_with_flag_f(
    found: str, put: str, serves: bool
) -> None:
    assert binfmt.serves_containers(_ENTRY.replace(found, put)) is serves


@pytest.mark.parametrize("rule", [_RULE.replace("OPF", "OP"), _RULE.replace("aarch64:M", "arm:M"), ""])
def test_rule_that_is_no_use_is_refused(rule: str) -> None:
    with pytest.raises(debian.MachineError, match="no rule qemu-aarch64 with flag F"):
        binfmt.own_entry(rule)


def test_emulator_is_registered_and_taken_out(mounted: Path, rule: Path) -> None:
    with binfmt.registered(mounted, rule):
        assert (mounted / "register").read_text() == _OURS
        assert not (mounted / "railhil-aarch64").exists()
    assert (mounted / "railhil-aarch64").read_text() == "-1"


def test_emulator_is_taken_out_after_a_failure(mounted: Path, rule: Path) -> None:
    with pytest.raises(ZeroDivisionError), binfmt.registered(mounted, rule):
        raise ZeroDivisionError
    assert (mounted / "railhil-aarch64").read_text() == "-1"


def test_emulator_of_the_host_is_used_and_left(mounted: Path, rule: Path) -> None:
    (mounted / "qemu-aarch64").write_text(_ENTRY)
    with binfmt.registered(mounted, rule):
        pass
    assert {path.name for path in mounted.iterdir()} == {"qemu-aarch64", "register", "status"}
    assert (mounted / "register").read_text() == ""
    assert (mounted / "qemu-aarch64").read_text() == _ENTRY


def test_entry_of_a_killed_process_is_made_anew(mounted: Path, rule: Path) -> None:
    (mounted / "railhil-aarch64").write_text(_ENTRY)
    with binfmt.registered(mounted, rule):
        assert (mounted / "railhil-aarch64").read_text() == "-1"
        assert (mounted / "register").read_text() == _OURS


def test_host_that_has_switched_it_off_cannot_do_it(mounted: Path, rule: Path) -> None:
    (mounted / "status").write_text("disabled\n")
    with pytest.raises(debian.CapabilityError, match="switched off"), binfmt.registered(mounted, rule):
        raise AssertionError("not reached")


def test_kernel_that_refuses_the_entry_is_one_line(mounted: Path, rule: Path) -> None:
    (mounted / "register").unlink()
    (mounted / "register").mkdir()
    with pytest.raises(debian.MachineError, match="refuses the emulator"), binfmt.registered(mounted, rule):
        raise AssertionError("not reached")


def test_kernel_without_it_is_a_missing_capability(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def run_tool(words: list[str]) -> str:
        raise debian.MachineError(f"{words[0]} ended with 32: unknown filesystem type 'binfmt_misc'.")

    monkeypatch.setenv("RAILHIL_CACHE", str(tmp_path))
    monkeypatch.setattr(debian, "require_debian_root", lambda _: None)
    monkeypatch.setattr(debian, "install_commands", lambda *_: None)
    monkeypatch.setattr(debian, "run_tool", run_tool)
    with pytest.raises(debian.CapabilityError, match="this kernel has no binfmt_misc"), binfmt.aarch64_programs():
        raise AssertionError("not reached")
