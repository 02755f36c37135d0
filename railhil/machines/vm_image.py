"""The two kinds of virtual machine with CAN: kernel and initial file system, and the command line that boots them.

Both images are made once and kept in the cache. The kernel is one of Debian's own packages with CAN as modules,
unpacked and never installed; the file system is a static busybox, the modules in load order and ``vm_init.sh``.

User-mode Linux is a kernel that is a process of this host. It computes at the host's speed; its system calls, which it
sees by ptrace, take most of the time. It has one processor and needs no root.

An emulated machine (QEMU, software translation, no network card) has Debian's own kernel. It is some 25 times slower
than the host and needs nothing of it.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from railhil.common.python_process import WITH_PARENT
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
    """The parts of an image.

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
        """Changes with the contents of the image beside the kernel."""
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


_USER_MODE_PACKAGE = "user-mode-linux"
#: The kernel has helpers, processes that would outlive it. It makes a group of them, which ends with the kernel, and
#: with this process, however that ends.
_WHOLE_GROUP = '"$@" & trap "kill -KILL -$!" TERM; wait; kill -KILL -$!'
_CPU_INFO = Path("/proc/cpuinfo")
#: crc32c_generic is what libcrc32c asks for by name at load time.
_EMULATED_MODULES = (
    "crc32c_generic", "libcrc32c", "virtio_pci", "virtio_blk", "virtio_console", "ext4", "9pnet_virtio", "9p",
    *CAN_MODULES, "can_isotp",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Boot:
    """One machine.

    Attributes:
        control: folder through which the machine is told what to do.
        shares: folders that the machine may write to.
        disks: files with a file system.
        outputs: pipe ends to which the machine writes the command's output and its complaints.
    """

    image: VmImage
    control: Path
    shares: Sequence[Path]
    disks: Sequence[Path]
    memory_mb: int
    processors: int
    outputs: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Kind:
    """A way to have a kernel of one's own.

    Attributes:
        said: its name in a message.
        recipe: of its image.
        packages: commands of the host that it needs, and Debian's packages of them.
        words: the command line.
        unable: why this processor cannot have it, empty if it can.
    """

    said: str
    recipe: Recipe
    packages: Mapping[str, str]
    words: Callable[[Boot], list[str]]
    unable: Callable[[], str] = str


def too_large_for(cpu_info: str) -> str:
    """Why Debian 12's user-mode kernel cannot boot on a processor; empty if it can.

    The kernel has room for the registers of a process up to AVX-512, 2696 bytes. Tiles (AMX) make them 11 008 bytes,
    and ptrace sets all of them or none (``userspace - ptrace set fp regs failed, errno = 14``, then a panic).

    :param cpu_info: the text of ``/proc/cpuinfo``.
    """
    flags = next((line for line in cpu_info.splitlines() if line.startswith("flags")), "")
    return "a user-mode kernel cannot hold the registers of this processor (AMX)" if " amx_tile" in flags else ""


def _refuse_user_mode() -> str:
    return too_large_for(_CPU_INFO.read_text(encoding="ascii", errors="replace")) if _CPU_INFO.exists() else ""


def _user_mode_words(boot: Boot) -> list[str]:
    out, err = boot.outputs
    words = [str(boot.image.kernel), f"initrd={boot.image.initrd}", f"mem={boot.memory_mb}M", f"railhil={boot.control}"]
    # Folder of the socket of its management console.
    words += [f"uml_dir={boot.control}", "umid=uml", "quiet", "panic=-1"]
    words += ["con=null", "con0=null,fd:2", f"con1=null,fd:{out}", f"con2=null,fd:{err}"]
    words += [f"ubd{number}={disk}" for number, disk in enumerate(boot.disks)]
    return [*WITH_PARENT[:-1], "TERM", "sh", "-c", _WHOLE_GROUP, "sh", *words]


USER_MODE = Kind(
    "a user-mode kernel",
    Recipe("user_mode", lambda: _USER_MODE_PACKAGE, "usr/bin/linux.uml", "usr/lib/uml/modules/*", CAN_MODULES),
    {"setpriv": "util-linux"},
    _user_mode_words,
    _refuse_user_mode,
)


def _export(tag: str, folder: Path, options: str) -> list[str]:
    """QEMU options that make a host folder visible in the machine under ``tag`` (a comma in a path is doubled)."""
    path = str(folder).replace(",", ",,")
    return [
        "-fsdev", f"local,id={tag},path={path},security_model=none,multidevs=remap{options}",
        "-device", f"virtio-9p-pci,fsdev={tag},mount_tag={tag}",
    ]  # fmt: skip


def _emulated_words(boot: Boot) -> list[str]:
    words = [*WITH_PARENT, "qemu-system-x86_64"]
    # No KVM: inside another virtual machine it was observed to abort or hang.
    words += ["-accel", "tcg,thread=multi", "-cpu", "max"]
    words += ["-smp", str(boot.processors), "-m", str(boot.memory_mb)]
    words += ["-nodefaults", "-no-user-config", "-nographic", "-no-reboot", "-nic", "none"]
    words += ["-kernel", str(boot.image.kernel), "-initrd", str(boot.image.initrd)]
    # random.trust_cpu: an idle machine has no other source of randomness, and Python would wait for one.
    # clocksource: the emulated processors share one cycle counter, which the kernel does not trust with two processors;
    # the timer that it would use instead leaves the emulation at each reading of the clock.
    words += [
        "-append",
        "console=ttyS0 quiet panic=-1 random.trust_cpu=on mitigations=off tsc=reliable clocksource=tsc",
    ]
    words += ["-serial", f"file:{boot.control / 'console.log'}".replace(",", ",,")]
    words += ["-device", "virtio-serial-pci"]
    for number, pipe in enumerate(boot.outputs, start=1):
        words += ["-add-fd", f"fd={pipe},set={number}"]
        words += ["-chardev", f"file,id=port{number},path=/dev/fdset/{number},append=on"]
        words += ["-device", f"virtserialport,nr={number},chardev=port{number},name=railhil{number}"]
    words += _export("root", Path("/"), ",readonly=on") + _export("control", boot.control, "")
    for number, folder in enumerate(boot.shares):
        words += _export(f"share{number}", folder, "")
    for disk in boot.disks:
        words += ["-drive", f"if=virtio,format=raw,cache=unsafe,file={str(disk).replace(',', ',,')}"]
    return words


EMULATED = Kind(
    "an emulated machine, some 25 times slower",
    Recipe("vcan_vm", newest_kernel_package, "boot/vmlinuz-*", "lib/modules/*", _EMULATED_MODULES),
    {"qemu-system-x86_64": "qemu-system-x86", "depmod": "kmod", "setpriv": "util-linux"},
    _emulated_words,
)


#: By their names on the command line, the fastest first.
KINDS = {"user-mode": USER_MODE, "machine": EMULATED}
