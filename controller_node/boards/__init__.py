"""Boards: start, linker script and drivers for one processor each, and the emulator that runs them.

A board is a folder with ``board.toml`` (:class:`BoardTable`), its C files and its linker script, whose regions ``ROM``,
``RAM`` and ``STACK`` give the figures of an image. ``common/`` has the main loops, against ``railhil_board.h``.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.user_files import given_json, given_text, hold_alone, refuse_unreadable, refuse_unwritable
from railhil.controller_node.c_controller.folder import first_error
from railhil.scenarios.tomlfile import parse_toml
from railhil.scenarios.validation import validate

_FOLDER = Path(__file__).parent
_COMMON = _FOLDER / "common"
_FILE, _IMAGE, _FIGURES, _BUILD = "board.toml", "image.elf", "image.json", "build"
#: Options by language, in which the C around a law and the files of the boards are written.
_LANGUAGES = {".c": ("-std=c99",), ".cpp": ("-std=c++17", "-fno-exceptions", "-fno-rtti")}
_CONTROL = ("-fwrapv", "-ffp-contract=off", "-ffunction-sections", "-fdata-sections", "-Wall", "-Wextra")
_LINK = ("-nostartfiles", "-Wl,--gc-sections", "-Wl,--print-memory-usage")
_REGION = re.compile(r"^\s*(ROM|RAM|STACK):\s+(\d+) ([KMG]?)B\s+(\d+) ([KMG]?)B", re.MULTILINE)
_UNITS = {"": 1, "K": 1024, "M": 1024**2, "G": 1024**3}


class Program(BaseModel):
    """A program of the host, and the Debian packages that have it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    program: str
    packages: str
    arguments: tuple[str, ...] = ()

    def path(self, needed_by: str) -> str:
        """Where it is installed.

        :raises InputError: it is not.
        """
        found = shutil.which(self.program)
        if found is None:
            words = Words(f"{self.program} is not installed")
            raise InputError(needed_by, "", words, f"the Debian packages {self.packages}")
        return found


class BoardTable(BaseModel):
    """``board.toml``.

    :param link: ``pipe``: frames by two streams (railhil_pipe.h); ``can``: by the registers of its CAN controller.
    :param emulator: its arguments may contain the places ``{image}`` and, with CAN, ``{can}``: the interface.
    :param compiler: with the arguments of every compilation.
    :param sources: C files, relative to the board's folder.
    :param log_arguments: of the compiler, for a program with the C library's files; empty: it has none.
    :param tick_ns: of board_ticks. With ``instruction_ns``, a power of two, each instruction takes that much of the
        emulated time (``-icount``): instructions can be counted.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    title: str
    link: Literal["pipe", "can"]
    emulator: Program
    compiler: Program
    sources: tuple[str, ...]
    linker_script: str = "board.ld"
    log_arguments: tuple[str, ...] = ()
    tick_ns: int = Field(default=0, ge=0)
    instruction_ns: int = Field(default=0, ge=0)


class Image(BaseModel):
    """A program for a board.

    :param compiler: its first line about itself.
    :param rom_octets, ram_octets: code with constants, and data; ``stack_octets``: reserved for the stack.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    file: str
    sha256: str
    board: str
    compiler: str
    rom_octets: int
    ram_octets: int
    stack_octets: int


@dataclass(frozen=True, slots=True)
class Board:
    """A board that is loaded.

    :param name: of its folder.
    """

    name: str
    folder: Path
    table: BoardTable

    @classmethod
    def load(cls, text: str) -> Board:
        """A shipped board by its name or the beginning of it, ``-`` counting as ``_``; or the folder of a user's one.

        :raises InputError: there is none, or its ``board.toml`` is not one.
        """
        folder = Path(text) if "/" in text else _shipped(text)
        file = folder / _FILE
        with refuse_unreadable(file, "the board.toml of a board"):
            content = parse_toml(given_text(file))
        table = validate(BoardTable, content, lambda keys: file)
        step = table.instruction_ns
        if step & (step - 1):
            raise InputError(file, "instruction_ns", step, "a power of two")
        known = ("image", "can") if table.link == "can" else ("image",)
        for word in table.emulator.arguments:
            try:
                word.format_map(dict.fromkeys(known, ""))
            except (KeyError, ValueError):
                allowed = f"text with {' and '.join(f'{{{name}}}' for name in known)}"
                raise InputError(file, "emulator.arguments", word, allowed) from None
        for source in (*table.sources, table.linker_script):
            if not (folder / source).is_file():
                raise InputError(file, "sources", source, f"files of {folder}")
        return cls(folder.name, folder, table)

    def build(
        self,
        folder: Path,
        sources: Sequence[str],
        include: Sequence[str] = (".",),
        *,
        out: Path | None = None,
        main: str = "",
        arguments: Sequence[str] = (),
        optimisation: str = "-O2",
    ) -> Image:
        """The image of a controller, compiled in ``OUT/BOARD-DIGEST`` unless it is there already.

        :param sources: C files of the controller, relative to the folder, as are the folders ``include``.
        :param out: None: ``build`` in the folder.
        :param main: file of ``common/`` with the main loop; empty: that of the board's link.
        :param arguments: further ones for the compiler.
        :raises InputError: the compiler is missing or refuses a file, or the folder cannot be written.
        """
        path = self.table.compiler.path(f"board {self.name}")
        version = _first_line(subprocess.run([path, "--version"], capture_output=True, text=True, check=False).stdout)
        common = [_COMMON / (main or f"main_{self.table.link}.c"), _COMMON / "fault.c"]
        own = [self.folder / source for source in self.table.sources]
        headers = [_COMMON, *(folder / name for name in include)]
        script = self.folder / self.table.linker_script
        flags = [*self.table.compiler.arguments, optimisation, *_CONTROL, *arguments]
        if self.table.tick_ns:
            flags.append("-DRAILHIL_TICKS=board_ticks")
        files = [*(folder / source for source in sources), *own, *common]
        settings = [version, flags, _LINK, _LANGUAGES, list(include), list(sources), common[0].name]
        places = [self.folder, folder, *headers, script.parent, *(file.parent for file in files)]
        place = (out or folder / _BUILD) / f"{self.name}-{_digest(settings, files, places)[:12]}"
        with refuse_unwritable("--controller", place, "folder"):
            place.parent.mkdir(exist_ok=True)
            with hold_alone(place.parent):
                if not (place / _FIGURES).is_file():
                    draft = Path(tempfile.mkdtemp(prefix=".part-", dir=place.parent))
                    try:
                        figures = self._compile(path, folder, files, headers, flags, draft)
                        text = json.dumps(figures | {"board": self.name, "compiler": version}, indent=2)
                        (draft / _FIGURES).write_text(text + "\n", encoding="utf-8")
                        draft.rename(place)
                    except BaseException:
                        shutil.rmtree(draft, ignore_errors=True)
                        raise
        table = given_json(place / _FIGURES, "figures of an image") | {"file": str(place / _IMAGE)}
        return validate(Image, table, lambda keys: place / _FIGURES)

    def build_log(self, folder: Path, name: str, optimisation: str = "-O2") -> Image:
        """The image of an export's host program (``NAME_run check``), for a board with ``log_arguments``; otherwise as
        :meth:`build`.

        :param name: of the law in C.
        """
        arguments = self.table.log_arguments
        return self.build(folder, (f"{name}.c",), main="main_log.c", arguments=arguments, optimisation=optimisation)

    def _compile(
        self,
        compiler: str,
        folder: Path,
        files: Sequence[Path],
        headers: Sequence[Path],
        flags: Sequence[str],
        out: Path,
    ) -> dict[str, object]:
        """Compile and link into ``out``; the image depends on no path. Returns hash and sizes."""

        def call(*words: str) -> str:
            done = subprocess.run(
                [compiler, *flags, *words],
                cwd=out,
                capture_output=True,
                text=True,
                check=False,
                env=_plain_environment(),
            )
            if done.returncode:
                said = Words(first_error(done.stderr, folder.resolve()))
                expected = "files that it compiles and links without an operating system"
                raise InputError(f"board {self.name}", Path(compiler).name, said, expected)
            return done.stdout

        places = [f"-I{place.resolve()}" for place in headers]
        objects = []
        for number, file in enumerate(files):
            language = _LANGUAGES.get(file.suffix, ())
            objects.append(f"{number}.o")
            call(*language, *places, "-c", "-o", objects[-1], str(file.resolve()))
        script = (self.folder / self.table.linker_script).resolve()
        said = call(*_LINK, "-T", str(script), "-o", _IMAGE, *objects, "-lm")
        for name in objects:
            (out / name).unlink()
        sizes = {name: (int(n) * _UNITS[u], int(m) * _UNITS[v]) for name, n, u, m, v in _REGION.findall(said)}
        if len(sizes) < 3:
            raise InputError(script, "MEMORY", sorted(sizes), "the regions ROM, RAM and STACK")
        sha256 = hashlib.sha256((out / _IMAGE).read_bytes()).hexdigest()
        rom, ram, stack = sizes["ROM"][0], sizes["RAM"][0], sizes["STACK"][1]
        return {"sha256": sha256, "rom_octets": rom, "ram_octets": ram, "stack_octets": stack}


def shipped_boards() -> list[str]:
    """Names of the boards that come with railhil."""
    return sorted(file.parent.name for file in _FOLDER.glob(f"*/{_FILE}"))


def _shipped(text: str) -> Path:
    names = shipped_boards()
    wanted = text.replace("-", "_")
    found = [name for name in names if name == wanted] or [name for name in names if name.startswith(wanted)]
    if not wanted or len(found) != 1:
        allowed = f"{', '.join(names)}, or the folder of a board, such as ./myboard"
        raise InputError("command line", "board", text, allowed, did_you_mean(wanted, names))
    return _FOLDER / found[0]


def _digest(settings: Sequence[object], files: Sequence[Path], places: Sequence[Path]) -> str:
    """SHA-256 of all that can take part in a compilation: settings, files to compile, and the files of the places with
    their paths there, except what is hidden and what was built."""
    digest = hashlib.sha256(json.dumps(settings).encode())
    read = [(file, file.name) for file in files]
    for place in dict.fromkeys(places):
        for path in sorted(place.rglob("*")):
            parts = path.relative_to(place).parts
            if path.is_file() and not any(part == _BUILD or part[0] == "." for part in parts):
                read.append((path, "/".join(parts)))
    for path, name in read:
        with refuse_unreadable(path, "a file of the controller"):
            digest.update(name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _plain_environment() -> dict[str, str]:
    """Without the translations of the compiler's messages."""
    return {**os.environ, "LC_ALL": "C"}


def _first_line(text: str) -> str:
    return text.partition("\n")[0].strip()


def figures_of(image: Image) -> dict[str, object]:
    """For documents: the image without its place."""
    return image.model_dump(exclude={"file"})
