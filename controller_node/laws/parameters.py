"""Parameters of a law from a file: names and values become the law's frozen dataclass.

What a value may be stands beside its default, ``Annotated[float, Field(ge=0, le=1)]``; how values must go together the
law says itself, as a ``ValueError`` of its constructor.
"""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

from pydantic import TypeAdapter, ValidationError

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.validation import dotted, sentence


def law_parameters(name: str, kind: type[Any], given: ParameterSet | None) -> Any:
    """The law's parameters: its defaults with what the file says put in their places; None without a file.

    :param name: name under which the law was asked for.
    :raises InputError: the file is another law's, names a parameter that the law has not, or gives one a value of
        another type or outside its range.
    """
    if given is None:
        return None
    if given.law != name:
        raise InputError(given.source, "law", given.law, f"{name}, the controller asked for")
    known = [item.name for item in fields(kind.parameters_type)]
    for key in given.values:
        if key not in known:
            found = Words(f"the unknown parameter {key}")
            hint = did_you_mean(key, known)
            raise InputError(given.source, "parameters", found, f"only {', '.join(known)}", hint)
    try:
        # As JSON: strict about types, but an array is a tuple and a whole number a number.
        return TypeAdapter(kind.parameters_type).validate_json(json.dumps(dict(given.values), default=str), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise InputError(given.source, dotted(("parameters", *first["loc"])), first["input"], sentence(first)) from None
