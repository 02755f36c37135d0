"""A controller in a folder: C and C++ files of the user (``railhil new c-controller``), or an export (``export-c``).

It is built for the scenario of the run, and runs as the program ``NAME_node pipe`` in a process of its own. Only copies
of the files whose hashes the certificate has take part in the build.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field

from railhil.bus.frame import Frame
from railhil.common.errors import InputError, Words
from railhil.common.python_process import end_group
from railhil.common.user_files import given_bytes, given_text, hold_alone, refuse_unreadable, refuse_unwritable
from railhil.controller_node.arithmetic import make
from railhil.controller_node.foreign import OutsideController
from railhil.controller_node.laws import law_class
from railhil.controller_node.pipe import ControllerFailed, Pipe
from railhil.controller_node.program.model import identifier
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.tomlfile import parse_toml
from railhil.scenarios.validation import validate

TABLE = "controller.toml"
#: Folder of the C around the functions of a user, and that of everything that is made of a folder.
AROUND, BUILD = "railhil", "build"
#: Files that take part in a build: their suffixes, and their names.
_SUFFIXES = frozenset((".c", ".h", ".cc", ".hh", ".cpp", ".hpp", ".cxx", ".hxx", ".inc", ".s", ".S", ".mk", ".a"))
_NAMES = frozenset(("Makefile", "makefile", "GNUmakefile", TABLE))
_BUILD_S = 300.0
_END_S = 5.0
_LETTERS_MAX = 200
#: What a linker and a compiler say of a failed build, the causes first.
_CAUSES = ("region .* overflowed .*", "undefined reference to .*", ".*error: .*", ".*not found.*", ".+")
#: Variables of the environment that a build sees: where its programs are, and those that change its result.
_PLACES = ("PATH", "HOME", "TMPDIR")
_OF_BUILD = ("CC", "CXX", "CFLAGS", "CXXFLAGS", "LDLIBS")


class ControllerTable(BaseModel):
    """``controller.toml``.

    :param kind: ``c-controller``: functions of a user, the C around them is made for each scenario. ``export``: all of
        the C is in the folder, for one scenario.
    :param arithmetic, label: of the handshake of an export.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["c-controller", "export"]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.+-]{0,79}$")]
    system: str
    arithmetic: Literal["iq", "float32"] = "float32"
    label: str = ""


class ControllerFolder(OutsideController):
    """``FOLDER/`` with ``controller.toml``."""

    form: ClassVar[str] = "FOLDER/ with controller.toml"
    may_be_foreign: ClassVar[bool] = True

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.folder = Path(text)
        file = self.folder / TABLE
        with refuse_unreadable(file, "controller.toml of a folder by railhil new c-controller, or by railhil export-c"):
            content = parse_toml(given_text(file))
        self.table = validate(ControllerTable, content, lambda keys: file)
        self.name, self.arithmetic = self.table.name, self.table.arithmetic
        self.law = self.name if self.table.kind == "export" else ""

    @classmethod
    def reads(cls, text: str) -> bool:
        return Path(text).is_dir()

    def files(self) -> tuple[Path, ...]:
        """Those that take part in a build, but not those that railhil makes for each scenario."""
        made = {BUILD, AROUND} if self.table.kind == "c-controller" else {BUILD}
        found = []
        for place, folders, names in os.walk(self.folder):
            above = Path(place)
            folders[:] = [name for name in folders if name[0] != "." and (above != self.folder or name not in made)]
            found += [above / name for name in names if name in _NAMES or Path(name).suffix in _SUFFIXES]
        return tuple(sorted(found))

    @property
    def label(self) -> str:
        """That of an export; otherwise the name alone, so that a program that the user has built can be asked for."""
        return self.table.label or self.name

    def as_json(self) -> dict[str, Any]:
        return {**super().as_json(), "compiler": compiler_version()}

    def sources(self, scenario: AnyScenario, law: LawSpec) -> dict[str, bytes]:
        """All files of the build, by their paths in the folder.

        :raises InputError: a file cannot be read, or the folder is for another system.
        """
        system = scenario.installed_system
        if self.table.system != system.name:
            raise InputError(
                self.folder / TABLE, "system", self.table.system, f"{system.name}, that of {scenario.name}"
            )
        contents = {path: given_bytes(path) for path in self.files()}
        if {str(path): hashlib.sha256(content).hexdigest() for path, content in contents.items()} != self.hashes():
            raise InputError(
                self.folder, "sha256", Words("its files have changed since it was named"), "the same files"
            )
        found = {path.relative_to(self.folder).as_posix(): content for path, content in contents.items()}
        if self.table.kind == "c-controller":
            # An export or a run of a law does not need it.
            from railhil.controller_node.c_controller.around import given_files

            terms = law_class(law, scenario)(make(self.arithmetic), scenario).terms
            around = given_files(scenario, law, terms)
            found |= {f"{AROUND}/{name}": text.encode("ascii") for name, text in around.items()}
        return found

    def prepare(self, scenario: AnyScenario, run: RunSpec) -> None:
        program = self._build(self.sources(scenario, run.law))
        self.findings["program_sha256"] = hashlib.sha256(program.read_bytes()).hexdigest()

    def start(self, scenario: AnyScenario, run: RunSpec) -> HostProgram:
        program = self._build(self.sources(scenario, run.law))
        # The bus administrator must not lose patience first.
        return HostProgram(self.text, program, run.patience_s / 2)

    def _build(self, sources: Mapping[str, bytes]) -> Path:
        """The program for this host, built in ``build/host-DIGEST`` unless it is there already."""
        digest = hashlib.sha256(json.dumps([compiler_version(), _variables(_OF_BUILD)]).encode())
        for name, content in sources.items():
            digest.update(b"\0".join((name.encode(), hashlib.sha256(content).digest())))
        program = f"{identifier(self.name).lower()}_node"
        place = self.folder / BUILD / f"host-{digest.hexdigest()[:12]}" / program
        with refuse_unwritable("--controller", place, "folder"), hold_alone(self.folder):
            if not place.is_file():
                with tempfile.TemporaryDirectory(prefix=".railhil-build-", dir=self.folder) as draft:
                    write_sources(Path(draft), sources)
                    made = self._make(Path(draft), program)
                    place.parent.mkdir(parents=True, exist_ok=True)
                    os.replace(made, place)
        return place

    def _make(self, folder: Path, program: str) -> Path:
        """Build the program with the folder's own Makefile; returns where it is."""
        make_says(folder, self.text, "node")
        for found in (folder / program, folder / BUILD / program):
            if found.is_file():
                return found
        raise InputError(self.text, "make", Words(f"made no {program}"), "the Makefile as it was written")


def make_says(folder: Path, text: str, target: str) -> str:
    """Make a target of the folder's own Makefile; returns what it prints.

    :param text: of the controller, for errors.
    :raises InputError: it fails.
    """
    environment = {**_variables((*_PLACES, *_OF_BUILD)), "LC_ALL": "C"}
    try:
        making = subprocess.Popen(
            ["make", "-s", target],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            env=environment,
            start_new_session=True,
        )
    except FileNotFoundError:
        raise InputError(text, "make", Words("is not installed"), "the Debian packages make and gcc") from None
    try:
        said, errors = making.communicate(timeout=_BUILD_S)
    except subprocess.TimeoutExpired:
        raise InputError(text, "make", Words(f"takes longer than {_BUILD_S:g} s"), "a build") from None
    finally:
        # Its compilers, too, also where this command is stopped.
        end_group(making)
    if making.returncode:
        raise InputError(text, "make", Words(first_error(errors, folder)), "files that compile and link")
    return said


def _variables(names: Sequence[str]) -> dict[str, str]:
    """Variables of the environment; an empty one is as good as none."""
    return {name: value for name in names if (value := os.environ.get(name))}


def write_sources(folder: Path, sources: Mapping[str, bytes]) -> None:
    """Write the files of a build."""
    for name, content in sources.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def compiler_version() -> str:
    """First line of what the compiler of the host says of itself.

    :raises InputError: there is none.
    """
    name = _variables(("CC",)).get("CC", "gcc").split()[0]
    path = shutil.which(name)
    if path is None:
        raise InputError(
            "--controller", "compiler", Words(f"{name} is not installed"), "the Debian packages gcc and make"
        )
    said = subprocess.run([path, "--version"], capture_output=True, text=True, check=False, errors="replace").stdout
    return said.partition("\n")[0].strip()


def first_error(said: str, folder: Path) -> str:
    """The line of a compiler or linker that tells why a build has failed.

    :param folder: of the build, whose place nobody knows.
    """
    for cause in _CAUSES:
        if found := re.search(cause, said):
            return found[0].strip().replace(f"{folder}/", "")[:_LETTERS_MAX]
    return "fails without a word"


class HostProgram:
    """A program of this host at the end of two streams, see :class:`railhil.controller_node.foreign.Outside`.

    :param text: of the controller, for errors.
    :param patience_s: wall time for one answer.
    :raises InputError: it cannot be started.
    """

    def __init__(self, text: str, program: Path, patience_s: float) -> None:
        self._text = text
        try:
            # It ends with this process. What the user's code prints goes to the standard error.
            self._process = subprocess.Popen(
                [program.resolve(), "pipe"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0,
                start_new_session=True,
            )  # fmt: skip
        except OSError as error:
            raise InputError(program, "", Words(f"cannot be started: {error.strerror}"), "a program") from None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._pipe = Pipe(text, self._process.stdout.fileno(), self._process.stdin.fileno(), patience_s)

    def exchange(self, frames: Sequence[Frame]) -> Sequence[Frame]:
        try:
            return self._pipe.exchange(frames).frames
        except ControllerFailed as error:
            raise self._describe(error) from None

    def _describe(self, error: ControllerFailed) -> InputError:
        """The error, for a program that was ended by a signal with its name."""
        try:
            code = self._process.wait(_END_S if error.has_ended else 0.0)
        except subprocess.TimeoutExpired:
            code = 0
        self.close()
        if code < 0:
            name = signal.Signals(-code).name
            return InputError(self._text, "", Words(f"its program was ended by {name}"), "an answer")
        return error

    def figures(self) -> None:
        """Nothing is measured."""

    def close(self) -> None:
        """End the program, and those that it has started."""
        end_group(self._process)
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
