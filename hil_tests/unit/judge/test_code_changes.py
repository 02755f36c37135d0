"""What is said of a record that other code has made."""

from __future__ import annotations

import pytest

from railhil.judge.rerun import code_changes

_NOW = {"railhil": "0.2.0+g1234567", "code_sha256": "a"}


@pytest.mark.parametrize(
    ("then", "said"),
    [
        ({"railhil": "0.2.0+g1234567", "code_sha256": "a"}, []),
        # Another commit with the same code, as one that changes a page.
        ({"railhil": "0.2.0", "code_sha256": "a"}, []),
        ({"railhil": "0.1.0", "code_sha256": "a"}, ["0.1.0"]),
        ({"railhil": "0.2.0", "code_sha256": "b"}, ["0.2.0, this is 0.2.0+g1234567", "(code_sha256)"]),
    ],
)
def test_another_commit_is_named_where_its_code_differs(then: dict[str, str], said: list[str]) -> None:
    found = code_changes(then, _NOW, "the record")
    assert len(found) == len(said)
    assert all(part in line for part, line in zip(said, found, strict=True))
