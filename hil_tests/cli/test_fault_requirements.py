"""``railhil faults --requirements``: the runs of the catalogue are judged by sentences, too."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil
from hil_tests.support.short_runs import RUN_2M_TOML

RULES = """
[[requirement]]
id = "R-1"
says = "whenever age(TRN_SPEED) > 15 ms, within 100 ms age(TRN_SPEED) <= 15 ms"
[[requirement]]
id = "R-2"
says = "never true_speed > 0.1 km/h"
[[requirement]]
id = "R-3"
says = "whenever age(TRN_SPEED) > 900 ms, within 100 ms age(TRN_SPEED) <= 15 ms"
[[requirement]]
id = "R-4"
says = "always true_speed >= 0 km/h"
"""


@pytest.mark.slow
def test_a_row_has_the_sentences_that_its_fault_has_put_to_the_test(here: Railhil, tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    (tmp_path / "rules.toml").write_text(RULES)
    out = tmp_path / "out"
    words = ("--requirements", tmp_path / "rules.toml", "--jobs", "1", "--out", out, "--json")
    done = here("faults", tmp_path / "short.toml", "--only", "T1b", *words)
    assert done.exit_code == 1, done.err
    (row,) = done.json
    assert row["requirements"] == {"R-1": "kept", "R-2": "violated"}, "R-3 never began, and R-4 demands no reaction"
    assert any(text.startswith("R-2 violated at ") for text in row["failures"])
    outcomes = json.loads((out / "T1b" / "score.json").read_text())["requirements"]
    assert {one["id"]: one["verdict"] for one in outcomes} == {
        "R-1": "kept", "R-2": "violated", "R-3": "says nothing", "R-4": "kept",
    }  # fmt: skip
    assert "R-1 kept" in re.sub("<[^>]+>", "", (out / "report.html").read_text())
    # A dossier of the folder counts them.
    done = here("dossier", out, "--out", tmp_path / "dossier", "--json")
    assert {one["id"]: one["verdict"] for one in done.json["claims"]}["R-2"] == "violated"
