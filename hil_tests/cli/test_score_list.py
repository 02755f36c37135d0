"""``railhil score --requirements LIST --results PATH``: a run judged by the sentences of a list, written back."""

from __future__ import annotations

from pathlib import Path

import pytest

import railhil
from hil_tests.support.cli import Railhil
from hil_tests.support.requirement_lists import attribute, reqif_text
from hil_tests.support.short_runs import RUN_2M_TOML


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> railhil.Outcome:
    folder = tmp_path_factory.mktemp("listed")
    (folder / "short.toml").write_text(f"{RUN_2M_TOML}stop_error_max_m = 2\ntime_error_max_s = 2\n")
    return railhil.run(folder / "short.toml", controller="ipfc_plus", out=folder / "run")


@pytest.fixture
def listed(tmp_path: Path) -> Path:
    path = tmp_path / "train.reqif"
    rows = [
        ("R-1", "It never goes back.", "never true_speed &lt; 0 km/h"),
        ("R-2", "It is slow.", "always true_speed &lt;= 1 km/h"),
        ("R-3", "It is green.", ""),
        ("R-4", "It brakes.", "whenever age(TRN_SPEED) &gt; 64 ms, within 20 ms notch_command &lt;= 0"),
    ]
    path.write_text(reqif_text(rows), encoding="utf-8")
    return path


def test_a_run_is_judged_by_a_list_and_the_list_gets_the_outcomes(
    here: Railhil, run: railhil.Outcome, listed: Path
) -> None:
    done = here("score", run.folder, "--requirements", listed, "--results", "judged.reqif")
    assert done.exit_code == 1, done.err
    assert "requirement R-2: always true_speed <= 1 km/h: violated" in " ".join(done.out.split())
    found = {name: attribute(Path("judged.reqif"), name, "RAILHIL_VERDICT") for name in ("R-1", "R-2", "R-3", "R-4")}
    assert found == {"R-1": "kept", "R-2": "violated", "R-3": "", "R-4": "says nothing"}
    said = attribute(Path("judged.reqif"), "R-2", "RAILHIL_EVIDENCE")
    assert said.startswith("margin -")
    assert f"frames.log sha256 {run.frames_sha256}" in said
    # The copy is a list like the first.
    again = here("score", run.folder, "--requirements", "judged.reqif", "--results", "again.reqif")
    assert again == done
    assert Path("again.reqif").read_text() == Path("judged.reqif").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--results", "a.reqif"), "--results: 0 lists, expected --requirements with one list"),
        (("--results", "a.reqif", "--requirements", "ato"), "--results: 0 lists, expected --requirements with"),
        (("--requirements", "none.reqif"), "none.reqif: does not exist, expected a file of requirements"),
        (("--requirements", "LIST", "--results", "/proc/1/a.reqif"), "--results: the file /proc/1/a.reqif cannot be"),
    ],
)
def test_what_is_refused(
    here: Railhil, run: railhil.Outcome, listed: Path, words: tuple[str, ...], message: str
) -> None:
    done = here("score", run.folder, *(str(listed) if word == "LIST" else word for word in words))
    assert done.exit_code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
