"""Lists of requirements in the formats of other tools."""

from __future__ import annotations

from pathlib import Path

_TYPE = "ATTRIBUTE-DEFINITION-{kind}"


def _definition(kind: str, name: str) -> str:
    return (
        f'<ATTRIBUTE-DEFINITION-{kind} IDENTIFIER="d-{name}" LAST-CHANGE="2026-01-01T00:00:00Z" LONG-NAME="{name}">'
        f"<TYPE><DATATYPE-DEFINITION-{kind}-REF>t-{kind}</DATATYPE-DEFINITION-{kind}-REF></TYPE>"
        f"</ATTRIBUTE-DEFINITION-{kind}>"
    )


def _string(name: str, value: str) -> str:
    return (
        f'<ATTRIBUTE-VALUE-STRING THE-VALUE="{value}"><DEFINITION><ATTRIBUTE-DEFINITION-STRING-REF>d-{name}'
        "</ATTRIBUTE-DEFINITION-STRING-REF></DEFINITION></ATTRIBUTE-VALUE-STRING>"
    )


def _xhtml(name: str, value: str) -> str:
    return (
        f"<ATTRIBUTE-VALUE-XHTML><DEFINITION><ATTRIBUTE-DEFINITION-XHTML-REF>d-{name}</ATTRIBUTE-DEFINITION-XHTML-REF>"
        f"</DEFINITION><THE-VALUE><xhtml:div>{value}</xhtml:div></THE-VALUE></ATTRIBUTE-VALUE-XHTML>"
    )


def _thing(name: str, values: str) -> str:
    return (
        f'<SPEC-OBJECT IDENTIFIER="o-{name}" LAST-CHANGE="2026-01-01T00:00:00Z"><VALUES>{values}</VALUES>'
        "<TYPE><SPEC-OBJECT-TYPE-REF>kind</SPEC-OBJECT-TYPE-REF></TYPE></SPEC-OBJECT>"
    )


def reqif_text(rows: list[tuple[str, str, str]]) -> str:
    """A ReqIF as requirement tools export it: texts in XHTML, and a heading, which has an id and no text.

    :param rows: id, text and sentence (empty: none) of each requirement, escaped.
    """
    things = [_thing("head", _string("ReqIF.ForeignID", "H-1") + _string("ReqIF.ChapterName", "Stops"))]
    for name, text, says in rows:
        values = _string("ReqIF.ForeignID", name) + _xhtml("ReqIF.Text", text)
        things.append(_thing(name, values + (_string("RAILHIL_SAYS", says) if says else "")))
    strings = "".join(_definition("STRING", name) for name in ("ReqIF.ForeignID", "ReqIF.ChapterName", "RAILHIL_SAYS"))
    hierarchy = "".join(
        f'<SPEC-HIERARCHY IDENTIFIER="h-{name}" LAST-CHANGE="2026-01-01T00:00:00Z"><OBJECT><SPEC-OBJECT-REF>o-{name}'
        "</SPEC-OBJECT-REF></OBJECT></SPEC-HIERARCHY>"
        for name in ("head", *(name for name, *_ in rows))
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<REQ-IF xmlns="http://www.omg.org/spec/ReqIF/20110401/reqif.xsd" xmlns:xhtml="http://www.w3.org/1999/xhtml">'
        '<THE-HEADER><REQ-IF-HEADER IDENTIFIER="head"><CREATION-TIME>2026-01-01T00:00:00Z</CREATION-TIME>'
        "<REQ-IF-TOOL-ID>a tool</REQ-IF-TOOL-ID><REQ-IF-VERSION>1.0</REQ-IF-VERSION><SOURCE-TOOL-ID>a tool"
        "</SOURCE-TOOL-ID><TITLE>train</TITLE></REQ-IF-HEADER></THE-HEADER><CORE-CONTENT><REQ-IF-CONTENT><DATATYPES>"
        '<DATATYPE-DEFINITION-STRING IDENTIFIER="t-STRING" LAST-CHANGE="2026-01-01T00:00:00Z" MAX-LENGTH="9999"/>'
        '<DATATYPE-DEFINITION-XHTML IDENTIFIER="t-XHTML" LAST-CHANGE="2026-01-01T00:00:00Z"/></DATATYPES><SPEC-TYPES>'
        '<SPECIFICATION-TYPE IDENTIFIER="module" LAST-CHANGE="2026-01-01T00:00:00Z"/>'
        '<SPEC-OBJECT-TYPE IDENTIFIER="kind" LAST-CHANGE="2026-01-01T00:00:00Z"><SPEC-ATTRIBUTES>'
        f"{strings}{_definition('XHTML', 'ReqIF.Text')}</SPEC-ATTRIBUTES></SPEC-OBJECT-TYPE></SPEC-TYPES>"
        f"<SPEC-OBJECTS>{''.join(things)}</SPEC-OBJECTS><SPECIFICATIONS>"
        '<SPECIFICATION IDENTIFIER="s" LAST-CHANGE="2026-01-01T00:00:00Z"><TYPE><SPECIFICATION-TYPE-REF>module'
        f"</SPECIFICATION-TYPE-REF></TYPE><CHILDREN>{hierarchy}</CHILDREN></SPECIFICATION></SPECIFICATIONS>"
        "</REQ-IF-CONTENT></CORE-CONTENT></REQ-IF>\n"
    )


def attribute(path: Path, name: str, key: str) -> str:
    """An attribute of a requirement of a ReqIF; empty if it has none."""
    from reqif.parser import ReqIFParser

    content = ReqIFParser.parse(str(path)).core_content.req_if_content
    names = {
        one.identifier: one.long_name
        for kind in content.spec_types
        for one in getattr(kind, "attribute_definitions", None) or ()
    }
    for thing in content.spec_objects:
        values = {names[one.definition_ref]: str(one.value) for one in thing.attributes}
        if values.get("ReqIF.ForeignID") == name:
            return values.get(key, "")
    raise AssertionError(f"no requirement {name}")
