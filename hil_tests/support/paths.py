"""Paths of the source tree and the tests' data."""

from __future__ import annotations

from pathlib import Path

#: Root of the checkout.
ROOT = Path(__file__).parents[2]
TEST_DATA = ROOT / "hil_tests" / "data"
