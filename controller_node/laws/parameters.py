"""Parameters of a law from a file: names and values become the law's frozen dataclass.

The allowed range of a value is declared with its default, ``Annotated[float, Field(ge=0, le=1)]``; relations between
values are checked by the law itself, which raises ``ValueError`` in its constructor.
"""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

from pydantic import TypeAdapter, ValidationError

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.validation import describe_allowed, join_keys


def law_parameters(name: str, kind: type[Any], given: ParameterSet | None) -> Any:
    """The law's parameters: its defaults overridden by the file; None without a file.

    :param name: name by which the law was requested.
    :raises InputError: the file belongs to another law, names a parameter that the law does not have, or gives one a
        value of another type or outside its range.
    """
    if given is None:
        return None
    if given.law != name:
        raise InputError(given.source, "law", given.law, f"{name}, the controller asked for")
    known = [item.name for item in fields(kind.parameters_type)]
    for key in given.values:
        if key not in known:
            allowed, hint = f"one of {', '.join(known)}", did_you_mean(key, known)
            raise InputError(given.source, f"parameters.{key}", Words("unknown key"), allowed, hint)
    try:
        # As JSON: strict about types, except that an array is accepted as a tuple and an integer as a float.
        return TypeAdapter(kind.parameters_type).validate_json(json.dumps(dict(given.values), default=str), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise InputError(
            given.source, join_keys(("parameters", *first["loc"])), first["input"], describe_allowed(first)
        ) from None
