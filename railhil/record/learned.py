"""What a law with a memory leaves after a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railhil.scenarios.memory import Record


@dataclass(frozen=True, slots=True)
class Kept:
    """What the law wants to keep: key and values; ``used``: the place of the record that it began with (empty: none);
    ``refused``: places that it could not use, with the fault and what is wrong, by name."""

    key: str
    values: dict[str, Any]
    used: str
    refused: dict[str, tuple[str, str]]


def kept_of(document: Mapping[str, Any]) -> Kept:
    """What :func:`railhil.controller_node.laws.memory.kept` has made.

    :raises LookupError, TypeError, ValueError: something else.
    """
    refused = {str(one["slot"]): (str(one["fault"]), str(one["detail"])) for one in document["refused"]}
    return Kept(str(document["key"]), dict(document["values"]), str(document["used"]), refused)


#: :meth:`Learned.as_json` of a run after which nothing was kept.
NOTHING_LEARNED: Mapping[str, Any] = {"memory_used": None, "memory_refused": {}, "memory_after_sha256": None}


@dataclass(frozen=True, slots=True)
class Learned:
    """What a run left: what its law wants to keep, and the record of it; None: the law has learned from this run
    before."""

    kept: Kept
    record: Record | None

    def as_json(self) -> dict[str, Any]:
        """For the certificate: which stored record the law used, what was wrong with others, and the new record."""
        return {
            "memory_used": self.kept.used,
            "memory_refused": {slot: list(why) for slot, why in self.kept.refused.items()},
            "memory_after_sha256": None if self.record is None else self.record.sha256,
        }
