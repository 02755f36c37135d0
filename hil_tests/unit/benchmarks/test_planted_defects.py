"""Our own hunts on the planted defects: entries that ``railhil bench-suite --score`` reads, and the page's figures."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT

pytest.importorskip("pyarrow", reason="MISSING CAPABILITY pyarrow (extra campaign)")

from benchmarks import planted_defects
from benchmarks.planted_defects import Unmodified
from railhil.hunt.defects import SEEDS, defects

PAGE = "docs/howto/hunt.md"


def page_cells(defect: str, seed: int) -> dict[str, str]:
    """Strategy -> the page's figure of a defect and a seed."""
    head, rows = "| planted defect | random", f"| {defects()[defect].title} |"
    lines = (ROOT / PAGE).read_text("utf-8").splitlines()
    (names,), (figures,) = ([line for line in lines if line.startswith(begin)] for begin in (head, rows))
    columns = zip(names.strip("| ").split(" | ")[1:], figures.strip("| ").split(" | ")[1:], strict=True)
    return {name.partition(",")[0]: cell.split(", ")[SEEDS.index(seed)] for name, cell in columns}


def test_without_a_run_there_is_no_rate() -> None:
    assert Unmodified().line == "no run without the defect was made"
    assert Unmodified(8, 4.0, 1.0).line == "8 runs, 1.60 in 1 s of processor time, 20.0 % of it judging"


@pytest.mark.long
def test_a_search_made_again_is_that_of_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name, seed = "m09", 3
    assert planted_defects.main(["--only", name, "--seed", str(seed), "--runs", "1", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    for strategy in ("swarm", "auto"):
        entry = tomllib.loads((tmp_path / f"{name}-{seed}" / strategy / "entry.toml").read_text("utf-8"))
        assert entry == {"tool": f"railhil hunt, {strategy}", "defect": name, "seed": seed, "runs": 1, "run": "run"}
        assert page_cells(name, seed)[strategy] == "1"
        assert re.search(rf"railhil hunt, {strategy} +│ 1 of 15 .* - - 1 - -", out)
    assert re.search(r"without a defect: 1 run, [\d.]+ in 1 s", out)
