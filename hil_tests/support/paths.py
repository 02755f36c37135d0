"""Where the tree and the tests' data are."""

from __future__ import annotations

from pathlib import Path

#: Of the checkout.
ROOT = Path(__file__).parents[2]
TEST_DATA = ROOT / "hil_tests" / "data"
