"""What the kinds of test machine have in common: what is booted, and the command line that boots it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from railhil.machines.vm_image import Recipe, VmImage


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
        said: what it is, in a message.
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
