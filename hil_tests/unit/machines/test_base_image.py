"""The base image of the Dockerfile: under its name, for the processor asked for."""

from __future__ import annotations

import hashlib
import json
import subprocess
from pathlib import Path

import pytest

from hil_tests.machines import base_image
from hil_tests.support.paths import ROOT
from railhil.machines import debian

#: Writes down what it is called with, keeps what it is to load, and has no image yet.
_DOCKER = """#!/bin/sh
echo "$@" >>"$DOCKER_SAID"
[ "$1" != load ] || cp "$4" "${DOCKER_SAID%said}loaded.tar"
"""


@pytest.mark.parametrize("architecture", ["amd64", "arm64"])
def test_base_image_is_for_the_processor_asked_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, architecture: str
) -> None:
    docker, said = tmp_path / "bin" / "docker", tmp_path / "said"
    docker.parent.mkdir()
    docker.write_text(_DOCKER)
    docker.chmod(0o755)
    archive = tmp_path / "docker_engine" / f"bookworm-{architecture}-minbase.tar"
    archive.parent.mkdir()
    archive.write_bytes(b"layer")
    monkeypatch.setenv("RAILHIL_CACHE", str(tmp_path))
    monkeypatch.setenv("PATH", str(docker.parent), prepend=":")
    monkeypatch.setattr(debian, "install_commands", lambda *_: None)
    monkeypatch.setattr(debian, "run_tool", lambda _: "")
    name = base_image.base_name(ROOT / "Dockerfile")
    base_image.provide_base_image(name, {"DOCKER_SAID": str(said)}, architecture)
    assert said.read_text().splitlines()[-1].startswith(f"build -q --platform linux/{architecture} -t {name} ")
    loaded = tmp_path / "loaded"
    loaded.mkdir()
    subprocess.run(["tar", "-C", str(loaded), "-xf", str(tmp_path / "loaded.tar")], check=True)
    (manifest,) = json.loads((loaded / "manifest.json").read_text())
    about = json.loads((loaded / manifest["Config"]).read_text())
    assert about["architecture"] == architecture
    assert about["rootfs"]["diff_ids"] == [f"sha256:{hashlib.sha256(b'layer').hexdigest()}"]
    assert [(loaded / name).read_bytes() for name in manifest["Layers"]] == [b"layer"]
    assert f":bookworm-{architecture}-" in manifest["RepoTags"][0]
