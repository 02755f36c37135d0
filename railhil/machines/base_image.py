"""The base image of the Dockerfile, made from Debian packages for an engine that can reach no image registry.

debootstrap builds the same minimal Debian as in the published image; it is imported under the name in the Dockerfile's
``FROM`` line. The host's package settings (mirror, proxy certificate, Python index) go into a layer on top, so that
``apt-get`` and ``pip`` inside a build work as on the host; that layer is rebuilt each time and never cached.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from railhil.machines import debian

_PURPOSE = "a base image from Debian packages"
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


def _root_archive(suite: str) -> Path:
    """Tar file of a minimal Debian ``suite``, from the cache or made now."""
    with debian.cache_lock("docker_engine"):
        home = debian.cache_dir() / "docker_engine"
        home.mkdir(exist_ok=True)
        archive = home / f"{suite}-minbase.tar"
        if archive.exists():
            return archive
        mirrors = [uri for uri, release, _ in debian.mirrors() if release == suite]
        if not mirrors:
            raise debian.CapabilityError(f"{_PURPOSE}: this host's apt has no Debian mirror for {suite}")
        debian.say(f"{_PURPOSE}: debootstrap {suite} into {home} (about half a minute)")
        with tempfile.TemporaryDirectory(dir=home) as scratch:
            root = Path(scratch, "root")
            try:
                debian.run_tool(["debootstrap", "--variant=minbase", suite, str(root), mirrors[0]])
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


def provide_base_image(name: str, environment: Mapping[str, str]) -> None:
    """Make image ``name`` (``debian:<suite>[-slim]``) in the engine selected by ``environment``.

    Raises:
        CapabilityError: debootstrap or the Debian mirror is not available.
        MachineError: the engine refused the image.
    """
    match = re.fullmatch(r"debian:([a-z]+)(?:-slim)?", name)
    if match is None:
        raise debian.MachineError(f"base image {name}: only debian:<suite> and debian:<suite>-slim can be made here")
    suite = match.group(1)
    debian.install_commands({"debootstrap": "debootstrap"}, _PURPOSE)
    archive = _root_archive(suite)
    bare = f"railhil-bare-base:{suite}-{archive.stat().st_mtime_ns}"
    with tempfile.TemporaryDirectory(prefix="railhil-base-") as scratch:
        context = Path(scratch)
        sources = "".join(f"deb {uri} {release} {part}\n" for uri, release, part in debian.mirrors())
        (context / "sources.list").write_text(sources)
        (context / "80host").write_text(_apt_settings())
        (context / "pip.conf").write_text(_pip_settings())
        recipe = [f"FROM {bare}", "COPY sources.list /etc/apt/sources.list",
                  "COPY 80host /etc/apt/apt.conf.d/80host", "COPY pip.conf /etc/pip.conf"]  # fmt: skip
        if _CERTIFICATES.exists():
            shutil.copy(_CERTIFICATES, context / "ca-certificates.crt")
            recipe.append(f"COPY ca-certificates.crt {_IMAGE_CERTIFICATES}")
        (context / "Dockerfile").write_text("\n".join(recipe) + "\n")
        # Imported once per archive: each import creates a new image, for which cached layers on top would not be found.
        if not _docker(["images", "-q", bare], environment):
            _docker(["import", "--change", 'CMD ["bash"]', str(archive), bare], environment)
        _docker(["build", "-q", "-t", name, str(context)], environment)


def _docker(words: list[str], environment: Mapping[str, str]) -> str:
    """Standard output of a docker command that must succeed."""
    done = subprocess.run(
        ["docker", *words], env={**os.environ, **environment}, stdin=subprocess.DEVNULL, capture_output=True,
        text=True, timeout=300, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        raise debian.MachineError(f"docker {words[0]}: {' | '.join(done.stderr.strip().splitlines()[-2:])}")
    return done.stdout.strip()
