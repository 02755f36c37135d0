"""A railML 3 file: its elements without their namespace, and attributes that are checked."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_bytes, refuse_unreadable

_SCHEMAS = "https://www.railml.org/schemas/"
_VERSIONS = ("3.1", "3.2", "3.3")
_NAMESPACES = tuple(_SCHEMAS + version for version in _VERSIONS)
_EXPECTED = "infrastructure in railML 3"

_Meaning = TypeVar("_Meaning")


@dataclass(frozen=True, slots=True)
class Document:
    """The root element, and the file that errors name."""

    file: Path
    root: Element

    def number(self, item: Element, key: str, named: Element | None = None) -> float:
        """A finite number of an attribute that is there.

        :param named: the element that errors name, if it is not the one that has the attribute.
        :raises InputError: it is missing or no number.
        """
        text = item.get(key)
        where = f"{label(item if named is None else named)} {key}"
        if text is None:
            raise InputError(self.file, where, Words(), "a number")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(self.file, where, text, "a number")
        return value

    def choice(
        self,
        item: Element,
        key: str,
        meanings: Mapping[str, _Meaning],
        *,
        absent: _Meaning | None = None,
        named: Element | None = None,
    ) -> _Meaning:
        """The meaning of an attribute that has one of some words.

        :param absent: the meaning if there is no such attribute; None if it is required.
        :param named: as in :meth:`number`.
        :raises InputError: it is another word, or missing.
        """
        word = item.get(key)
        if word is None and absent is not None:
            return absent
        if word is None or word not in meanings:
            where = f"{label(item if named is None else named)} {key}"
            raise InputError(self.file, where, Words() if word is None else word, f"one of {', '.join(meanings)}")
        return meanings[word]

    def by_id(self, items: Iterable[Element]) -> dict[str, Element]:
        """Elements by their id. Raises :class:`InputError` for one without an id, and for an id that stands twice."""
        found: dict[str, Element] = {}
        for item in items:
            name = item.get("id")
            if not name:
                raise InputError(self.file, f"{item.tag} id", Words(), "an id of its own")
            if name in found:
                raise InputError(self.file, f"{item.tag} id", Words(f"{name} stands twice"), "an id of its own")
            found[name] = item
        return found


def read_railml(file: Path) -> Document:
    """The document; a document type (and so every entity of its own) is refused.

    :raises InputError: it is no XML, or not railML 3.1 to 3.3.
    """
    with refuse_unreadable(file, _EXPECTED):
        content = given_bytes(file)
    builder = TreeBuilder()
    parser = expat.ParserCreate(namespace_separator=" ")

    def refuse_type(name: str, *_: object) -> None:
        raise InputError(file, f"<!DOCTYPE {name}>", Words("has a document type"), f"{_EXPECTED} without one")

    parser.StartDoctypeDeclHandler = refuse_type
    parser.StartElementHandler = lambda name, attributes: builder.start(_local(name), attributes)
    parser.EndElementHandler = lambda name: builder.end(_local(name))
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, LookupError, ValueError) as error:
        # A LookupError is an encoding that Python does not know, a ValueError one that the parser cannot use.
        raise InputError(file, "", Words("is no XML"), _EXPECTED, str(error)) from None
    root = builder.close()
    if root.tag != "railML":
        namespace, _, name = root.tag.rpartition(" ")
        found = Words(f"begins with <{name}> of {namespace or 'no namespace'}")
        raise InputError(file, "", found, f"{_EXPECTED}: <railML> of {_SCHEMAS}{', '.join(_VERSIONS)}")
    return Document(file, root)


def _local(name: str) -> str:
    """Name of an element of railML 3 without its namespace, any other as it is.

    An element without a namespace is none of railML: its name gets a space before it.
    """
    namespace, _, local = name.rpartition(" ")
    if namespace in _NAMESPACES:
        return local
    return name if namespace else f" {name}"


def label(item: Element) -> str:
    """How errors name an element."""
    return f"{item.tag} {item.get('id', '')}".rstrip()
