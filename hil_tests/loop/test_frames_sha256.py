"""Every law, fault and shipped scenario leaves the frame log of the list, and every hunt what it found, to the byte.

After a change that is meant to alter frame logs: ``python hil_tests/hashes.py > hil_tests/data/frames_sha256.txt``,
and the CHANGELOG says which and why.
"""

from __future__ import annotations

import pytest

from hil_tests.hashes import FAULTS, HUNTS, runs
from hil_tests.support.same_lines import known_hashes
from railhil.faults.capability import why_not
from railhil.faults.language import parse

#: One of each kind; the others are long.
_QUICK = {
    "yizhuang_05 ipfc_plus iq 7", "yizhuang_05 tpfc2 float64 7", "hst_short delay_gpc float64 7",
    "emu3_short pid_ff float32 7", "yizhuang_stop_slide ilc_stop iq 7", "faults yizhuang_05 T1",
    "shipped lvshun_tieshan", "faults four_stops D1",
}  # fmt: skip


#: Entries of the catalogue of high-speed trains that this one of a single unit cannot have.
_OF_SEVERAL_UNITS = ("faults hst_short H3b", "faults hst_short H9b")


def test_the_list_has_every_run_once() -> None:
    assert list(known_hashes()) == list(runs([]))


def test_hunts_that_start_other_processes_are_left_out_where_these_cannot_be() -> None:
    assert runs([HUNTS]).keys() - runs([HUNTS], one_process=True).keys() == {"hunts faults"}


def test_a_fault_is_refused_only_where_it_cannot_be_injected() -> None:
    """A line that is refused for another reason would compare nothing."""
    known = known_hashes()
    for name, run in runs([FAULTS]).items():
        cannot = any(why_not(parse(text), "local", "lockstep") for text in run.faults)
        assert (known[name] == "refused") == (cannot or name in _OF_SEVERAL_UNITS), name


@pytest.mark.timeout(900)
@pytest.mark.faults
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in _QUICK else pytest.mark.long) for name in runs([])]
)
def test_frame_log_is_that_of_the_list(name: str) -> None:
    assert runs([])[name].sha256() == known_hashes()[name]
