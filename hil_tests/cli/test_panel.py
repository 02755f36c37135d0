"""``railhil run --panel`` and ``railhil panel`` in Chromium, by real clicks."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from typing import Any

import pytest

from hil_tests.support.browser import chromium_or_skip
from hil_tests.support.panel_page import WAIT_MS, said, started
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.codes import FaultOrder, SupCommand
from railhil.bus.telegrams import SupCmd
from railhil.cli.panel import STAY_S
from railhil.common.exit_codes import FAIL, PASS
from railhil.dbc import wire_contract
from railhil.faults.language import parse
from railhil.faults.operator_values import octets_of
from railhil.record.documents import read_certificate
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.run.local import LocalRun, local_plan
from railhil.scenarios.run_spec import RunSpec

pytestmark = [pytest.mark.needs_browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with chromium_or_skip() as found:
        yield found


def press(page: Any, selector: str) -> None:
    """Press a button and wait for the answer of the run."""
    page.wait_for_selector(f"{selector}:enabled", timeout=WAIT_MS)
    page.click(selector)
    said(page, "#answer", "✓")
    if selector == "#pause":
        page.wait_for_selector("#start:enabled", timeout=WAIT_MS)


@pytest.fixture(scope="module")
def run(chromium: Any, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A run in which every button was pressed once, in the order of the page; what two pages saw."""
    folder = tmp_path_factory.mktemp("panel")
    words = [
        "run",
        # Long enough not to be over before the pace is chosen.
        "lvshun_tieshan",
        "--panel",
        "0",
        "--wait",
        "--catalogue",
        "-i",
        "railhil",
        "--no-report",
        "--out",
        folder / "run",
    ]
    seen: dict[str, Any] = {"folder": folder / "run", "requests": [], "errors": []}
    with started(folder / "output.txt", *words) as (process, address):
        page, other = chromium.new_page(), chromium.new_page()
        for one in (page, other):
            one.set_default_timeout(WAIT_MS)
            one.on("request", lambda request: seen["requests"].append(request.url))
            one.on("pageerror", lambda error: seen["errors"].append(str(error)))
        page.goto(address)
        other.goto(address.partition("#")[0])
        page.wait_for_selector("#start:enabled", timeout=WAIT_MS)
        # A loss so small does the train no harm, however long a busy machine takes from one button to the next.
        for text in ("TRN_SPEED lost", "NOTCH_CMD loss 5%"):
            page.fill("#fault", text)
            page.click("#add")
            seen[text] = said(page, "#answer", ".")
        # The other page has no token.
        seen["watching"] = said(other, "#answer", "watches"), other.locator("#orders button:enabled").count()
        seen["pace"] = page.input_value("#pace")
        page.select_option("#pace", "2")
        said(page, "#answer", "✓ pace")
        page.click("#start")
        page.wait_for_selector("#stop:enabled", timeout=WAIT_MS)
        assert page.input_value("#pace") == "2"
        page.select_option("#pace", "1")
        for selector in ("[data-do=inject]", "[data-do=clear]", "#pause", "#start"):
            press(page, selector)
        # During the run: what is prepared, with a duration, and what is not.
        for text in ("TRN_POS stuck", "TRN_POS loss"):
            page.fill("#fault", text)
            page.fill("#lasts", "0.5")
            page.click("#add:enabled")
            seen[text] = said(page, "#answer", "TRN_POS")
        # A kind that is prepared, with a number and a duration of the operator's own; the first one is out of range.
        page.click("#own summary")
        page.select_option("#own select", label="brake weak")
        for share in ("130", "62.5"):
            page.fill("#own input[data-name=share]", share)
            page.fill("#lasts", "90")
            page.click("#add:enabled")
            seen[share] = said(page, "#answer", f"brake weak {share}%")
        # Seven SUP_CMD later it acts.
        said(page, "#faults", r"clear brake weak 62\.5% \(\d\d\.\d s left")
        page.wait_for_selector("[data-do=inject]:disabled", timeout=WAIT_MS)
        seen["used"] = page.inner_text("[data-do=inject]")
        page.click("#frames tr[data-id='280']")
        page.wait_for_selector("#raw:visible", timeout=WAIT_MS)
        # The last before Stop: a train that stands after its emergency brake ends the run.
        for selector in ("#emergency", "#reset"):
            press(page, selector)
        said(page, "#events", "emergency")
        seen["speed"] = [one.inner_text("[data-column=true_speed_mps] b") for one in (page, other)]
        seen["stats"] = page.evaluate("window.stats()")
        page.click("#stop")
        seen["end"] = said(page, "#end", "Next run")
        seen["events"] = page.inner_text("#events")
        seen["report"] = page.locator("#end a").count()
        # The page without the token is told the end, too, and has no orders.
        seen["watched end"] = said(other, "#end", "ended_by_supervisor"), other.locator("#end [data-end]").count()
        page.click("[data-end=leave]")
        process.wait(60)
        for one in (page, other):
            assert said(one, "#connection", "has ended") == "■ the run has ended"
        page.close()
        other.close()
    return seen


def test_every_button_is_a_telegram(run):
    trace = trace_of(read_log(run["folder"] / "frames.log"), wire_contract())
    commands, orders = trace.raw(SupCmd.PORT, "SupCommand").tolist(), trace.raw(SupCmd.PORT, "FaultOrder").tolist()
    faults = trace.raw(SupCmd.PORT, "FaultNumber").tolist()
    sent = [(faults[at], order) for at, order in enumerate(orders) if order]
    # The faults of the run: the emergency button, the catalogue, and the one that was typed before the start.
    faults_of_run = RunSpec.from_file(run["folder"] / "certificate.json").faults
    typed, prepared = len(faults_of_run), faults_of_run.index("TRN_POS loss @manual combine id T4") + 1
    assert faults_of_run[-1] == "NOTCH_CMD loss 5% @manual combine"
    weak = next(at for at, text in enumerate(faults_of_run, start=1) if text.startswith("brake weak"))
    # The operator's own number: octets, then the fault; what was out of range sent nothing.
    own = octets_of(weak, parse(faults_of_run[weak - 1]), parse("brake weak 62.5% @manual"))
    # They may have begun again, behind the end of the fault before.
    assert [number for number, order in sent if order == FaultOrder.VALUE][-len(own) :] == [*own]
    assert (weak, FaultOrder.INJECT) in sent
    assert "found '130%', allowed share of the force that is left: 0% to 100%" in run["130"]
    assert run["62.5"] == "✓ brake weak 62.5% for 90s"
    sent = [one for one in sent if one[1] != FaultOrder.VALUE and one[0] != weak]
    assert [(number, order) for number, order in sent if number != prepared] == [
        (typed, FaultOrder.INJECT), (typed, FaultOrder.CLEAR), (1, FaultOrder.INJECT), (1, FaultOrder.CLEAR)
    ]  # fmt: skip
    assert (prepared, FaultOrder.INJECT) in sent
    assert "not prepared in this run" in run["TRN_POS stuck"]
    assert run["TRN_POS loss"] == "✓ TRN_POS loss for 0.5s"
    assert commands[0] == SupCommand.START
    assert commands[-2] == SupCommand.STOP
    assert SupCommand.NONE in commands


def test_the_certificate_makes_the_same_run_again(run, tmp_path):
    spec = RunSpec.from_file(run["folder"] / "certificate.json")
    assert spec.orders
    again = LocalRun(local_plan(spec.load(), spec, tmp_path))
    again.execute()
    assert again.log.path.read_bytes() == (run["folder"] / "frames.log").read_bytes()


def test_a_run_that_waited_begins_at_the_pace_of_the_train(run):
    assert run["pace"] == "1"


def test_who_has_no_token_is_told_so_and_has_no_orders(run):
    assert run["watching"] == ("○ this page watches: orders need the address that the command has printed", 0)
    assert run["watched end"][1] == 0


def test_a_fault_that_was_injected_cannot_be_pressed_again(run):
    assert run["used"] == "⚡ NOTCH_CMD loss 5% (used)"


def test_the_end_says_verdict_reason_folder_and_command(run):
    assert run["end"].startswith("! INVALID\n")
    assert "run ended_by_supervisor" in run["end"]
    assert str(run["folder"]) in run["end"]
    assert "railhil run lvshun_tieshan" in run["end"]
    assert "--order" in run["end"]
    # The run had --no-report.
    assert run["report"] == 0


def test_the_events_name_what_was_ordered_and_what_it_did(run):
    faults = {one["number"]: one for one in read_certificate(run["folder"])["injected"] if one["begun_s"] is not None}
    assert len(faults) >= 4
    for number, one in faults.items():
        assert f"{one['begun_s']:.2f}\t" in run["events"]
        assert f"fault {number}: {one['fault']}: " in run["events"]
    for words in ("pause", "start again", "cleared fault 1: safety_loop off", "stop"):
        assert f"operator\t{words}" in run["events"]


def everybody_can_read_the_end(page: Any) -> None:
    """It fits a telephone, and has no findings of axe in both schemes."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    for width_px, scheme in ((400, "dark"), (1200, "light")):
        page.set_viewport_size({"width": width_px, "height": 800})
        page.emulate_media(color_scheme=scheme)
        page.wait_for_function(f"document.documentElement.scrollWidth <= {width_px}", timeout=WAIT_MS)
        found = axe.run(page)
        assert found.violations_count == 0, (scheme, width_px, found.generate_report())


@pytest.mark.long
def test_the_next_run_is_made_from_the_page_in_a_folder_of_its_own(chromium, tmp_path):
    (tmp_path / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    words = ["run", tmp_path / "short.toml", "--panel", "0", "--wait", "--out", tmp_path / "run"]
    page = chromium.new_page()
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    with started(tmp_path / "output.txt", *words) as (process, address):
        page.goto(address)
        for _ in range(2):
            page.wait_for_selector("#start:enabled", timeout=WAIT_MS)
            page.click("#start")
            said(page, "#end", "Next run")
            with page.context.expect_page() as opened:
                page.click("#end a")
            opened.value.wait_for_selector("h1", timeout=WAIT_MS)
            opened.value.close()
            page.click("#end .copied button >> nth=0")
            said(page, "#end .copied button", "copied")
            assert page.evaluate("navigator.clipboard.readText()") == page.inner_text("#end .copied code >> nth=0")
            page.click("[data-end=stay]")
            page.wait_for_selector("#end .next span:empty", state="attached", timeout=WAIT_MS)
            everybody_can_read_the_end(page)
            page.press("#instant", "ArrowLeft")
            page.wait_for_selector("#live:visible", timeout=WAIT_MS)
            page.click("[data-end=next]")
            # An instant of one run is none of the next.
            page.wait_for_selector("#live", state="hidden", timeout=WAIT_MS)
        page.wait_for_selector("#start:enabled", timeout=WAIT_MS)
        assert not page.is_visible("#end")
        process.terminate()
        process.wait(60)
    page.close()
    hashes = {read_certificate(tmp_path / name)["frames_sha256"] for name in ("run", "run-2")}
    assert len(hashes) == 1


@pytest.mark.long
def test_an_end_to_which_nobody_says_anything_is_served_for_a_while(chromium, tmp_path):
    (tmp_path / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    words = ["run", tmp_path / "short.toml", "--panel", "0", "--wait", "--no-report", "--out", tmp_path / "run"]
    page = chromium.new_page()
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    with started(tmp_path / "output.txt", *words) as (process, address):
        page.goto(address)
        page.wait_for_selector("#start:enabled", timeout=WAIT_MS)
        page.click("#start")
        left_s = int(re.findall(r"served for (\d+) s more", said(page, "#end .next span", "s more"))[0])
        begun_s = time.monotonic()
        assert STAY_S - 15 < left_s <= STAY_S
        for row in page.locator("#end .copied").all():
            row.locator("button").click()
            row.locator("button", has_text="copied").wait_for(timeout=WAIT_MS)
            assert page.evaluate("navigator.clipboard.readText()") == row.locator("code").inner_text()
        copied = page.evaluate("navigator.clipboard.readText()")
        assert process.wait(2 * STAY_S) in (PASS, FAIL)
        assert time.monotonic() - begun_s == pytest.approx(left_s, abs=15)
        said(page, "#connection", "the run has ended")
        assert "the command has ended" in page.inner_text("#end .next")
    page.close()
    assert copied.startswith("railhil run ")


@pytest.mark.long
def test_the_fault_language_answers_in_one_line(run):
    assert "did you mean loss?" in run["TRN_SPEED lost"]
    assert run["NOTCH_CMD loss 5%"] == "✓ NOTCH_CMD loss 5%"


def test_the_pages_ask_nobody_else(run):
    assert run["requests"]
    assert {re.split("[/?]", url)[2].partition(":")[0] for url in run["requests"]} == {"127.0.0.1"}
    assert run["errors"] == []


@pytest.mark.long
def test_two_pages_see_the_train(run):
    assert all(re.fullmatch(r"\d+\.\d\d km/h", text) for text in run["speed"])
    assert run["stats"]["rows"] > 10


@pytest.mark.long
def test_a_killed_server_is_found_again_and_the_page_says_so(run, chromium, tmp_path):
    words = ["panel", run["folder"], "--port"]
    page = chromium.new_page()
    with started(tmp_path / "first.txt", *words, "0") as (_, address):
        page.goto(f"{address}&t=1.5")
        page.wait_for_selector("#connection.good", timeout=WAIT_MS)
        page.wait_for_function("document.querySelector('#instant').value.startsWith('1.5')", timeout=WAIT_MS)
        before = page.inner_text("[data-column=true_position_m] b")
        page.locator("#instant").focus()
        page.keyboard.press("End")
        said(page, "[data-column=true_position_m] b", f"^(?!{re.escape(before)})")
        assert "#t=" in page.url
    page.wait_for_selector("#connection.bad", timeout=WAIT_MS)
    port = re.findall(r":(\d+)", address)[0]
    with started(tmp_path / "second.txt", *words, port):
        said(page, "#connection", "again")
        assert page.evaluate("window.stats().kept[0]") > 10
        for width_px in (400, 2560):
            page.set_viewport_size({"width": width_px, "height": 900})
            beyond = "document.documentElement.scrollWidth - innerWidth"
            deadline_s = time.monotonic() + 30
            # The charts follow the width one after the other.
            while page.evaluate(beyond) > 0 and time.monotonic() < deadline_s:
                page.wait_for_timeout(50)
            assert page.evaluate(beyond) <= 0
    page.close()
