"""The report in a browser: nothing is fetched, nothing exceeds the page, no overlapping text."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.browser import TEXTS_OF_CHARTS, asked
from hil_tests.support.recordings import SharedRuns
from railhil.report.page import write_report


@pytest.fixture(scope="module")
def reports(published_run: SharedRuns, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")
    runs = [published_run(5, "iq"), published_run(4, "float64")]
    # Every law with its own and with tuned parameters, names as long as they get.
    laws = ("ipfc", "tpfc2", "tpfc1", "tdmc", "fuzzy_pid", "ipfc_plus", "ipfc_plus_stop")
    labels = [(law, law + tail) for law in laws for tail in ("", "+1a2b3c4d tuned (on this seed)")]
    many = [
        runs[index % 2].copy_with(label=label, certificate={**runs[index % 2].certificate, "controller": law})
        for index, (law, label) in enumerate(labels)
    ]
    found = {"one": folder / "one.html", "many": folder / "many.html"}
    write_report(runs[:1], found["one"])
    write_report(many, found["many"])
    return found


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.needs_browser
@pytest.mark.parametrize("name", ["one", "many"])
@pytest.mark.parametrize("width_px", [1100, 560])
def test_page_as_shown(reports: dict[str, Path], name: str, width_px: int) -> None:
    found: dict[str, Any] = asked(reports[name], TEXTS_OF_CHARTS, width_px)
    assert found["fetched"] == []
    assert (found["overlaps"], found["outside"]) == ([], [])
    assert found["beyond"] == 0
    assert found["figures"] >= 14
    assert found["texts"] > 60
    if width_px >= 1000:
        assert found["table"] == 0


@pytest.mark.slow
@pytest.mark.needs_browser
def test_the_question_notices_what_is_wrong(reports: dict[str, Path], tmp_path: Path) -> None:
    text = reports["one"].read_text(encoding="utf-8")
    wrong = '<img src="https://example.invalid/a.png" alt=""><div style="width: 3000px">wide</div></body>'
    broken = tmp_path / "broken.html"
    # All tick labels of an axis in one place, and one text left of the picture.
    text = re.sub(r'(<text[^>]*?) x="[^"]*"', r'\1 x="54"', text)
    text = text.replace("<text ", '<text dx="-400" ', 1)
    broken.write_text(text.replace("</body>", wrong), encoding="utf-8")
    found = asked(broken, TEXTS_OF_CHARTS)
    assert found["beyond"] > 1000
    # Refused by the page's own policy and by that of the test.
    assert found["fetched"] == ["https://example.invalid/a.png"] * 2
    assert ["500", "1000"] in found["overlaps"]
    assert "0" in found["outside"]
