"""The order of laws in every table, legend and list."""

from __future__ import annotations

from collections.abc import Iterable

#: As in Table 2 of Wang et al. (DOI 10.19650/j.cnki.cjsi.J2108765); the others are compared with the first. Then
#: railhil's own laws; laws of other distributions follow by name.
LAW_ORDER = ("ipfc", "tpfc2", "tpfc1", "tdmc", "fuzzy_pid", "ipfc_plus", "ipfc_plus_stop")


def sort_laws(names: Iterable[str]) -> list[str]:
    """The names, each once: first the names of :data:`LAW_ORDER` in that order, then the others sorted."""
    found = set(names)
    return [name for name in LAW_ORDER if name in found] + sorted(found.difference(LAW_ORDER))
