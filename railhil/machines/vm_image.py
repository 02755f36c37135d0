"""Kernel and initial file system of a test machine, made once and kept in the cache.

The kernel is one of Debian's own packages with CAN as modules, unpacked and never installed; the file system is a
static busybox, the modules in load order and ``vm_init.sh``.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from railhil.machines import debian

PURPOSE = "a kernel with CAN in a virtual machine"
_INIT = Path(__file__).with_name("vm_init.sh")
#: Modules of every machine.
CAN_MODULES = ("overlay", "vcan", "vxcan", "slcan", "can_raw", "can_bcm", "can_gw")


@dataclass(frozen=True, slots=True)
class VmImage:
    """Files to boot from."""

    kernel: Path
    initrd: Path


@dataclass(frozen=True, slots=True)
class Recipe:
    """What an image is made of.

    Attributes:
        name: folder in the cache.
        package: finds the name of the Debian package with the kernel.
        kernel: pattern of the kernel's file in the package.
        folder: pattern of the modules' folder in the package.
        modules: to load; dependencies are added.
    """

    name: str
    package: Callable[[], str]
    kernel: str
    folder: str
    modules: tuple[str, ...]

    @property
    def key(self) -> str:
        """Changes with what the image holds beside the kernel."""
        return hashlib.sha256(_INIT.read_bytes() + repr(self.modules).encode()).hexdigest()[:12]


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

    return debian.with_package_lists(depends, PURPOSE)


def ensure_image(recipe: Recipe) -> VmImage:
    """The machine's files, from the cache or newly made (some seconds, one download of 40 to 70 MB).

    A cached image is used unchanged, also without a network; remove the cache folder to get a newer kernel.

    Raises:
        CapabilityError: the Debian packages are not available.
        MachineError: a package did not unpack as expected.
    """
    home = debian.cache_dir() / recipe.name
    image = home / recipe.key
    with debian.cache_lock(recipe.name):
        if not image.exists():
            package = recipe.package()
            debian.say(f"{PURPOSE}: making the machine from {package} in {home}")
            home.mkdir(exist_ok=True)
            for stale in home.iterdir():
                shutil.rmtree(stale)
            with tempfile.TemporaryDirectory(dir=home) as scratch:
                _build(recipe, package, Path(scratch))
                Path(scratch, "image").rename(image)
    return VmImage(image / "kernel", image / "initrd.cpio")


def _one(tree: Path, pattern: str) -> Path:
    found = sorted(tree.glob(pattern))
    if len(found) != 1:
        raise debian.MachineError(f"the kernel package has {len(found)} files {pattern}, expected 1")
    return found[0]


def _build(recipe: Recipe, package: str, scratch: Path) -> None:
    """Unpack kernel and busybox under ``scratch`` and leave ``scratch/image`` complete."""
    tree, root, image = scratch / "tree", scratch / "root", scratch / "image"
    for folder in (tree, root / "bin", root / "modules", image):
        folder.mkdir(parents=True)
    for name in (package, "busybox-static"):
        debian.run_tool(["dpkg-deb", "-x", str(debian.download_package(name, scratch, PURPOSE)), str(tree)])
    modules = _one(tree, recipe.folder)
    if not (modules / "modules.dep").exists():
        debian.run_tool(["depmod", "-b", str(tree), modules.name])
    order = _load_order(modules, recipe.modules)
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
    shutil.copy(_one(tree, recipe.kernel), image / "kernel")


def _load_order(folder: Path, modules: tuple[str, ...]) -> list[Path]:
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
    for name in modules:
        if name in built_in:
            continue
        if name not in needs:
            raise debian.MachineError(f"the kernel package has no module {name}")
        order += [path for path in needs[name] if path not in order]
    return [folder / path for path in order]
