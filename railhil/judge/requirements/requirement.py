"""Requirements as data: the tables ``[[requirement]]`` and ``[define]`` of a file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from railhil.common.errors import InputError, Sentence, Words, did_you_mean
from railhil.common.user_files import given_text, refuse_unreadable
from railhil.judge.requirements.lists import SAYS, is_list, read_list
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.parser import parse_definition, parse_sentence
from railhil.judge.requirements.sentence import BoundSentence
from railhil.judge.requirements.words import FUNCTIONS, KEYWORDS, SentenceError
from railhil.record.trace import Trace
from railhil.scenarios.load import sentences
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.schema import DefineTable, RequirementRows, Table
from railhil.scenarios.system import names as system_names
from railhil.scenarios.system import system_named
from railhil.scenarios.tomlfile import parse_toml, toml_table
from railhil.scenarios.validation import validate


class RequirementsTable(Table):
    """The tables of a file of requirements, or of the part of a scenario file."""

    requirement: RequirementRows
    define: DefineTable


@dataclass(frozen=True, slots=True)
class Requirement:
    """A sentence that runs have to keep.

    ``when``: ``none``: only runs without faults have to. ``source``: where it comes from, or "chosen". ``file``: where
    it stands; the same requirement in another file is equal. ``define``: the names of its file that sentences may use,
    with their texts.
    """

    id: str
    says: str
    title: str = ""
    when: Literal["any", "none"] = "any"
    note: str = ""
    source: str = ""
    file: str = field(default="", compare=False)
    define: tuple[tuple[str, str], ...] = ()

    def bind(self, names: Names) -> BoundSentence:
        """The sentence with the names of a scenario.

        :raises InputError: the names or units do not fit; the message has the part and the column.
        """
        for name, text in self.define:
            if name in names:
                allowed = "a name that no signal, score, level and event of the run has"
                raise InputError(self.file or "requirement", f"define.{name}", text, allowed)
        try:
            return BoundSentence(self.says, names, dict(self.define))
        except SentenceError as error:
            raise self.refused(error) from None

    def refused(self, error: SentenceError) -> InputError:
        """The error of its sentence in a line."""
        return _refused(self.file or "requirement", f"requirement {self.id}", error)

    def as_json(self) -> dict[str, Any]:
        """As the tables of a file have it, with the definitions of that file and its name."""
        return {
            "id": self.id, "says": self.says, "title": self.title, "when": {"faults": self.when}, "note": self.note,
            "source": self.source, "define": dict(self.define), "file": self.file,
        }  # fmt: skip


def as_toml(requirements: Sequence[Requirement]) -> str:
    """Requirements as the tables of a file; their names of ``define`` have one meaning each."""
    define = {name: text for one in requirements for name, text in one.define}
    tables = [toml_table("define", define)] if define else []
    for one in requirements:
        texts = {"id": one.id, "says": one.says, "title": one.title, "note": one.note, "source": one.source}
        given = {key: text for key, text in texts.items() if text}
        when = {} if one.when == "any" else {"when.faults": one.when}
        tables.append(toml_table("[requirement]", given | when))
    return "".join(tables)


def _refused(file: str | Path, key: str, error: SentenceError) -> InputError:
    told = Sentence(f'"{error.text}" {error.problem}' if error.text else error.problem)
    return InputError(file, key, None, told, f"column {error.column + 1}")


def requirements_in(tables: Mapping[str, Any], file: str | Path) -> tuple[Requirement, ...]:
    """The requirements of the tables ``requirement`` and ``define``.

    :param file: where they stand, for errors.
    :raises InputError: a key is unknown or missing, an id is given twice, or a sentence is not of the language.
    """
    found = validate(RequirementsTable, dict(tables), lambda keys: file)
    for name, text in found.define.items():
        _check_definition(name, text, file)
    define, seen = tuple(found.define.items()), set[str]()
    requirements = []
    for one in found.requirement:
        if one.id in seen:
            raise InputError(file, "requirement.id", one.id, "an id that no other requirement has")
        seen.add(one.id)
        requirement = Requirement(
            one.id, one.says, one.title, one.when.faults, one.note, one.source, str(file), define
        )  # fmt: skip
        try:
            parse_sentence(one.says)
        except SentenceError as error:
            raise requirement.refused(error) from None
        requirements.append(requirement)
    return tuple(requirements)


def scenario_requirements(name: str, settings: Sequence[str] = ()) -> tuple[Requirement, ...]:
    """The requirements of a scenario's own files; none if they have no ``[[requirement]]``.

    :param name: as it is recorded in the run (:func:`railhil.scenarios.load.stable_name`).
    :raises InputError: they are wrong.
    """
    return requirements_in(sentences(name, settings), name)


def requirements_from_json(tables: Iterable[Any], file: str | Path) -> tuple[Requirement, ...]:
    """Requirements as :meth:`Requirement.as_json` gives them.

    :param file: the document that has them, for errors.
    :raises InputError: one is none.
    """
    found: list[Requirement] = []
    for table in tables:
        own = {key: value for key, value in table.items() if key not in ("define", "file")}
        place = str(table.get("file") or file)
        found += requirements_in({"requirement": [own], "define": table.get("define") or {}}, place)
    return tuple(found)


def requirements_of(spec: RunSpec, scenario: Any) -> tuple[Requirement, ...]:
    """The requirements by which a run is judged, checked against its scenario.

    :raises InputError: one does not fit.
    """
    found = requirements_from_json(spec.requirements, "requirements")
    check_requirements(found, scenario)
    return found


def named_requirements(
    words: Iterable[str | Path], known: Iterable[Requirement] = (), prose: bool = False
) -> tuple[Requirement, ...]:
    """The requirements of files or systems (:func:`read_requirements`), each once.

    :param known: requirements that do not count again.
    :raises InputError: a file cannot be read, or is wrong.
    """
    found: dict[Requirement, None] = dict.fromkeys(known)
    first = len(found)
    for word in dict.fromkeys(map(str, words)):
        found |= {one: None for one in read_requirements(word, prose) if one not in found}
    return tuple(found)[first:]


def _check_definition(name: str, text: str, file: str | Path) -> None:
    if name in KEYWORDS or name in FUNCTIONS:
        raise InputError(file, f"define.{name}", name, "a name that is no word of the language")
    try:
        parse_definition(text)
    except SentenceError as error:
        raise _refused(file, f"define.{name}", error) from None


def read_requirements(word: str | Path, prose: bool = False) -> tuple[Requirement, ...]:
    """The requirements of a file, or those that ship with an installed system; of a list of another tool
    (:mod:`railhil.judge.requirements.lists`) those with a sentence.

    :param word: path of the file, or name of the system.
    :param prose: also those of a list without a sentence, whose ``says`` is empty.
    :raises InputError: there is no such file, it is damaged, it has no requirement, or a sentence is wrong: one line
        with file, requirement and column.
    """
    path = Path(word)
    name: str | Path = path.resolve()
    if str(word) in system_names() and not path.is_file():
        path, name = shipped_requirements(str(word)), str(word)
    elif not path.exists():
        hint = did_you_mean(str(word), system_names())
        raise InputError(path, "", Words("does not exist"), "a file of requirements, or the name of a system", hint)
    if is_list(path):
        return _of_list(path, str(name), prose)
    with refuse_unreadable(path, "a TOML file of requirements"):
        tables = parse_toml(given_text(path))
    found = requirements_in(tables, name)
    if not found:
        raise InputError(path, "requirement", Words("is missing"), "at least one [[requirement]]")
    return found


def _of_list(path: Path, name: str, prose: bool) -> tuple[Requirement, ...]:
    """The requirements of a list of another tool, as :func:`read_requirements`; their texts are their notes."""
    listed = read_list(path)
    rows = [{"id": one.id, "says": one.says, "title": one.title, "note": one.text} for one in listed if one.says]
    if not rows and not prose:
        raise InputError(path, SAYS, Words("is missing"), "a sentence in this attribute of at least one requirement")
    judged = {one.id: one for one in requirements_in({"requirement": rows}, name)}
    every = [judged.get(one.id) or Requirement(one.id, "", one.title, note=one.text, file=name) for one in listed]
    return tuple(one for one in every if prose or one.says)


def shipped_requirements(system: str) -> Path:
    """The file that ships with a system.

    :raises InputError: it has none.
    """
    path = system_named(system).optional_part("requirements")
    if path is None:
        raise InputError(f"system {system}", "requirements", Words("no such part"), "a file of requirements")
    return Path(path)


def check_requirements(requirements: Iterable[Requirement], scenario: Any) -> None:
    """Check that the sentences fit a scenario: its names, units and periods, and ids that differ.

    :raises InputError: one does not; one line with file, requirement and column.
    """
    found: Sequence[Requirement] = tuple(requirements)
    if not found:
        return
    names = Names(scenario, Trace(scenario.installed_system.contract))
    seen: dict[str, Requirement] = {}
    for requirement in found:
        if requirement.id in seen and requirement != seen[requirement.id]:
            allowed = f"an id that no other requirement has; {seen[requirement.id].file} has it, too"
            raise InputError(requirement.file, "requirement.id", requirement.id, allowed)
        seen[requirement.id] = requirement
        requirement.bind(names)
