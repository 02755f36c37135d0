"""Notes of a law: which signal carries which note, its bits, and laws with invalid declarations."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from hil_tests.support.batch_controller import BatchController, on_wire_batch
from hil_tests.support.plug import plug_in
from railhil.common.errors import InputError
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.laws import load, names
from railhil.controller_node.laws.note import Note, flags, on_wire, slots
from railhil.controller_node.telemetry_file import law_document
from railhil.scenarios.load import load as load_scenario
from railhil.scenarios.run_spec import LawSpec

FLAGS = flags("mode", "mode", ("slow", "fast"))
SHARE = Note("share", "share", 30)
TURN = Note("turn", "turn", 8, wire_q=4, unit="rad", signed=True)


def test_a_bit_field_and_two_figures_have_their_signals() -> None:
    assert slots(()) == {}
    assert slots((SHARE,)) == {"Note2": 0}
    assert slots((SHARE, TURN, FLAGS)) == {"Note2": 0, "Note3": 1, "Note1": 2}


@pytest.mark.parametrize(
    ("notes", "words"),
    [
        ((FLAGS, flags("other", "other", ("on",))), "at most one note with named bits and two others"),
        ((SHARE, TURN, Note("third", "third", 14)), "at most one note with named bits and two others"),
        ((Note("fine", "fine", 8),), "note fine: wire_q at most q"),
        ((flags("wide", "wide", ("a", "b", "c", "d", "e")),), "at most 4 names of bits"),
        ((SHARE, SHARE), "notes with different names"),
    ],
)
def test_what_does_not_fit_is_refused(notes: tuple[Note, ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        slots(notes)


@pytest.mark.parametrize(
    ("note", "raw", "wire"),
    [
        (FLAGS, 3, 3),
        (FLAGS, 16, 15),
        (FLAGS, -1, 0),
        (SHARE, 1 << 30, 1 << 14),
        (SHARE, (1 << 30) - 1, (1 << 14) - 1),
        (SHARE, -1, 0),
        (Note("plain", "plain", 0, wire_q=0), 1 << 20, 0xFFFF),
        (TURN, -16, 0xFFFF),
        (TURN, -17, 0xFFFE),
        (TURN, 1 << 30, 0x7FFF),
        (TURN, -(1 << 30), 0x8000),
    ],
)
def test_the_wire_holds_what_its_bits_can(note: Note, raw: int, wire: int) -> None:
    assert on_wire(note, raw) == wire
    assert on_wire_batch(note, np.array([raw])).tolist() == [wire]


def test_the_controller_says_what_the_notes_are() -> None:
    said = {one["signal"]: one for one in law_document("ipfc", load("ipfc"))["notes"]}
    assert {signal: one["name"] for signal, one in said.items()} == {
        "Note1": "basis_in_use", "Note2": "softening_factor", "Note3": "satisfaction",
    }  # fmt: skip
    assert said["Note1"]["bits"] == ["step", "wavelet", "ramp"]
    assert (said["Note2"]["scale"], said["Note2"]["signed"]) == (1 / 16384, False)
    assert law_document("tdmc", load("tdmc"))["notes"] == []


@pytest.mark.parametrize("law", names())
@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_every_law_answers_the_notes_that_it_declares(law: str, arithmetic: str) -> None:
    scenario = load_scenario("lvshun_tieshan")
    spec = LawSpec(law, arithmetic)
    assert len(Controller(scenario, spec).step(0, 0, 0).notes) == len(load(law).notes)
    together = BatchController(scenario, 2, spec).step(0, np.zeros(2, np.int64), np.zeros(2, np.int64))
    assert [values.shape for values in together.notes] == [(2,)] * len(load(law).notes)


class TooMany(Ipfc[Any]):
    """Declares two bit fields."""

    notes: ClassVar[tuple[Note, ...]] = (FLAGS, flags("other", "other", ("on",)))


class Silent(Ipfc[Any]):
    """Declares one note and answers three."""

    notes: ClassVar[tuple[Note, ...]] = (FLAGS,)


class Shifted(Ipfc[Any]):
    """Declares another format than it answers."""

    notes: ClassVar[tuple[Note, ...]] = (*Ipfc.notes[:2], Note("satisfaction", "satisfaction", 20))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (TooMany, "controller: wrong.notes: 2 notes, expected at most one note with named bits and two others"),
        (Silent, "step answers 3 notes, the law declares 1"),
        (Shifted, "note satisfaction is Q24, declared Q20"),
    ],
)
def test_a_law_with_wrong_notes_is_one_line(
    law: type[Any], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug_in(tmp_path, monkeypatch, wrong=law)
    with pytest.raises(InputError, match=words):
        Controller(load_scenario("lvshun_tieshan"), LawSpec("wrong"))
