"""Entry points are looked up once for all groups."""

from __future__ import annotations

import importlib.metadata
import sys
from pathlib import Path

import pytest

from railhil.common.plug_ins import entries


def test_one_lookup_serves_all_groups_and_another_path_has_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, asked = importlib.metadata.entry_points, []

    def counted() -> importlib.metadata.EntryPoints:
        asked.append(1)
        return found()

    monkeypatch.setattr(importlib.metadata, "entry_points", counted)
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])
    folder = tmp_path / "mine-1.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1\n")
    (folder / "entry_points.txt").write_text("[mine.one]\na = b:c\n[mine.two]\nd = e:f\n")
    assert [entries("mine.one")["a"].value, entries("mine.two")["d"].value] == ["b:c", "e:f"]
    assert "ato" in entries("railhil.systems")
    assert len(asked) == 1
    monkeypatch.setattr(sys, "path", sys.path[:-1])
    assert entries("mine.one") == {}
