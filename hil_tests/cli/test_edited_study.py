"""One edited byte in the folder of a study, a comparison or a table of faults: its report is refused in a line."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hil_tests.support.cli import Railhil, railhil
from hil_tests.support.short_runs import RUN_2M_TOML

pytestmark = pytest.mark.slow
SAYS = '[[requirement]]\nid = "CUT"\nsays = "never controller_level >= traction_cut"\n'
_STOP = ("yizhuang_stop", "--controller", "ilc_stop", "--set", "task.duration_s=4", "--runs", "2")
#: Kind of folder -> the command that makes it.
COMMANDS = {
    "campaign": ("campaign", "short.toml", "--runs", "2"),
    "compare": ("compare", "short.toml", "--laws", "ipfc,tpfc1"),
    "faults": ("faults", "short.toml", "--only", "T1b", "--jobs", "1"),
    "hunt": ("hunt", "short.toml", "--requirements", "mine.toml", "--runs", "1", "--seed", "3", "--no-shrink"),
    "learn": ("learn", *_STOP, "--sequences", "1", "--jobs", "1"),
    "probability": (
        "probability", "short.toml", "--says", "at stopped stop_error <= 0.5 m", "--points", "100", "--accuracy", "10",
        "--method", "subset", "--jobs", "1",
    ),
    "sequence": ("sequence", "run", *_STOP, "--bus", "local"),
}  # fmt: skip
Made = Callable[[str], Path]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Makes the folder of a kind once."""
    place = tmp_path_factory.mktemp("studies")
    (place / "short.toml").write_text(RUN_2M_TOML)
    (place / "mine.toml").write_text(SAYS)

    def make(kind: str) -> Path:
        if not (place / kind).exists():
            done = railhil(*COMMANDS[kind], "--out", kind, cwd=place)
            assert done.exit_code in (0, 1, 3), done.err
        return place / kind

    return make


@pytest.mark.long
@pytest.mark.parametrize("kind", COMMANDS)
@settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_an_edited_byte_of_any_file_is_said(here: Railhil, made: Made, kind: str, data: st.DataObject) -> None:
    folder = made(kind)
    files = [path for path in folder.rglob("*") if path.is_file() and path.stat().st_size]
    path = data.draw(st.sampled_from(sorted(files)))
    content = path.read_bytes()
    place, bit = data.draw(st.integers(0, len(content) - 1)), data.draw(st.integers(0, 7))
    page = folder.with_name("page.html")
    try:
        path.write_bytes(content[:place] + bytes([content[place] ^ 1 << bit]) + content[place + 1 :])
        done = here("report", folder, "--out", page)
    finally:
        path.write_bytes(content)
    assert done.exit_code == 2, f"{path.relative_to(folder)}, byte {place}, bit {bit}"
    assert done.one_line()
    assert not page.exists()


@pytest.mark.long
@pytest.mark.parametrize("kind", COMMANDS)
def test_an_unedited_folder_has_its_report(here: Railhil, made: Made, kind: str, tmp_path: Path) -> None:
    done = here("report", made(kind), "--out", tmp_path / "page.html")
    assert done.exit_code == 0, done.err


def test_a_new_report_of_a_run_leaves_the_table_above_it_as_listed(here: Railhil, made: Made, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(made("faults"), tmp_path / "faults"))
    assert here("report", folder / "T1b").exit_code == 0
    assert here("report", folder).exit_code == 0
    assert 'href="T1b/report.html"' in (folder / "report.html").read_text()
    assert here("verify", folder).exit_code == 0
    # A list that has been edited is not made good by it.
    path = folder / "T1b" / "SHA256SUMS"
    path.write_text(path.read_text().replace("signals.csv", "other.csv"))
    assert here("verify", folder).exit_code == 1
    here("report", folder / "T1b")
    assert here("report", folder).exit_code == 2
