"""The matrix of faults: what each entry of a catalogue injected, what it led to, and the margin to its bound.

A page of one or several tables of ``railhil faults --out`` (:data:`railhil.record.documents.FAULT_TABLE`), and a
function of them alone. Tables of one system stand side by side.
"""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.faults.language import parse
from railhil.judge.reactions.catalogue import ENDS
from railhil.judge.reactions.evaluate import Row
from railhil.record.documents import FAULT_TABLE, fault_entries_missing, fault_table_verdict, read_fault_table
from railhil.record.hash_list import check_hash_list
from railhil.report.origin import recorded_sentence
from railhil.report.templates import address_of, render_page, write_html

_PERCENT_MAX = 100.0


@dataclass(frozen=True)
class Table:
    """The rows of one table. ``name``: its anchor in the page; ``links``: addresses of the runs by entry."""

    name: str
    document: Mapping[str, Any]
    rows: Sequence[Row]
    links: Mapping[str, str]

    @property
    def title(self) -> str:
        """System, scenario and law; texts of a user without their folders."""
        return ", ".join(Path(str(self.document[key])).name for key in ("system", "scenario", "controller"))

    @property
    def recorded(self) -> str:
        """When, where, by whom and with which version its runs were made."""
        return recorded_sentence([self.document])

    @property
    def made(self) -> list[Row]:
        """Rows with a run."""
        return [row for row in self.rows if row.made]

    @property
    def missing(self) -> list[str]:
        """Entries that the command was stopped before."""
        return fault_entries_missing(self.document)

    @property
    def verdict(self) -> str:
        """PASS, FAIL, or INVALID if nothing was run or the command was stopped."""
        return fault_table_verdict(self.document)

    @property
    def pairs(self) -> Sequence[Mapping[str, Any]]:
        """The runs with two random faults each."""
        pairs: Sequence[Mapping[str, Any]] = self.document.get("pairs", ())
        return pairs

    @property
    def broken(self) -> list[tuple[Mapping[str, Any], str]]:
        """The pairs that break a rule of every run, and the command that makes each again."""
        words = ["railhil", "run", str(self.document["scenario"]), "--controller", str(self.document["controller"])]
        return [
            (one, shlex.join([*words, "--seed", str(one["number"]), *(f"--fault={text}" for text in one["faults"])]))
            for one in self.pairs
            if one["failures"]
        ]

    @property
    def combined(self) -> tuple[list[str], dict[tuple[str, str], list[Mapping[str, Any]]]]:
        """The places of all faults, and the pairs at each two places, in their order."""
        found: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
        for one in self.pairs:
            first, second = sorted(fault.place.level for fault in map(parse, one["faults"]))
            found.setdefault((first, second), []).append(one)
        return sorted({place for places in found for place in places}), found

    @property
    def sentences(self) -> list[tuple[str, str, dict[str, list[str]]]]:
        """The sentences that the runs have decided: id, text, and the entries by verdict."""
        found: list[tuple[str, str, dict[str, list[str]]]] = []
        for key, says in self.document.get("sentences", {}).items():
            entries: dict[str, list[str]] = {}
            for row in self.rows:
                if key in row.requirements:
                    entries.setdefault(row.requirements[key], []).append(row.entry.id)
            if entries:
                found.append((key, says, entries))
        return found

    @property
    def says(self) -> str:
        """The result in a sentence."""
        if self.pairs:
            counts = Counter(one["verdict"] for one in self.pairs)
            ends = ", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items()))
            return f"{count_of(len(self.pairs), 'random pair')} of faults ({ends}); {len(self.broken)} break a rule"
        wrong = [row.entry.id for row in self.rows if row.failures]
        absent = [row.entry.id for row in self.rows if not row.made]
        result = f"not as it must be: {', '.join(wrong)}" if wrong else "each as it must be"
        words = [f"{count_of(len(self.made), 'run')}, {result}"]
        margins = [(1 - share, row.entry.id) for row in self.made if (share := share_of(row)) is not None]
        words += [f"least margin {min(margins)[0]:.0%} of its bound ({min(margins)[1]})"] if margins else []
        words += [f"without a run here: {', '.join(absent)}"] if absent else []
        words += [f"stopped before {', '.join(self.missing)}"] if self.missing else []
        return "; ".join(words)


def share_of(row: Row) -> float | None:
    """The part of the bound that the reaction has taken; None: there is no bound, or no reaction."""
    after_ms, within_ms = row.bound
    return None if after_ms is None or within_ms is None else after_ms / within_ms


def after(row: Row, time_s: float | None) -> str:
    """A time from the first effect in words, empty if it did not come."""
    if time_s is None or row.effective_s is None:
        return ""
    after_s = time_s - row.effective_s
    return f"{after_s * 1e3:.0f} ms" if after_s < 10.0 else f"{after_s:.1f} s"


def safe_state(row: Row) -> str:
    """The state that the entry demands at the end, and since when it holds."""
    ends = row.entry.ends
    if not row.made or not ends:
        return ""
    if row.safe_s is None:
        return "stays at NORMAL" if ends == "resumes" else "not reached"
    if row.effective_s is not None and row.safe_s <= row.effective_s:
        return f"{ENDS[ends]} from before"
    return f"{'NORMAL again' if ends == 'resumes' else ENDS[ends]} after {after(row, row.safe_s)}"


def read_table(folder: Path, name: str, out: Path) -> Table:
    """The table of a folder.

    :param out: the page, from which the runs are linked.
    :raises InputError: there is none, it is damaged or changed, or of a version without the demands of its entries.
    """
    document = read_fault_table(folder)
    if document is None:
        raise InputError(folder / FAULT_TABLE, "", Words("does not exist"), "what railhil faults --out has written")
    check_hash_list(folder, FAULT_TABLE, document)
    for key in ("system", "scenario", "controller", "railhil", "code_sha256"):
        if not isinstance(document.get(key), str):
            raise InputError(folder / FAULT_TABLE, key, document.get(key, Words()), "a text")
    try:
        rows = [Row.from_json(row) for row in document["rows"]]
    except (LookupError, ValueError):
        allowed = "the demands of an entry, as railhil faults --out writes them from version 0.3 on"
        raise InputError(folder / FAULT_TABLE, "rows.demanded", Words("missing or damaged"), allowed) from None
    return Table(
        name, document, rows, {row.entry.id: address_of(folder / row.entry.id, out) for row in rows if row.made}
    )


def beside(tables: Sequence[Table]) -> Iterator[tuple[str, Sequence[Table], list[tuple[str, str, list[Row | None]]]]]:
    """Tables of one system side by side: the system, its tables, and id, title and the row of each table per entry."""
    for system in dict.fromkeys(table.document["system"] for table in tables):
        own = [table for table in tables if table.document["system"] == system]
        if len(own) > 1:
            titles = {row.entry.id: row.entry.title for table in own for row in table.rows}
            by_id = [{row.entry.id: row for row in table.rows} for table in own]
            yield system, own, [(key, title, [rows.get(key) for rows in by_id]) for key, title in titles.items()]


def page(tables: Sequence[Table]) -> str:
    """The page as one HTML document."""
    return render_page(
        "fault_matrix.html.j2",
        title=f"Faults: {tables[0].title}" if len(tables) == 1 else f"Faults: {len(tables)} tables",
        tables=tables,
        beside=[*beside(tables)],
        share_of=share_of,
        after=after,
        safe_state=safe_state,
        percent_max=_PERCENT_MAX,
    )


def report_of(folders: Sequence[Path], out: Path) -> None:
    """Write the page of some tables.

    :raises InputError: as :func:`read_table`, or it is a file of a signed folder.
    :raises OSError: it cannot be written.
    """
    write_html(page([read_table(folder, f"table-{place}", out) for place, folder in enumerate(folders, 1)]), out)
