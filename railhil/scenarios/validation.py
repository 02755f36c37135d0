"""pydantic's errors as one :class:`~railhil.common.errors.InputError`: the first one that explains the others, or all
missing keys."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from railhil.common.errors import InputError, Sentence, Words, did_you_mean

M = TypeVar("M", bound=BaseModel)
Keys = tuple[str | int, ...]

#: Longer keys are shortened in messages.
_WORD_MAX = 80

#: A mistyped key makes a required one missing too, so it is reported first.
_EXPLAINS_FIRST = {"extra_forbidden": 0, "missing": 2}

_ALLOWED_BY_TYPE = {
    "missing": "a value: the key is required",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "a text",
    "bool_type": "true or false",
    "list_type": "an array",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "tuple_type": "an array of numbers",
    "int_parsing": "a whole number",
    "int_parsing_size": "a whole number of fewer digits",
    "float_parsing": "a number",
    "bool_parsing": "true or false",
    "finite_number": "a finite number",
}

#: Makes the error for a key of the scenario: (keys, found, allowed).
Refuse = Callable[[tuple[str | int, ...], object, str], InputError]


def validate(table_type: type[M], data: object, origin: Callable[[Keys], str | Path], tags: tuple[str, ...] = ()) -> M:
    """``data`` as ``table_type``; ``origin`` names the file of a key path, ``tags`` are union tags.

    Raises :class:`InputError` with the key as a dotted path, what was found and what is allowed.
    """
    try:
        found = table_type.model_validate(data)
    except ValidationError as error:
        details = sorted(error.errors(include_url=False), key=lambda one: _EXPLAINS_FIRST.get(one["type"], 1))
        missing = [_remove_tags(one["loc"], tags) for one in details if one["type"] == "missing"]
        if len(missing) == len(details) and len(missing) > 1:
            raise _describe_missing(missing, origin) from None
        raise _translate(details[0], table_type, origin, tags) from None
    for keys, value, other in _find_unused(found):
        raise InputError(origin(keys), join_keys(keys), value, Sentence(f"used only with {other}"))
    return found


def _find_unused(table: BaseModel, above: Keys = ()) -> Iterator[tuple[Keys, object, str]]:
    """Keys that are given without the key beside which alone they are used (``BESIDE`` of a table)."""
    beside: Mapping[str, str] = getattr(table, "BESIDE", {})
    for key in table.model_fields_set:
        value, keys = getattr(table, key), (*above, key)
        if key in beside and beside[key] not in table.model_fields_set:
            is_list = isinstance(value, list) and value and isinstance(value[0], BaseModel)
            yield keys, Words(f"{len(value)} of them") if is_list else value, join_keys((*above, beside[key]))
        if isinstance(value, BaseModel):
            yield from _find_unused(value, keys)


def list_errors(error: ValidationError, table_type: type[BaseModel], source: str | Path) -> dict[str, InputError]:
    """All faults of a flat document: key -> its error, in the document's order.

    :param source: the file, or another source of the keys.
    """
    return {
        join_keys(one["loc"][:1]): _translate(one, table_type, lambda keys: source, ())
        for one in error.errors(include_url=False)
    }


def _remove_tags(tagged: Keys, tags: tuple[str, ...]) -> Keys:
    return tuple(key for key in tagged if key not in tags and key != "[key]")


def _describe_missing(missing: list[Keys], origin: Callable[[Keys], str | Path]) -> InputError:
    """All keys missing in one file; if several files lack keys, the keys of the first."""
    file = origin(missing[0])
    names = [join_keys(keys) for keys in missing if origin(keys) == file]
    allowed = _ALLOWED_BY_TYPE["missing"] if len(names) == 1 else "values: the keys are required"
    return InputError(file, ", ".join(names), Words(), allowed)


def _translate(
    one: ErrorDetails,
    table_type: type[BaseModel],
    origin: Callable[[Keys], str | Path],
    tags: tuple[str, ...],
) -> InputError:
    tagged: Keys = one["loc"]
    keys = _remove_tags(tagged, tags)
    kind = one["type"]
    found: object = Words() if kind == "missing" else one["input"]
    allowed = _ALLOWED_BY_TYPE.get(kind)
    hint = None
    if kind == "extra_forbidden":
        choices = _find_fields(table_type, tagged[:-1])
        hint = did_you_mean(str(keys[-1]), choices)
        allowed = f"one of {', '.join(sorted(choices))}"
        found = Words("unknown key")
    return InputError(origin(keys), join_keys(keys), found, allowed or describe_allowed(one), hint)


def describe_allowed(one: ErrorDetails) -> str:
    """The allowed values, from one of pydantic's errors: ``at most 200``."""
    return _describe_bounds(one["type"], one.get("ctx", {})) or _remove_subject(one["msg"])


def _describe_bounds(kind: str, context: Mapping[str, Any]) -> str | None:
    """Sentences for errors whose bounds pydantic gives separately from its message."""
    if kind == "string_pattern_mismatch":
        return f"a text that matches {context['pattern']}"
    if kind in ("greater_than_equal", "less_than_equal"):
        return f"at least {context['ge']:g}" if kind.startswith("greater") else f"at most {context['le']:g}"
    if kind == "multiple_of":
        return f"a multiple of {context['multiple_of']:g}"
    if kind == "too_long":
        return f"an array of at most {context['max_length']} values"
    if kind == "too_short":
        return f"an array of at least {context['min_length']} values"
    return None


def join_keys(keys: Keys) -> str:
    """``("line", "stops", 2, "name")`` as ``line.stops[2].name``; long words of a user are shortened."""
    text = ""
    for key in keys:
        word = f"[{key}]" if isinstance(key, int) else key if len(key) <= _WORD_MAX else f"{key[:_WORD_MAX]}..."
        text += f".{word}" if text and not isinstance(key, int) else word
    return text


def _remove_subject(message: str) -> str:
    """pydantic's sentence without its subject: ``Input should be greater than 0`` -> ``greater than 0``."""
    for subject in (
        "Input should be ",
        "Value error, ",
        "List should have ",
        "String should have ",
        "String should ",
    ):
        if message.startswith(subject):
            return message[len(subject) :]
    return message[0].lower() + message[1:]


def _find_fields(table_type: type[BaseModel], path: Keys) -> tuple[str, ...]:
    """Keys allowed in the table at ``path`` (found through the JSON schema, which knows unions and lists)."""
    schema = table_type.model_json_schema()
    node: Mapping[str, Any] = schema
    for key in path:
        node = _step(schema, node, key)
    return tuple(_resolve(schema, node).get("properties", {}))


def _resolve(schema: Mapping[str, Any], node: Mapping[str, Any]) -> Mapping[str, Any]:
    while "$ref" in node:
        node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
    for union in ("anyOf", "oneOf"):
        tables = [_resolve(schema, choice) for choice in node.get(union, ())]
        named = [table for table in tables if "properties" in table]
        if named:
            return named[0]
    return node


def _step(schema: Mapping[str, Any], node: Mapping[str, Any], key: str | int) -> Mapping[str, Any]:
    if isinstance(key, int):
        items: Mapping[str, Any] = _resolve(schema, node).get("items", {})
        return items
    if key in _resolve(schema, node).get("properties", {}):
        below: Mapping[str, Any] = _resolve(schema, node)["properties"][key]
        return below
    choices = node.get("oneOf", node.get("anyOf", ()))
    for choice in choices:
        if key.lower() in str(choice.get("$ref", "")).lower():
            found: Mapping[str, Any] = choice
            return found
    return node
