"""A folder whose list of hashes lacks a result is refused by every reader that checks it."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.record.hash_list import HASH_LIST, check_hash_list, write_hash_list


@pytest.mark.parametrize(("document", "result"), [("certificate.json", "score.json"), ("hunt.json", "summary.json")])
def test_a_result_without_a_line_in_the_list_is_refused(tmp_path: Path, document: str, result: str) -> None:
    for name in (document, result, "notes.txt"):
        (tmp_path / name).write_text("{}")
    write_hash_list(tmp_path, only=(document, result))
    check_hash_list(tmp_path, document, {})
    path = tmp_path / HASH_LIST
    path.write_text("".join(line for line in path.read_text().splitlines(keepends=True) if result not in line))
    with pytest.raises(InputError, match=f"has no line of {result}"):
        check_hash_list(tmp_path, document, {})
