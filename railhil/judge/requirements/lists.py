"""Lists of requirements of other tools in ReqIF (OMG, 1.2), by the library reqif: which requirements there are, those
with a sentence of ours, and the results back into a copy of the list.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from railhil.common.errors import InputError, Words
from railhil.common.extras import need
from railhil.common.user_files import given_text, refuse_unreadable, whole_file

if TYPE_CHECKING:
    from railhil.judge.requirements.outcome import Outcome

#: Attribute of a requirement with a sentence of :mod:`railhil.judge.requirements`, and those with the results.
SAYS, VERDICT, EVIDENCE = "RAILHIL_SAYS", "RAILHIL_VERDICT", "RAILHIL_EVIDENCE"
#: Names of attributes in order of preference: those of the ReqIF Implementation Guide, of StrictDoc, of DOORS.
_IDS = ("ReqIF.ForeignID", "UID", "ID", "Object Identifier")
_TEXTS = ("ReqIF.Text", "STATEMENT", "Object Text", "Text", "Description")
_TITLES = ("ReqIF.Name", "ReqIF.ChapterName", "TITLE", "Object Heading", "Name")
_STRING = "railhil-string"


@dataclass(frozen=True, slots=True)
class Listed:
    """A requirement of a list; ``says``: its sentence, empty if it has none."""

    id: str
    text: str
    title: str = ""
    says: str = ""


@dataclass(frozen=True, slots=True)
class Result:
    """What is written back: a word such as PASSED or kept, and a line that says how it was found."""

    verdict: str
    evidence: str


def is_list(word: str | Path) -> bool:
    """Whether a file of requirements is a list of another tool, by its suffix."""
    return Path(word).suffix.lower() == ".reqif"


def read_list(path: Path) -> tuple[Listed, ...]:
    """The requirements of a list, in its order: whatever has an id and a text; headings have no text.

    :raises InputError: it cannot be read, has no requirement, or an id twice; the library is not installed.
    """
    return _opened(path).listed


def write_results(source: Path, results: Mapping[str, Result], out: Path) -> None:
    """Write a copy of a list that has the results in the attributes :data:`VERDICT` and :data:`EVIDENCE`; those of an
    earlier copy are replaced, or taken out.

    :raises InputError: as :func:`read_list`.
    :raises OSError: the copy cannot be written.
    """
    try:
        copy = _opened(source).with_results(results)
    except ValueError as error:
        raise InputError(source, "", Words("cannot be written"), str(error)) from None
    with whole_file(out) as draft:
        draft.write_text(copy, encoding="utf-8", newline="\n")


def result_of(outcome: Outcome, run: str) -> Result:
    """The result of a requirement in one run, which is named by ``run``."""
    margin = "" if outcome.margin is None else f"margin {outcome.margin:.4g} {outcome.unit}".rstrip()
    instant = "" if outcome.instant_s is None else f"at {outcome.instant_s:.2f} s"
    return Result(outcome.verdict, ", ".join(filter(None, (f"{margin} {instant}".strip(), run))))


def _opened(path: Path) -> _ReqIf:
    """The list in a file, checked; errors as :func:`read_list`."""
    allowed = "a ReqIF file"
    with refuse_unreadable(path, allowed):
        text = given_text(path)
    parser = _library("parser").ReqIFParser
    try:
        parsed = parser.parse_from_string(text)
    except Exception as error:
        # The library checks files by assertions and look-ups, too.
        said = str(error).splitlines() or [type(error).__name__]
        raise InputError(path, "", Words("cannot be read"), allowed, said[0]) from None
    document = _ReqIf(parsed)
    if not document.listed:
        raise InputError(path, "", Words("has no requirement"), "at least one with an id and a text")
    times = Counter(one.id for one in document.listed)
    if (twice := times.most_common(1)[0])[1] > 1:
        raise InputError(path, "id", twice[0], "an id that no other requirement has")
    return document


def _library(module: str) -> ModuleType:
    return need(f"reqif.{module}", "requirements", command="requirements in ReqIF")


class _ReqIf:
    """A list in ReqIF. What the library does not keep (tool extensions) is not in the copy."""

    def __init__(self, bundle: Any) -> None:
        self._bundle = bundle
        self._content: Any = getattr(bundle.core_content, "req_if_content", None)
        kinds = getattr(self._content, "spec_types", None) or ()
        self._types = {one.identifier: one for one in kinds if hasattr(one, "attribute_map")}
        self._objects: dict[str, Any] = {}
        self.listed = tuple(filter(None, map(self._listed, getattr(self._content, "spec_objects", None) or ())))

    def _listed(self, thing: Any) -> Listed | None:
        """A SPEC-OBJECT as a requirement; None: it has no id or no text."""
        names = self._names(thing)
        values = {names[one.definition_ref]: _text(one) for one in thing.attributes if one.definition_ref in names}

        def first(wanted: Sequence[str]) -> str:
            return next((values[name] for name in wanted if values.get(name)), "")

        name, text = first(_IDS), first(_TEXTS)
        if not (name and text):
            return None
        self._objects[name] = thing
        return Listed(name, text, first(_TITLES), values.get(SAYS, ""))

    def _names(self, thing: Any) -> dict[str, str]:
        """Identifier of a definition -> name of the attribute, for those that an object may have."""
        kind = self._types.get(thing.spec_object_type)
        definitions = () if kind is None else kind.attribute_definitions or ()
        return {one.identifier: one.long_name or one.identifier for one in definitions}

    def with_results(self, results: Mapping[str, Result]) -> str:
        """The text of the copy; raises ValueError for attributes of another type."""
        objects = _library("models.reqif_spec_object")
        string = _library("models.reqif_types").SpecObjectAttributeType.STRING
        for name, thing in self._objects.items():
            result = results.get(name)
            own = {VERDICT: result.verdict if result else "", EVIDENCE: result.evidence if result else ""}
            references = {key: self._definition(thing, key, string) for key in own}
            thing.attributes = [one for one in thing.attributes if one.definition_ref not in references.values()]
            thing.attributes += [
                objects.SpecObjectAttribute(string, references[key], value) for key, value in own.items() if value
            ]
        return str(_library("unparser").ReqIFUnparser.unparse(self._bundle))

    def _definition(self, thing: Any, key: str, string: Any) -> str:
        """Identifier of the definition of an attribute for the type of an object; made if there is none."""
        kind = self._types[thing.spec_object_type]
        for known in kind.attribute_definitions or ():
            if known.long_name == key:
                if known.attribute_type != string:
                    raise ValueError(f"{key} of the type string, or no such attribute")
                return str(known.identifier)
        types = _library("models.reqif_data_type")
        now = datetime.now(UTC).isoformat(timespec="seconds")
        self._content.data_types = self._content.data_types or []
        if not any(one.identifier == _STRING for one in self._content.data_types):
            made = types.ReqIFDataTypeDefinitionString(
                _STRING, last_change=now, long_name="railhil", max_length="32000"
            )
            self._content.data_types.append(made)
        definition = _library("models.reqif_spec_object_type").SpecAttributeDefinition(
            string, f"{kind.identifier}-{key}", _STRING, last_change=now, long_name=key
        )
        kind.attribute_definitions = [*(kind.attribute_definitions or ()), definition]
        return f"{kind.identifier}-{key}"


def _text(attribute: Any) -> str:
    """The value of an attribute as text, without the marks of XHTML."""
    node = None if attribute.xml_node is None else attribute.xml_node.find("THE-VALUE")
    value = attribute.value if node is None else "".join(node.itertext())
    return " ".join(str(value).split()) if isinstance(value, str) else ""
