"""Recorded runs that tests of several processes share."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support import recordings
from hil_tests.support.changed_records import short_scenario
from hil_tests.support.recordings import SharedRuns


@pytest.mark.slow
def test_a_run_is_made_once_and_what_is_written_into_it_is_found(tmp_path: Path) -> None:
    one, other = SharedRuns(short_scenario(), tmp_path), SharedRuns(short_scenario(), tmp_path)
    log = one(3, "iq").log
    made_ns = log.stat().st_mtime_ns
    assert other(3, "iq").log == log
    assert log.stat().st_mtime_ns == made_ns
    assert one.changed() == other.changed() == []
    new, score, page = (log.with_name(name) for name in ("new.txt", "score.json", "junit.xml"))
    new.touch()
    score.write_text(score.read_text() + " ")
    page.unlink()
    assert one.changed() == other.changed() == [page, new, score]


@pytest.mark.slow
def test_a_run_whose_making_was_ended_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def ended(*_arguments: object) -> None:
        raise KeyboardInterrupt

    runs = SharedRuns(short_scenario(), tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(recordings, "write_folder", ended)
        with pytest.raises(KeyboardInterrupt):
            runs(3, "iq")
    assert runs(3, "iq").certificate["seed"] == 3
    assert runs.changed() == []
