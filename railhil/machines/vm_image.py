"""Kernel and initial file system of the test machine, made once per kernel version and kept in the cache.

The kernel is Debian's own (it has CAN as modules), unpacked and never installed; the file system is a static
busybox, the modules in load order and ``vm_init.sh``.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from railhil.machines import debian

_PURPOSE = "a kernel with CAN in a virtual machine"
_INIT = Path(__file__).with_name("vm_init.sh")

#: Modules to load, dependencies are added. crc32c_generic is what libcrc32c asks for by name at load time.
MODULES = (
    "crc32c_generic", "libcrc32c", "virtio_pci", "virtio_blk", "virtio_console", "ext4", "9pnet_virtio", "9p",
    "overlay", "vcan", "vxcan", "slcan", "can_raw", "can_bcm", "can_isotp", "can_gw",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class VmImage:
    """Files to boot from, and the kernel's version."""

    kernel: Path
    initrd: Path
    version: str


def newest_kernel_package() -> str:
    """Name of the package that ``linux-image-amd64`` depends on.

    Raises:
        CapabilityError: it is not in the package lists.
    """

    def depends() -> str:
        text = debian.run_tool(["apt-cache", "depends", "linux-image-amd64"])
        match = re.search(r"Depends: (linux-image-\d\S*-amd64)\s", text)
        if match is None:
            raise debian.MachineError("linux-image-amd64 depends on no kernel image")
        return match.group(1)

    return debian.with_package_lists(depends, _PURPOSE)


def ensure_image() -> VmImage:
    """The machine's files, from the cache or newly made (some seconds, one download of about 70 MB).

    A cached image is used unchanged, also without a network; remove the cache folder to get a newer kernel.

    Raises:
        CapabilityError: the Debian packages are not available.
        MachineError: a package did not unpack as expected.
    """
    recipe = hashlib.sha256(_INIT.read_bytes() + repr(MODULES).encode()).hexdigest()[:12]
    home = debian.cache_dir() / "vcan_vm"
    with debian.cache_lock("vcan_vm"):
        for kernel in sorted(home.glob(f"{recipe}/vmlinuz-*"), reverse=True):
            return VmImage(kernel, kernel.with_name("initrd.cpio"), kernel.name.removeprefix("vmlinuz-"))
        package = newest_kernel_package()
        debian.say(f"{_PURPOSE}: making the machine from {package} in {home}")
        home.mkdir(exist_ok=True)
        for stale in home.iterdir():
            shutil.rmtree(stale)
        with tempfile.TemporaryDirectory(dir=home) as scratch:
            _build(package, Path(scratch))
            Path(scratch, "image").rename(home / recipe)
    version = package.removeprefix("linux-image-")
    return VmImage(home / recipe / f"vmlinuz-{version}", home / recipe / "initrd.cpio", version)


def _build(package: str, scratch: Path) -> None:
    """Unpack kernel and busybox under ``scratch`` and leave ``scratch/image`` complete."""
    tree, root, image = scratch / "tree", scratch / "root", scratch / "image"
    for folder in (tree, root / "bin", root / "modules", image):
        folder.mkdir(parents=True)
    for name in (package, "busybox-static"):
        debian.run_tool(["dpkg-deb", "-x", str(debian.download_package(name, scratch, _PURPOSE)), str(tree)])
    version = package.removeprefix("linux-image-")
    debian.run_tool(["depmod", "-b", str(tree), version])
    order = _load_order(tree / "lib" / "modules" / version)
    for module in order:
        shutil.copy(module, root / "modules")
    (root / "modules" / "order").write_text("".join(f"{module.name}\n" for module in order))
    shutil.copy(tree / "bin" / "busybox", root / "bin")
    shutil.copy(_INIT, root / "init")
    (root / "init").chmod(0o755)
    names = "\n".join(sorted(str(path.relative_to(root)) for path in root.rglob("*")))
    with (image / "initrd.cpio").open("wb") as archive:
        subprocess.run(
            [str(tree / "bin" / "busybox"), "cpio", "-o", "-H", "newc"], cwd=root, stdout=archive,
            stderr=subprocess.DEVNULL, input=names.encode(), check=True, timeout=60,
        )  # fmt: skip
    shutil.copy(tree / "boot" / f"vmlinuz-{version}", image)


def _load_order(folder: Path) -> list[Path]:
    """Module files, each after all its dependencies; modules that are built into the kernel are left out.

    ``modules.dep`` lists for each file its dependencies, the deepest last.
    """

    def plain(path: str) -> str:
        return Path(path).name.split(".")[0].replace("-", "_")

    built_in = {plain(line) for line in (folder / "modules.builtin").read_text().splitlines()}
    needs: dict[str, list[str]] = {}
    for line in (folder / "modules.dep").read_text().splitlines():
        own, _, others = line.partition(":")
        needs[plain(own)] = [*reversed(others.split()), own]
    order: list[str] = []
    for name in MODULES:
        if name in built_in:
            continue
        if name not in needs:
            raise debian.MachineError(f"the kernel package has no module {name}")
        order += [path for path in needs[name] if path not in order]
    return [folder / path for path in order]
