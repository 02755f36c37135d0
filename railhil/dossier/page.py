"""``report.html`` of a dossier: the matrix, the gaps, a page for each requirement, the evidence, and the tool."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.dossier.claims import SHOWN, Claim, Run, by_key, named
from railhil.dossier.dossier import Dossier
from railhil.dossier.evidence import Evidence
from railhil.judge.requirements.outcome import NOT_JUDGED
from railhil.judge.requirements.sentence import KEPT, OPEN, SILENT, VIOLATED
from railhil.record.hash_list import REPORT
from railhil.report.templates import address_of, render_page
from railhil.testing.requirements import PASSED

#: Rows of runs on the page of a requirement; ``dossier.json`` has all.
_ROWS_MAX = 12
#: Columns of the matrix; with more folders only their numbers stand there.
_CELLS_MAX = 40
#: Class of the badge of each verdict.
_BADGES = {SHOWN: "PASS", VIOLATED: "FAIL"}
#: Sign of a run in the matrix.
_SIGNS = {KEPT: "●", VIOLATED: "✗", OPEN: "○", SILENT: "○", NOT_JUDGED: "·", "": "·"}
#: Short words of counts.
_SHORT = {SILENT: "silent"}


def page(dossier: Dossier, out: Path) -> str:
    """The dossier as one HTML document without external references.

    :param out: folder of the page, to which links are relative.
    """
    shows_cells = len(dossier.evidence) <= _CELLS_MAX
    return render_page(
        "dossier.html.j2",
        "railhil.dossier",
        title="Dossier",
        dossier=dossier,
        claims=[(one, _row(one, dossier.evidence if shows_cells else ())) for one in dossier.claims],
        shows_cells=shows_cells,
        badge=lambda verdict: _BADGES.get(verdict, "INVALID"),
        named=named,
        with_names=lambda said: [f"{one} ({named(items)})" for one, items in said.items()],
        rows=_rows,
        link=lambda one: address_of(one.folder, out / REPORT),
        assumptions=by_key((said, one) for one in dossier.evidence for said in one.document.get("assumptions") or ()),
        published={
            source: [(row.at, row.reading, row.other) for row in rows]
            for source, rows in (one.published for one in dossier.evidence if one.published)
        },
    )


def _row(claim: Claim, evidence: Sequence[Evidence]) -> dict[str, Any]:
    """A row of the matrix."""
    counts = {_SHORT.get(word, word): len(claim.of(word)) for word in (KEPT, VIOLATED, OPEN, SILENT)}
    counts["unchecked"] = sum(bool(run.evidence.problems) for run in claim.runs)
    passed = sum(test.result == PASSED for test in claim.tests)
    searched = sum(search.runs for _, search in claim.searches)
    found = sum(search.violations for _, search in claim.searches)
    return {
        "runs": ", ".join(f"{count} {word}" for word, count in counts.items() if count),
        "tests": f"{passed} of {len(claim.tests)} passed" if claim.tests else "",
        "searched": f"{found or 'none'} in {searched:,}" if searched else "",
        "cells": [_cell(one, claim) for one in evidence],
    }


def _cell(item: Evidence, claim: Claim) -> tuple[str, str, str]:
    """A sign of the matrix, its class, and what stands under the pointer."""
    for other, search in claim.searches:
        if other.number == item.number:
            sign, kind = ("✗", "violated") if search.violations else ("s", "")
            return sign, kind, f"{item.name}: {search.said}"
    run = next((run for run in claim.runs if run.evidence.number == item.number), None)
    if run is None:
        return " ", "", ""
    kind = "doubtful" if item.problems else "violated" if run.verdict == VIOLATED else ""
    said = ", ".join(filter(None, (run.verdict, run.why_not)))
    return "?" if item.problems else _SIGNS[run.verdict], kind, f"{item.name}: {said}"


def _rows(claim: Claim) -> tuple[list[Run], list[str]]:
    """The runs that a claim's page has as rows, and sentences on the others."""
    said = [run for run in claim.runs if _is_row(run)]
    shown = said[:_ROWS_MAX]
    others = by_key(
        (run.verdict or run.why_not, run.evidence)
        for run in claim.runs
        if not _is_row(run) and (run.counts or not run.verdict)
    )
    rest = [f"{word} in {count_of(len(items), 'run')}: {named(items)}" for word, items in others.items()]
    if further := said[_ROWS_MAX:]:
        rest.insert(
            0, f"{count_of(len(further), 'further run')} with larger margins: {named(run.evidence for run in further)}"
        )
    return shown, rest


def _is_row(run: Run) -> bool:
    return run.verdict in (VIOLATED, KEPT, OPEN) or bool(run.evidence.problems)
