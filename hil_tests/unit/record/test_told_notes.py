"""Notes of a law in the results of a record: named by the controller's declaration, by old contracts, or by number."""

from __future__ import annotations

import numpy as np
import pytest

from hil_tests.support.recordings import SharedRuns
from railhil.dbc import wire_contract
from railhil.judge.record import Record
from railhil.judge.signals import signal_table
from railhil.record.notes import note_values
from railhil.record.trace import Trace
from railhil.report.page import page
from railhil.systems.ato.judge.events import STATUS
from railhil.wire.ato import CtlStat

TURN = {
    "signal": "Note3",
    "name": "turn",
    "title": "turn of the wheel",
    "symbol": "",
    "unit": "rad",
    "scale": 0.25,
    "signed": True,
    "bits": [],
}


@pytest.fixture(scope="module")
def run(published_run: SharedRuns) -> Record:
    return published_run(5, "iq")


@pytest.mark.slow
def test_certificate_and_signals_name_what_the_controller_said(run: Record) -> None:
    told = run.certificate["notes"]
    assert [one["name"] for one in told] == ["basis_in_use", "softening_factor", "satisfaction"]
    header, rows = signal_table(run.scenario, run.trace, told)
    first = header.index("basis_in_use")
    assert header[first : first + 4] == ["basis_in_use", "softening_factor", "satisfaction", "ladder_level"]
    assert np.nanmax(rows[:, first + 1]) == pytest.approx(0.85, abs=1e-4)


@pytest.mark.slow
def test_a_record_of_an_unknown_law_has_numbered_notes(run: Record) -> None:
    notes = STATUS.recorded(run.trace, None)
    assert [note.name for note in notes] == ["note_1", "note_2", "note_3"]
    text = page([run.copy_with(certificate={**run.certificate, "notes": None})])
    assert "Note 1 and note 2 and note 3 over time" in text


def test_a_law_without_notes_has_no_column_and_no_figure(run: Record) -> None:
    assert STATUS.recorded(run.trace, []) == ()
    assert 'id="softening_factor"' not in page([run.copy_with(certificate={**run.certificate, "notes": []})])


def test_a_signed_note_with_its_own_scale() -> None:
    (note,) = STATUS.declared([TURN])
    assert note.label == "turn of the wheel (rad)"
    trace = Trace(wire_contract())
    for value in (0x0004, 0xFFFE):
        trace.add(CtlStat.PORT, 0, CtlStat(note3=value).encode())
    assert note_values(trace, note, CtlStat.PORT).tolist() == [1.0, -0.5]


@pytest.mark.parametrize(("key", "value"), [("signal", "Note4"), ("scale", "much")])
def test_what_is_no_note_is_refused(key: str, value: str) -> None:
    with pytest.raises(ValueError, match=value):
        STATUS.declared([{**TURN, key: value}])
