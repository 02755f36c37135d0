"""The panel's rows of requirements and its branches in Chromium, by real clicks."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.browser import chromium_or_skip
from hil_tests.support.cli import railhil
from hil_tests.support.panel_page import WAIT_MS, said, started
from hil_tests.support.short_runs import RUN_72M_TOML

pytestmark = [pytest.mark.needs_browser, pytest.mark.slow]
_OF_THE_SCENARIO = """\
[[requirement]]
id = "A-1"
says = "never true_speed > 10 km/h"
"""
_REQUIREMENTS = """\
[[requirement]]
id = "A-2"
says = "never true_speed < 0 km/h"
[[requirement]]
id = "A-3"
says = "whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0 notch"
[[requirement]]
id = "A-4"
says = "at end true_speed < 1 km/h"
"""
_WORDS = {"kept": "✓ kept", "violated": "✕ violated", "says nothing": "– says nothing"}


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with chromium_or_skip() as found:
        yield found


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scenario of 72 m and sentences."""
    folder = tmp_path_factory.mktemp("panel")
    (folder / "short.toml").write_text(RUN_72M_TOML + _OF_THE_SCENARIO, encoding="utf-8")
    (folder / "mine.toml").write_text(_REQUIREMENTS, encoding="utf-8")
    return folder


def rows(page: Any) -> list[list[str]]:
    """Identifier, verdict, margin, instant and count of each requirement on the page."""
    table = page.evaluate(
        "[...document.querySelectorAll('#requirements tr')].map(row => [...row.children].map(cell => cell.textContent))"
    )
    return [[row[0], *row[2:]] for row in table]


def judged(folder: Path) -> list[list[str]]:
    """The same as ``score.json`` has it."""
    found = json.loads((folder / "score.json").read_text(encoding="utf-8"))["requirements"]
    return [
        [
            one["id"],
            _WORDS[one["verdict"]],
            "" if one["margin"] is None else f"{one['margin']:.4g} {one['unit']}",
            "" if one["instant_s"] is None else f"{one['instant_s']:.2f}",
            str(one["antecedent_met"]),
        ]
        for one in found
    ]


@pytest.fixture(scope="module")
def recorded(given: Path) -> Path:
    words = ["run", given / "short.toml", "--bus", "local", "--requirements", given / "mine.toml", "--no-report"]
    assert railhil(*words, "--out", given / "run").exit_code == 1
    return given / "run"


def test_the_rows_of_a_run_in_progress_end_as_those_of_its_record_which_then_has_branches(
    chromium: Any, given: Path, recorded: Path, tmp_path: Path
) -> None:
    """The log of a run grows as in a run over pipes; the run ends, and its folder becomes complete."""
    live = tmp_path / "live"
    live.mkdir()
    lines = (recorded / "frames.log").read_bytes().splitlines(keepends=True)
    half = len(lines) // 2
    page, errors = chromium.new_page(), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    words = ["panel", given / "short.toml", "--follow", live, "--requirements", given / "mine.toml", "--port", "0"]
    with (
        (live / "frames.log").open("wb", buffering=0) as log,
        started(tmp_path / "said.txt", *words, cwd=tmp_path) as (
            _,
            address,
        ),
    ):
        log.write(b"".join(lines[:half]))
        page.goto(address)
        said(page, "#requirements tr:nth-child(1)", "violated")
        said(page, "#judged .counts", "1 violated, 1 kept so far, 1 not met yet, 1 not decided yet")
        page.fill("#branch-fault", "TRN_SPEED loss for 300ms")
        page.click("#branch-make")
        said(page, "#branch-answer", "the run has not ended")
        log.write(b"".join(lines[half:]))
        said(page, "#judged .counts", "2 kept")
        assert rows(page) == judged(recorded)
        for path in recorded.iterdir():
            if path.name != "frames.log":
                (live / path.name).write_bytes(path.read_bytes())
        page.click("#requirements tr:nth-child(1)")
        page.click("#branch-make")
        told = said(page, "#branches li", "report of the branch")
        assert told.startswith(f"from {float(rows(page)[0][3]):.2f} s with TRN_SPEED loss for 300ms: ")
    page.close()
    assert errors == []


@pytest.mark.long
def test_a_run_in_real_time_is_judged_while_it_is_made(chromium: Any, given: Path) -> None:
    words = ["run", given / "short.toml", "--panel", "0", "--pace", "realtime", "--wait", "-i", "railhil"]
    page = chromium.new_page()
    with started(given / "live.txt", *words, "--no-report", "--out", given / "live") as (process, address):
        page.goto(address)
        page.wait_for_selector("#start:enabled", timeout=WAIT_MS)
        said(page, "#requirements", "A-1")
        assert [row[1] for row in rows(page)] == ["– not decided yet"]
        page.click("#start")
        said(page, "#requirements tr:nth-child(1)", "kept so far")
        said(page, "#requirements tr:nth-child(1)", "violated")
        assert said(page, "#phase", "running")
        page.click("[data-end=leave]", timeout=WAIT_MS)
        process.wait(100)
    page.close()
    (outcome,) = json.loads((given / "live" / "score.json").read_text(encoding="utf-8"))["requirements"]
    # A machine that is too busy for real time makes an INVALID run, which is not judged.
    assert outcome["verdict"] in ("violated", "not judged")


def test_from_here_with_a_fault_on_a_recorded_run(chromium: Any, given: Path, recorded: Path) -> None:
    context, errors = chromium.new_context(), []
    context.on("weberror", lambda error: errors.append(str(error.error)))
    page = context.new_page()
    with started(given / "recorded.txt", "panel", recorded, "--port", "0", cwd=given) as (_, address):
        page.goto(address)
        said(page, "#requirements", "A-4")
        assert rows(page) == judged(recorded)
        # A click on the violated sentence goes to its instant.
        page.click("#requirements tr:nth-child(1)")
        instant_s = float(rows(page)[0][3])
        assert said(page, "#branch-make", "Branch at") == f"Branch at {instant_s:.2f} s"
        page.fill("#branch-fault", "TRN_SPEED lost")
        page.click("#branch-make")
        why = said(page, "#branch-answer", "did you mean loss?")
        assert "\n" not in why
        page.locator("#instant").focus()
        page.keyboard.press("Home")
        for _ in range(4):
            page.keyboard.press("PageUp")
        begins = said(page, "#branch-make", r"Branch at [1-9]").removeprefix("Branch at ")
        page.fill("#branch-fault", "TRN_SPEED loss for 300ms")
        page.click("#branch-make")
        told = said(page, "#branches li", "report of the branch")
        assert told.startswith(f"from {begins} with TRN_SPEED loss for 300ms: FAIL: ")
        assert page.inner_text("#branch-answer") == ""
        with context.expect_page() as opened:
            page.click("#branches a")
        assert "TRN_SPEED loss" in said(opened.value, "body", "Requirements")
        made = given / page.inner_text("#branches code")
        assert json.loads((made / "certificate.json").read_text())["branched_from"]["instant_s"] == pytest.approx(
            float(begins.removesuffix(" s")), abs=0.011
        )
        everybody_can_read(chromium, address)
        # A page without the token shows all of it, and makes none.
        other = chromium.new_page()
        other.goto(address.partition("#")[0])
        said(other, "#branches li", "report of the branch")
        other.fill("#branch-fault", "TRN_SPEED loss for 300ms")
        other.click("#branch-make")
        said(other, "#branch-answer", "wrong token")
        other.close()
    context.close()
    assert errors == []


def everybody_can_read(chromium: Any, address: str) -> None:
    """The page with rows, form and a branch has no findings of axe in both schemes, and fits a telephone."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    for width_px, scheme in ((400, "dark"), (1200, "light")):
        page = chromium.new_page(color_scheme=scheme, viewport={"width": width_px, "height": 900})
        page.goto(address)
        said(page, "#branches li", "report of the branch")
        page.wait_for_function(f"document.documentElement.scrollWidth <= {width_px}", timeout=WAIT_MS)
        found = axe.run(page)
        assert found.violations_count == 0, (scheme, width_px, found.generate_report())
        page.close()
