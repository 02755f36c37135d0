"""The controller that the user brings instead of an installed law, as named on a command line or in a call."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from railhil.common.errors import InputError, OptionError, Sentence
from railhil.common.plug_ins import entries
from railhil.common.user_files import open_given, refuse_unreadable
from railhil.scenarios.plant_fmu import PlantFmu, check_recorded_fmu

if TYPE_CHECKING:
    from railhil.scenarios.model import AnyScenario
    from railhil.scenarios.run_spec import RunSpec

OPTION = "--controller"
#: The same for an FMU, and for the file with the names of its variables.
FMU_OPTION, FMU_MAP_OPTION = "--controller-fmu", "--controller-fmu-map"
#: Key of the certificate.
KEY = "given_controller"
#: File of a run folder: what was measured on the board that was the controller.
TARGET = "target.json"
#: Entry point group of the kinds.
GROUP = "railhil.controllers"
#: Largest file.
_BYTES_MAX = 500_000_000
#: Texts of :meth:`GivenController.as_json` that a record needs.
_RECORDED = ("form", "text", "label", "sha256")
#: Whether two equal runs gave the same (None: unknown), and the reason if not.
FINDINGS = ("deterministic", "deterministic_why")
#: No law has one of these in its name.
_MARKS = frozenset("./:")


class GivenController(ABC):
    """A controller that the user brings. A kind is a subclass, registered in the entry point group :data:`GROUP`.

    It is code: only a command line or a call names one. No scenario, file of a run or certificate can make a command
    load it.

    :param text: as on the command line.
    :raises InputError: it names no such controller.
    """

    #: Form of the text, for help and errors.
    form: ClassVar[str]
    #: Arithmetic in which it computes, as the handshake and every table state it.
    arithmetic: str = "float64"
    #: Whether it computes in the process that names it, and nowhere else.
    is_here_only: ClassVar[bool] = False
    #: Whether it may be the controller of a run that another program starts (``--no-controller``).
    may_be_foreign: ClassVar[bool] = False
    #: Name of the installed law of which it is an export; empty: of none.
    law: str = ""
    #: Name in folders and tables, of letters, digits, ``_``, ``.``, ``+`` and ``-``.
    name: str

    def __init__(self, text: str) -> None:
        self.text = text
        self._hashes: dict[str, str] | None = None
        #: What :meth:`check` found, for the certificate: keys of :data:`FINDINGS`.
        self.findings: dict[str, Any] = {}

    @classmethod
    @abstractmethod
    def reads(cls, text: str) -> bool:
        """Whether a text has the form of this kind."""

    @abstractmethod
    def files(self) -> tuple[Path, ...]:
        """The files of which it is made."""

    def prepare(self, scenario: AnyScenario, run: RunSpec) -> None:  # noqa: B027
        """Do what takes time before the nodes of a run are started: build it.

        :raises InputError: as :meth:`make_node`.
        """

    @abstractmethod
    def make_node(self, scenario: AnyScenario, run: RunSpec, *, fd: bool, bit_rate: int | None) -> Any:
        """The controller of a run, a :class:`railhil.controller_node.controller.AnyController`.

        :raises InputError: it cannot be loaded, built or started, or does not fit the system of the scenario.
        """

    def check(self, scenario: AnyScenario, run: RunSpec) -> str:
        """Check it before a run, for :attr:`findings`; returns a note on them, or nothing.

        :raises InputError: as :meth:`make_node`.
        """
        return ""

    @property
    def label(self) -> str:
        """Name in the handshake: with the digest of its files."""
        return f"{self.name}@{self.digest[:8]}"

    @property
    def digest(self) -> str:
        """SHA-256 over the contents of its files, in their order, and over its name.

        :raises InputError: a file cannot be read.
        """
        return _digest(self.name, self.hashes())

    def hashes(self) -> dict[str, str]:
        """SHA-256 of each file, as it was when it was named: a file may be saved again during a run.

        :raises InputError: one cannot be read.
        """
        if self._hashes is None:
            self._hashes = {str(path): _sha256(path, self.form) for path in self.files()}
        return self._hashes

    @property
    def words(self) -> list[str]:
        """As words of a command line."""
        return [OPTION, self.text]

    def as_json(self) -> dict[str, Any]:
        """For the certificate.

        :raises InputError: a file cannot be read.
        """
        hashes = self.hashes()
        found = {"form": self.form, "text": self.text, "label": self.label, "sha256": self.digest, "files": hashes}
        return {**found, **self.findings}


def is_law_name(text: str) -> bool:
    """Whether a text of ``--controller`` names a law; if not, it names code."""
    return _MARKS.isdisjoint(text)


def given_controller(text: str) -> GivenController | None:
    """The controller that a text of ``--controller`` names; None: the text is the name of a law.

    :raises InputError: it is neither, or the controller cannot be read.
    """
    if is_law_name(text):
        return None
    kinds: list[type[GivenController]] = [entry.load() for entry in entries(GROUP).values()]
    for kind in kinds:
        if kind.reads(text):
            found = kind(text)
            found.hashes()
            return found
    raise InputError("command line", OPTION, text, f"a law, or {', '.join(kind.form for kind in kinds)}")


def identity_of(given: GivenController) -> dict[str, Any]:
    """Form and files of a controller in the identity of a study, the latter without their places."""
    known = given.as_json()
    return {"form": known["form"], "files": {str(n): sha256 for n, sha256 in enumerate(known["files"].values())}}


def named_controller(text: str, code: Mapping[str, GivenController], kind: str, option: str) -> GivenController:
    """The controller of a study by the text in its request.

    :param code: those that the command line or a call names.
    :param kind: of study, and ``option``: with which the controller is named.
    :raises InputError: it is not among them: only the request, as in a file, has its text.
    """
    if text not in code:
        allowed = f"{option} on the command line: a controller is code, which no file can load"
        raise InputError(kind, option.removeprefix("--"), text, allowed)
    return code[text]


class RecordedController(GivenController):
    """The controller of a recorded run, of which only the certificate is at hand: it is judged, but not run again.

    :param file: named in errors.
    :raises InputError: the certificate does not describe one.
    """

    form: ClassVar[str] = "recorded"

    def __init__(self, document: Mapping[str, Any], file: str | Path) -> None:
        recorded = document[KEY]
        if not (isinstance(recorded, Mapping) and all(isinstance(recorded.get(key), str) for key in _RECORDED)):
            raise InputError(file, KEY, recorded, f"a table with {', '.join(_RECORDED)}")
        super().__init__(recorded["text"])
        self.name, self.arithmetic = str(document.get("controller")), str(document.get("arithmetic"))
        files = recorded.get("files")
        if not (isinstance(files, Mapping) and all(isinstance(one, str) for one in files.values())):
            raise InputError(file, f"{KEY}.files", files, "the SHA-256 of each file by its name")
        if recorded["sha256"] != (wanted := _digest(self.name, files)):
            raise InputError(file, f"{KEY}.sha256", recorded["sha256"], f"{wanted}, that of name and files")
        digest = recorded["label"].partition("@")[2]
        if digest and not wanted.startswith(digest):
            raise InputError(file, f"{KEY}.label", recorded["label"], f"{self.name}@{wanted[:8]}")
        self._recorded, self._file = dict(recorded), file

    @classmethod
    def of_identity(cls, text: str, entry: Mapping[str, Any], arithmetic: str, file: str | Path) -> RecordedController:
        """The controller of a study, from its manifest.

        :param entry: of its identity: ``law``, ``label``, ``law_sha256``, and :func:`identity_of`.
        :raises InputError: it does not describe one.
        """
        recorded = {
            "text": text,
            "sha256": entry["law_sha256"],
            **{key: entry[key] for key in ("form", "label", "files")},
        }
        return cls({KEY: recorded, "controller": entry["law"], "arithmetic": arithmetic}, file)

    @classmethod
    def reads(cls, text: str) -> bool:
        return False

    def files(self) -> tuple[Path, ...]:
        """None at hand."""
        return ()

    @property
    def label(self) -> str:
        return str(self._recorded["label"])

    @property
    def digest(self) -> str:
        return str(self._recorded["sha256"])

    def as_json(self) -> dict[str, Any]:
        return self._recorded

    def check_same(self, given: GivenController) -> None:
        """Refuse another controller.

        :raises InputError: its files have other contents.
        """
        now, was = given.as_json(), self._recorded.get("files")
        for key in ("form", "board"):
            if now.get(key) != self._recorded.get(key):
                allowed = f"{self.text}, as in {self._file}"
                raise InputError("command line", OPTION, given.text, allowed)
        if self._recorded["sha256"] == now["sha256"]:
            given.findings = {key: self._recorded[key] for key in FINDINGS if key in self._recorded}
            return
        for name, before in zip(now["files"], was.values() if isinstance(was, Mapping) else (), strict=False):
            if now["files"][name] != before:
                raise InputError(name, "sha256", now["files"][name], f"{before}, as in {self._file}")
        raise InputError("command line", OPTION, given.text, f"{self.text}, as in {self._file}")

    def refuse(self) -> InputError:
        """The error for an attempt to make the run without its controller."""
        allowed = (
            f"{OPTION} on the command line, or controller= in a call: a controller is code, which no file can load"
        )
        return InputError(self._file, KEY, self.text, allowed)

    def make_node(self, scenario: AnyScenario, run: RunSpec, *, fd: bool, bit_rate: int | None) -> Any:
        raise self.refuse()


class NamedCode(NamedTuple):
    """Code that a command line names for a run."""

    plant_fmu: PlantFmu | None = None
    controller: GivenController | None = None

    def check_recorded(self, document: Mapping[str, Any], file: str | Path) -> NamedCode:
        """The code with which the run of a document is made again.

        A controller that the command line does not name is a :class:`RecordedController`.

        :raises InputError: the run had other code, or none, or the command line does not name its FMU.
        """
        fmu = check_recorded_fmu(document, file, self.plant_fmu)
        given = self.controller
        recorded = RecordedController(document, file) if document.get(KEY) else None
        if given is None:
            return NamedCode(fmu, recorded)
        if recorded is None:
            raise OptionError(OPTION, f"cannot be given: the run of {file} had a law")
        if given is not recorded:
            recorded.check_same(given)
        return NamedCode(fmu, given)


NO_CODE = NamedCode()


def refuse_beside(given: GivenController, values: Mapping[str, object], source: str | Path = "command line") -> None:
    """Refuse options of a law beside a given controller.

    :param values: value of each option by name; None: it is not given.
    :param source: where they are given.
    :raises InputError: one is given.
    """
    for option, value in values.items():
        if value is not None:
            allowed = Sentence(f"cannot be given with {OPTION} {given.text}: only a law takes it")
            raise InputError(source, option, str(value), allowed)


def refuse_changed(hashes: Mapping[str, str]) -> None:
    """Refuse files with other contents than when they were named.

    :param hashes: :meth:`GivenController.hashes`.
    :raises InputError: one has changed, or cannot be read.
    """
    for name, sha256 in hashes.items():
        if (now := _sha256(Path(name), "the file that was named")) != sha256:
            raise InputError(name, "sha256", now, f"{sha256}, as when it was named")


def _digest(name: str, hashes: Mapping[str, str]) -> str:
    return hashlib.sha256("\n".join((name, *hashes.values())).encode()).hexdigest()


def _sha256(path: Path, form: str) -> str:
    with refuse_unreadable(path, form), open_given(path, _BYTES_MAX) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def given_controllers(texts: Iterable[str]) -> dict[str, GivenController]:
    """The controllers among texts of ``--controller`` or ``--laws``, by their texts; the others are names of laws.

    :raises InputError: like :func:`given_controller`.
    """
    found = {text: given_controller(text) for text in texts}
    return {text: one for text, one in found.items() if one is not None}
