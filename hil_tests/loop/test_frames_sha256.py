"""Every law, fault and shipped scenario leaves the frame log of the list, to the byte.

After a change that is meant to alter frame logs: ``python hil_tests/hashes.py > hil_tests/data/frames_sha256.txt``,
and the CHANGELOG says which and why.
"""

from __future__ import annotations

import pytest

from hil_tests.hashes import runs
from hil_tests.support.same_lines import known_hashes

#: One of each kind; the others are long.
_QUICK = {
    "yizhuang_05 ipfc_plus iq 7", "yizhuang_05 tpfc2 float64 7", "hst_short delay_gpc float64 7",
    "emu3_short pid_ff float32 7", "yizhuang_stop_slide ilc_stop iq 7", "faults yizhuang_05 T1",
    "shipped lvshun_tieshan",
}  # fmt: skip


def test_the_list_has_every_run_once() -> None:
    assert list(known_hashes()) == list(runs([]))


@pytest.mark.faults
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in _QUICK else pytest.mark.long) for name in runs([])]
)
def test_frame_log_is_that_of_the_list(name: str) -> None:
    assert runs([])[name].sha256() == known_hashes()[name]
