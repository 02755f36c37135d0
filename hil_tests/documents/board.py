"""Figures of docs/howto/board.md."""

from __future__ import annotations

from collections.abc import Sequence

from hil_tests.documents.figures import nominal


def run() -> Sequence[str]:
    """The run with our node; the exported program sends the same notches (hil_tests/loop/test_foreign_program.py)."""
    found = nominal()
    return (f"ends with {found.outcome.verdict}, a stop error of {found['stop_error_m']:+.3f} m",)
