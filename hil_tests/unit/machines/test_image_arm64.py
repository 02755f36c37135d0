"""The check of the image for aarch64: what it makes of the answers of an engine."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests import image_arm64
from hil_tests.support.paths import ROOT
from railhil.machines import debian

_ENGINE = {"RAILHIL_BUILD_NETWORK": "host"}
#: Writes down what it is called with; a run of the bench leaves a certificate in the mounted folder.
_DOCKER = """#!/bin/sh
echo "$@" >>"$0.said"
case $1 in
image) echo '[{"Architecture": "ARCHITECTURE", "Size": 795000000}]' ;;
run)
    for word; do case $word in *:/runs) folder=${word%:/runs} ;; esac; done
    mkdir "$folder/run" && echo '{"frames_sha256": "abc"}' >"$folder/run/certificate.json"
    echo MACHINE
    exit CODE
    ;;
esac
"""


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """What an engine that does everything right was told."""
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    _answering(tmp_path)
    return tmp_path / "docker.said"


def _answering(folder: Path, architecture: str = "arm64", machine: str = "aarch64", code: int = 0) -> None:
    """The program ``docker`` with these answers."""
    docker = folder / "docker"
    text = _DOCKER.replace("ARCHITECTURE", architecture).replace("MACHINE", machine).replace("CODE", str(code))
    docker.write_text(text)
    docker.chmod(0o755)


def test_image_is_built_for_aarch64_and_removed(said: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with image_arm64.image(_ENGINE):
        assert "795 MB" in capsys.readouterr().out
    build, _, removed = said.read_text().splitlines()
    assert build == f"build --platform linux/arm64 --network host -t railhil-bench-arm64 {ROOT}"
    assert removed == "rmi --no-prune railhil-bench-arm64"


def test_image_for_another_processor_is_an_error_and_removed(said: Path) -> None:
    _answering(said.parent, architecture="amd64")
    with pytest.raises(debian.MachineError, match="found amd64, allowed arm64"), image_arm64.image(_ENGINE):
        raise AssertionError("not reached")
    assert said.read_text().splitlines()[-1].startswith("rmi ")


@pytest.mark.parametrize("code", [0, 1])
def test_run_with_a_verdict_has_a_hash(said: Path, code: int) -> None:
    _answering(said.parent, code=code)
    assert image_arm64.contained("lvshun_tieshan", ["--bus", "local"], _ENGINE) == "abc"
    run, removed = said.read_text().splitlines()
    assert "--platform linux/arm64 --network none " in run
    assert run.endswith(" lvshun_tieshan --bus local --out /runs/run")
    assert removed == "rm -f railhil-bench-arm64"


@pytest.mark.parametrize(
    ("machine", "code", "named"), [("x86_64", 0, "its processor is x86_64"), ("aarch64", 3, "docker run ended with 3")]
)
def test_run_elsewhere_or_without_a_verdict_is_an_error(said: Path, machine: str, code: int, named: str) -> None:
    _answering(said.parent, machine=machine, code=code)
    with pytest.raises(debian.MachineError, match=named):
        image_arm64.contained("lvshun_tieshan", [], _ENGINE)
    assert said.read_text().splitlines()[-1] == "rm -f railhil-bench-arm64"


def test_another_host_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def refuse(purpose: str) -> None:
        raise debian.CapabilityError(f"{purpose} needs root, this is user id 1000")

    monkeypatch.setattr(debian, "require_debian_root", refuse)
    assert image_arm64.main([]) == debian.EXIT_NO_CAPABILITY
    assert capsys.readouterr().err == "image_arm64: programs for aarch64 needs root, this is user id 1000\n"
