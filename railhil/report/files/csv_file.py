"""The table of signals as CSV with units and certificate."""

from __future__ import annotations

import json
from datetime import timedelta
from pathlib import Path

from railhil.report.files.content import TIME_UTC, Content


def write_csv(content: Content, path: Path) -> None:
    """Write the columns of ``signals.csv``, preceded by two lines that begin with ``#``.

    They are ``# certificate {...}`` and ``# units {...}``, JSON each. The numbers are written as in ``signals.csv``.
    """
    header, rows = content.signals
    lines = [f"# certificate {content.certificate}", f"# units {json.dumps(content.units, ensure_ascii=False)}"]
    lines.append(",".join(header if content.start is None else [TIME_UTC, *header]))
    for row in rows.tolist():
        words = [f"{value:.10g}" for value in row]
        if content.start is not None:
            instant = content.start + timedelta(microseconds=round(row[0] * 1e6))
            words.insert(0, instant.strftime("%Y-%m-%dT%H:%M:%S.%fZ"))
        lines.append(",".join(words))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
