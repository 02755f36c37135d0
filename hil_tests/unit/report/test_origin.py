"""The files that a page names."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from hil_tests.support.run_folders import write_run
from railhil.report.origin import folder_files


def test_a_page_names_no_file_that_the_folder_does_not_have(tmp_path: Path) -> None:
    folder = write_run(tmp_path / 'a "%<b> ü')
    run: Any = SimpleNamespace(folder=folder)
    assert ("SHA256SUMS", "a%20%22%25%3Cb%3E%20%C3%BC/SHA256SUMS") in folder_files(run, tmp_path / "page.html")
    (folder / "SHA256SUMS").unlink()
    found = folder_files(run, tmp_path / "page.html")
    assert [name for name, _ in found] == ["certificate.json", "events.csv", "score.json"]
    assert all(address for _, address in found)
