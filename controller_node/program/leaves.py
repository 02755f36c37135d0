"""Leaves of nested tuples, such as the state of a law, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any


def leaves(value: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Named leaves of nested (named) tuples and lists: ``state.model[0]``, ``state.notch``, ..."""
    if hasattr(value, "_fields"):
        for name in value._fields:
            yield from leaves(getattr(value, name), f"{prefix}.{name}" if prefix else name)
    elif isinstance(value, tuple | list):
        for i, item in enumerate(value):
            yield from leaves(item, f"{prefix}[{i}]")
    else:
        yield prefix, value


def like(template: Any, make: Callable[[str, Any], Any], prefix: str = "") -> Any:
    """A structure of the same shape (lists become tuples) with new leaves, made from name and old leaf."""
    if hasattr(template, "_fields"):
        return type(template)(
            *(like(getattr(template, name), make, f"{prefix}.{name}" if prefix else name) for name in template._fields)
        )
    if isinstance(template, tuple | list):
        return tuple(like(item, make, f"{prefix}[{i}]") for i, item in enumerate(template))
    return make(prefix, template)
