"""An emulated machine (QEMU, software translation, no network card) with Debian's own kernel: some 25 times slower than
the host, but it needs nothing of it."""

from __future__ import annotations

from pathlib import Path

from railhil.machines.vm_image import CAN_MODULES, Recipe, newest_kernel_package
from railhil.machines.vm_kind import Boot, Kind

#: crc32c_generic is what libcrc32c asks for by name at load time.
_MODULES = (
    "crc32c_generic", "libcrc32c", "virtio_pci", "virtio_blk", "virtio_console", "ext4", "9pnet_virtio", "9p",
    *CAN_MODULES, "can_isotp",
)  # fmt: skip


def _export(tag: str, folder: Path, options: str) -> list[str]:
    """QEMU options that make a host folder visible in the machine under ``tag`` (a comma in a path is doubled)."""
    path = str(folder).replace(",", ",,")
    return [
        "-fsdev", f"local,id={tag},path={path},security_model=none,multidevs=remap{options}",
        "-device", f"virtio-9p-pci,fsdev={tag},mount_tag={tag}",
    ]  # fmt: skip


def _words(boot: Boot) -> list[str]:
    # setpriv: the machine must not outlive this process, even if this process is killed.
    words = ["setpriv", "--pdeathsig", "KILL", "qemu-system-x86_64"]
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
    Recipe("vcan_vm", newest_kernel_package, "boot/vmlinuz-*", "lib/modules/*", _MODULES),
    {"qemu-system-x86_64": "qemu-system-x86", "depmod": "kmod", "setpriv": "util-linux"},
    _words,
)
