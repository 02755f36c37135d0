"""The hash of a law's code covers all that its distribution holds, so that a campaign never mixes two codes."""

from __future__ import annotations

import importlib
from importlib.metadata import distribution
from pathlib import Path

import pytest

from railhil import AT_TOP
from railhil.campaign.plan import Request, make_plan
from railhil.campaign.study import CAMPAIGN
from railhil.common.errors import InputError
from railhil.common.held_code import held_sha256, place_of
from railhil.hunt.plan import OWN_CODE
from railhil.judge.folder import code_files
from railhil.scenarios.system import system_named
from railhil.study.manifest import check_same
from railhil.study.plan import batch_sha256, law_sha256

LAW = """\
from helped_law.gain import GAIN
from railhil.controller_node.ato.laws.ipfc import Ipfc


class Helped(Ipfc):
    gain = GAIN
"""


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's law whose distribution has a package with a module beside the law's, data, and a second package."""
    package, beside, about = (tmp_path / name for name in ("helped_law", "helped_tables", "helped-1.dist-info"))
    for folder in (package, beside, about):
        folder.mkdir()
    (package / "__init__.py").touch()
    (package / "law.py").write_text(LAW)
    (package / "gain.py").write_text("GAIN = 1.0\n")
    (package / "weights.bin").write_bytes(b"1")
    (beside / "__init__.py").write_text("TABLE = 1\n")
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: helped\nVersion: 1\n")
    (about / "entry_points.txt").write_text("[railhil.laws]\nhelped = helped_law.law:Helped\n")
    (about / "top_level.txt").write_text("helped_law\nhelped_tables\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    return tmp_path


def now(module: str, name: str | None = "helped") -> str:
    """The hash as another process finds it."""
    held_sha256.cache_clear()
    return held_sha256(module, None if name is None else distribution(name))


@pytest.mark.parametrize("file", ["helped_law/gain.py", "helped_law/weights.bin", "helped_tables/__init__.py"])
def test_every_file_of_the_distribution_counts(site: Path, file: str) -> None:
    before = now("helped_law.law")
    assert now("helped_law.law") == before
    (site / file).write_bytes((site / file).read_bytes() + b"\n")
    assert now("helped_law.law") != before


def test_what_python_makes_of_them_does_not_count(site: Path) -> None:
    before = now("helped_law.law")
    (site / "helped_law" / "__pycache__").mkdir(exist_ok=True)
    (site / "helped_law" / "__pycache__" / "law.cpython-311.pyc").write_bytes(b"x")
    (site / "helped-1.dist-info" / "INSTALLER").write_text("pip\n")
    assert now("helped_law.law") == before


def test_a_distribution_without_top_level_txt_has_the_files_of_its_record(site: Path) -> None:
    about = site / "helped-1.dist-info"
    (about / "top_level.txt").unlink()
    (about / "RECORD").write_text("helped_law/law.py,,\nhelped_tables/__init__.py,,\n../../bin/helped,,\n")
    before = now("helped_law.law")
    (site / "helped_tables" / "__init__.py").write_text("TABLE = 2\n")
    assert now("helped_law.law") != before


def test_a_module_and_a_folder_that_contains_itself(site: Path) -> None:
    (site / "one_file_law.py").write_text("x = 1\n")
    before = now("one_file_law", None)
    (site / "one_file_law.py").write_text("x = 2\n")
    assert now("one_file_law", None) != before
    (site / "helped_law" / "again").symlink_to(site / "helped_law")
    now("helped_law.law")


def test_a_shipped_law_has_all_modules_of_railhil() -> None:
    assert law_sha256("ipfc", "ato") == law_sha256("tdmc", "ato") == now("railhil", None)
    assert system_named("ato").law_sha256("ipfc") is None


def test_a_campaign_is_not_resumed_with_another_module_beside_the_law(site: Path) -> None:
    def identity() -> dict[str, object]:
        for cached in (law_sha256, held_sha256):
            cached.cache_clear()
        return make_plan(Request(laws=("helped",), runs=2)).identity

    before = identity()
    check_same(CAMPAIGN, site, before, identity())
    certified = system_named("ato").law_sha256("helped")
    (site / "helped_law" / "gain.py").write_text("GAIN = 2.0\n")
    with pytest.raises(InputError, match=r"campaign\.laws\[0\]\.law_sha256: found '\w{64}', allowed '\w{64}'"):
        check_same(CAMPAIGN, site, before, identity())
    assert system_named("ato").law_sha256("helped") not in (None, certified)


def test_folders_beside_the_package_are_no_part_of_it() -> None:
    for name in ("hil_tests", "docs", "requirements"):
        with pytest.raises(FileNotFoundError, match=f"railhil/{name}"):
            place_of(name)
    for name in AT_TOP:
        assert place_of(name).is_dir()


def test_the_hashed_code_is_that_of_the_package_and_has_what_judges_it() -> None:
    names = [name for name, _ in code_files()]
    assert "judge/requirements/outcome.py" in names
    assert len(batch_sha256(*OWN_CODE)) == 64
