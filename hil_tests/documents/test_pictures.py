"""The pictures of the pages show the bench as it is."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from PIL import Image

from hil_tests.documents.diagrams import DIAGRAMS
from hil_tests.documents.pages import PAGES
from hil_tests.documents.pictures import FOLDER, PHOTOGRAPHS, photographs, words_of
from hil_tests.support.paths import ROOT

_ANEW = "python -m hil_tests.documents.pictures"
_PICTURE_MAX_BYTES = 130_000


@pytest.mark.slow
@pytest.mark.parametrize("name", DIAGRAMS)
def test_a_diagram_is_that_of_the_tables(name: str) -> None:
    assert (FOLDER / name).read_text(encoding="utf-8") == DIAGRAMS[name](), _ANEW


def test_pictures_are_small_and_are_shown() -> None:
    pages = "".join((ROOT / page).read_text(encoding="utf-8") for page in PAGES)
    for path in FOLDER.iterdir():
        assert f"pictures/{path.name})" in pages, path.name
        assert path.stat().st_size < _PICTURE_MAX_BYTES, path.name


def test_every_text_is_inside_of_its_diagram() -> None:
    for name in DIAGRAMS:
        root = ET.parse(FOLDER / name).getroot()
        _, _, width, height = map(float, root.attrib["viewBox"].split())
        for text in root.iter("{http://www.w3.org/2000/svg}text"):
            assert 0 < float(text.attrib["x"]) < width, (name, text.text)
            assert 0 < float(text.attrib["y"]) < height, (name, text.text)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.needs_browser
def test_a_photograph_shows_the_page_of_today(tmp_path: Path) -> None:
    pytest.importorskip("playwright.sync_api", reason="MISSING CAPABILITY playwright")
    seen = list(photographs(tmp_path / "broken"))
    assert {name for name, _, _ in seen} == set(PHOTOGRAPHS)
    for name, words, _ in seen:
        assert len(words) > 10
        assert words_of(FOLDER / name) == words, _ANEW
        with Image.open(FOLDER / name) as image:
            assert image.size == (1000, 840)
