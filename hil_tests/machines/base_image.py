"""The base image of the Dockerfile, made from Debian packages for an engine that can reach no image registry.

debootstrap builds the same minimal Debian as in the published image; it is loaded under the name in the Dockerfile's
``FROM`` line. The host's package settings (mirror, proxy certificate, Python index) go into a layer on top, so that
``apt-get`` and ``pip`` inside a build work as on the host; that layer is rebuilt each time and never cached.

For another processor than this one debootstrap runs that processor's programs: see :mod:`hil_tests.machines.binfmt`.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Mapping
from pathlib import Path

from hil_tests.machines import tools
from railhil.machines import debian

_PURPOSE = "a base image from Debian packages"
#: Debian's name of this machine's processor: the machines are for x86-64 only.
HOST = "amd64"
_CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
#: Their location in the image, separate from its own ca-certificates package.
_IMAGE_CERTIFICATES = "/usr/local/share/host-certificates.crt"
#: pip settings that are also valid inside a container; paths of the host are not.
_PIP_KEYS = ("index-url", "extra-index-url", "trusted-host", "timeout", "default-timeout")
#: Removed as in the published slim images: not needed in a container.
_NOT_NEEDED = ("usr/share/doc", "usr/share/man", "usr/share/locale", "usr/share/info", "var/cache/apt",
               "var/lib/apt/lists", "var/log")  # fmt: skip


def base_name(dockerfile: Path) -> str:
    """Image that the Dockerfile starts from: the default of its ``ARG BASE=``.

    Raises:
        MachineError: the Dockerfile has no such line.
    """
    match = re.search(r"^ARG BASE=(\S+)$", dockerfile.read_text(), re.MULTILINE)
    if match is None:
        raise debian.MachineError(f"{dockerfile}: no line ARG BASE=name:tag")
    return match.group(1)


def _root_archive(suite: str, architecture: str) -> Path:
    """Tar file of a minimal Debian ``suite`` for a processor, from the cache or made now."""
    with debian.cache_lock("docker_engine"):
        home = debian.cache_dir() / "docker_engine"
        home.mkdir(exist_ok=True)
        archive = home / f"{suite}-{architecture}-minbase.tar"
        if archive.exists():
            return archive
        mirrors = [uri for uri, release, _ in tools.mirrors() if release == suite]
        if not mirrors:
            raise debian.CapabilityError(f"{_PURPOSE}: this host's apt has no Debian mirror for {suite}")
        took = "about half a minute" if architecture == HOST else "emulated, some minutes"
        debian.say(f"{_PURPOSE}: debootstrap {suite} {architecture} into {home} ({took})")
        with tempfile.TemporaryDirectory(dir=home) as scratch:
            root = Path(scratch, "root")
            try:
                words = ["debootstrap", "--variant=minbase", f"--arch={architecture}"]
                debian.run_tool([*words, suite, str(root), mirrors[0]])
            except debian.MachineError as error:
                raise debian.CapabilityError(f"{_PURPOSE}: {error}") from error
            for folder in _NOT_NEEDED:
                shutil.rmtree(root / folder, ignore_errors=True)
                (root / folder).mkdir(parents=True)
            part = Path(scratch, "root.tar")
            debian.run_tool(["tar", "-C", str(root), "--numeric-owner", "--one-file-system", "-cf", str(part), "."])
            part.rename(archive)
    return archive


def _pip_settings() -> str:
    """The host's pip settings (files and environment) as a configuration file for the image."""
    lines = ["[global]"]
    if _CERTIFICATES.exists():
        lines.append(f"cert = {_IMAGE_CERTIFICATES}")
    for line in debian.run_tool([sys.executable, "-m", "pip", "config", "list"]).splitlines():
        match = re.fullmatch(r"(?:global|:env:)\.([a-z-]+)='(.*)'", line)
        if match and match.group(1) in _PIP_KEYS:
            values = [value for value in match.group(2).split() if not value.startswith("file:")]
            if values:
                lines.append(f"{match.group(1)} = {' '.join(values)}")
    return "\n".join(lines) + "\n"


def _apt_settings() -> str:
    """The host's apt settings on how packages are fetched (proxy, checks of dates)."""
    lines = debian.run_tool(["apt-config", "dump", "Acquire"]).splitlines()
    kept = ("Acquire::Check-", "Acquire::http::Proxy", "Acquire::https::Proxy", "Acquire::Retries")
    return "".join(f"{line}\n" for line in lines if line.startswith(kept))


def provide_base_image(name: str, environment: Mapping[str, str], architecture: str) -> None:
    """Make image ``name`` (``debian:<suite>[-slim]``) in the engine selected by ``environment``.

    :param architecture: Debian's name of the processor; an engine has one image of a name, that of the last call.

    Raises:
        CapabilityError: debootstrap or the Debian mirror is not available.
        MachineError: the engine refused the image.
    """
    match = re.fullmatch(r"debian:([a-z]+)(?:-slim)?", name)
    if match is None:
        raise debian.MachineError(f"base image {name}: only debian:<suite> and debian:<suite>-slim can be made here")
    suite = match.group(1)
    debian.install_commands({"debootstrap": "debootstrap"}, _PURPOSE)
    archive = _root_archive(suite, architecture)
    bare = f"railhil-bare-base:{suite}-{architecture}-{archive.stat().st_mtime_ns}"
    with tempfile.TemporaryDirectory(prefix="railhil-base-") as scratch:
        context = Path(scratch)
        sources = "".join(f"deb {uri} {release} {part}\n" for uri, release, part in tools.mirrors())
        (context / "sources.list").write_text(sources)
        (context / "80host").write_text(_apt_settings())
        (context / "pip.conf").write_text(_pip_settings())
        recipe = [f"FROM {bare}", "COPY sources.list /etc/apt/sources.list",
                  "COPY 80host /etc/apt/apt.conf.d/80host", "COPY pip.conf /etc/pip.conf"]  # fmt: skip
        if _CERTIFICATES.exists():
            shutil.copy(_CERTIFICATES, context / "ca-certificates.crt")
            recipe.append(f"COPY ca-certificates.crt {_IMAGE_CERTIFICATES}")
        (context / "Dockerfile").write_text("\n".join(recipe) + "\n")
        if not _docker(["images", "-q", bare], environment):
            loaded = context / "bare.tar"
            _write_image(loaded, archive, bare, architecture)
            _docker(["load", "-q", "-i", str(loaded)], environment)
            loaded.unlink()
        _docker(["build", "-q", "--platform", f"linux/{architecture}", "-t", name, str(context)], environment)


def _write_image(image: Path, root: Path, name: str, architecture: str) -> None:
    """Write a tar file of a root directory as an image for ``docker load``, with that one layer.

    ``docker import`` is no use for it: the engine of Debian 12 (20.10) notes its own processor whatever ``--platform``
    says, and refuses the image in a build for that platform.
    """
    with root.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    about = {
        "architecture": architecture,
        "os": "linux",
        "config": {"Cmd": ["bash"]},
        "rootfs": {"type": "layers", "diff_ids": [f"sha256:{digest}"]},
        "history": [{"created_by": "debootstrap"}],
    }
    manifest = [{"Config": "config.json", "RepoTags": [name], "Layers": ["layer.tar"]}]
    with tarfile.open(image, "w") as tar:
        for member, content in (("config.json", about), ("manifest.json", manifest)):
            encoded = json.dumps(content).encode()
            entry = tarfile.TarInfo(member)
            entry.size = len(encoded)
            tar.addfile(entry, io.BytesIO(encoded))
        tar.add(root, "layer.tar")


def _docker(words: list[str], environment: Mapping[str, str]) -> str:
    """Standard output of a docker command that must succeed."""
    done = subprocess.run(
        ["docker", *words], env={**os.environ, **environment}, stdin=subprocess.DEVNULL, capture_output=True,
        text=True, timeout=300, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        raise debian.MachineError(f"docker {words[0]}: {' | '.join(done.stderr.strip().splitlines()[-2:])}")
    return done.stdout.strip()
