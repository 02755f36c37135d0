"""The faults of a run from their texts; a run without any does not load the language of faults."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from railhil.faults.model import Fault


def parsed(texts: Iterable[str]) -> list[Fault]:
    """Each text as a fault, see :func:`railhil.faults.language.parse`.

    :raises InputError: one of them is not in the language.
    """
    texts = list(texts)
    if not texts:
        return []
    # Loading it takes a tenth of the start of a node.
    from railhil.faults.language import parse

    return [parse(text) for text in texts]
