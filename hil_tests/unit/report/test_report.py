"""report.html: complete, self-contained, the same bytes for the same record, and its required content."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

from hil_tests.support.html import Reader
from hil_tests.support.recordings import SharedRuns, certified, row_of
from hil_tests.support.scores import with_values
from railhil.bus.transports import limits, limits_of
from railhil.dbc import wire_contract
from railhil.judge.record import Record, checked_record
from railhil.record.trace import Trace
from railhil.report.page import page, write_report
from railhil.report.recorded import distinct_labels
from railhil.report.styles import Style
from railhil.report.tables import rows
from railhil.systems.ato import panels as ato_panels
from railhil.systems.ato.judge.curves import curves
from railhil.systems.ato.judge.judging import JUDGING, deviations, stopped_within
from railhil.systems.ato.judge.score import score
from railhil.systems.ato.panels import Drawn
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, NotchCmd


@pytest.fixture(scope="module")
def run(published_run: SharedRuns) -> Record:
    return published_run(5, "iq")


@pytest.fixture(scope="module")
def other(published_run: SharedRuns) -> Record:
    return published_run(4, "float64")


@pytest.fixture(scope="module")
def single(run: Record) -> str:
    return page([run])


@pytest.fixture(scope="module")
def several(run: Record, other: Record) -> str:
    return page([run, other])


def read(text: str) -> Reader:
    reader = Reader()
    reader.feed(text)
    reader.close()
    assert reader.open == []
    return reader


def figures(text: str) -> dict[str, str]:
    """The charts of each figure of a page."""
    one = r'<figure id="([^"]*)">.*?<div class="wide"[^>]*>(.*?)</div>\n(?:<figcaption|</figure)'
    return dict(re.findall(one, text, re.DOTALL))


def words(text: str) -> str:
    """Text of a page with single blanks."""
    return " ".join(read(text).text.split())


@pytest.mark.slow
@pytest.mark.parametrize("which", ["single", "several"])
def test_page_is_well_formed_and_needs_nothing_else(which: str, request: pytest.FixtureRequest) -> None:
    text = request.getfixturevalue(which)
    reader = read(text)
    assert set(figures(text)) >= {"speed", "error", "stop", "notch", "force", "basis_in_use", "softening_factor"}
    for charts in figures(text).values():
        assert ET.fromstring(f"<p>{charts}</p>").findall(".//svg")
    assert [name for name, count in reader.ids.items() if count > 1] == []
    assert reader.references
    for reference in reader.references:
        assert reference.startswith("#")
        assert reference[1:] in reader.ids, reference
    assert "default-src 'none'" in text
    assert not re.search(r"<script[^>]*\bsrc\b", text)
    assert not reader.tags & {"link", "img", "iframe", "object", "embed", "base", "form"}
    assert "@import" not in text
    assert {target for target in re.findall(r"url\(([^)]*)\)", text) if not target.startswith("#")} == set()
    # What is left of addresses is the name of an XML vocabulary, which nobody opens.
    assert set(re.findall(r"https?://[^\"'\s]+", text)) == {"http://www.w3.org/2000/svg"}


@pytest.mark.slow
def test_same_record_gives_the_same_bytes(run: Record, single: str, tmp_path: Path) -> None:
    """Other folder, other wall time, other socket: the same page."""
    folder = shutil.copytree(run.folder, tmp_path / "again")
    certified(folder, transport=f"railhil:{folder}/hub.sock")
    again = checked_record(str(folder), None)
    slower = {**again.score_document, "run": {**again.score_document["run"], "wall_time_s": 99.0}}
    assert page([again.copy_with(score_document=slower)]) == single
    assert again.certificate["transport"] != run.certificate["transport"]
    assert str(run.folder.parent) not in single
    assert "wall" not in words(single)


def test_realtime_run_states_its_jitter(run: Record) -> None:
    jitter = {"cycles": 19500, "p50_ms": 0.111, "p99_ms": 0.222, "p999_ms": 0.333, "max_ms": 4.444, "late_share": 0.0}
    realtime = run.copy_with(
        certificate={**run.certificate, "pace": "realtime"},
        score_document={**run.score_document, "jitter": jitter},
    )
    found = words(page([realtime]))
    assert "lateness of 19500 cycles: p50 0.111 ms, p99 0.222 ms, p99.9 0.333 ms, max 4.444 ms" in found
    assert "9.00 s simulated in 6.25 s of wall time" in found


def test_text_of_files_is_harmless_in_the_page(lvshun: Scenario, run: Record) -> None:
    title = "<b>\x1b[2J \u202edne"
    text = page([run.copy_with(scenario=replace(lvshun, title=title))])
    assert r"&lt;b&gt;\x1b[2J \u202edne" in text
    assert not {"\x1b", "\u202e"} & set(text)


def test_facts_are_there(lvshun: Scenario, run: Record, single: str) -> None:
    found = words(single)
    for text in (
        lvshun.title,
        lvshun.sha256,
        run.certificate["frames_sha256"],
        run.certificate["code_sha256"],
        wire_contract().sha256,
        "iq (profile c28)",
        "Pacing lockstep",
        "Seed 5",
        "Transport railhil:hub.sock",
        limits()["railhil"],
        "railhil run lvshun_tieshan --controller ipfc --arithmetic iq --indexing time --seed 5 --pace lockstep",
        "least headroom 1 bit (alpha), 0 wraps, 0 saturations",
        f"{run.score.values['stop_error_m']:.4f} m short of the stopping point",
        *lvshun.assumptions,
    ):
        assert " ".join(text.split()) in found, text
    assert f"{run.verdict} {run.label}: {run.line}" in found


def test_every_deviation_from_the_paper_is_listed(lvshun: Scenario, run: Record, single: str) -> None:
    source, listed = deviations()
    assert len(listed) >= 25
    found = words(single)
    assert source in found
    for item in listed:
        assert " ".join(f"{item.at} {item.reading} {item.other}".split()) in found
    unpublished = replace(lvshun, published=())
    text = words(page([run.copy_with(scenario=unpublished)]))
    assert "Deviations" not in text
    assert "published" not in text.split("Figures")[0]


def test_measured_stands_beside_published(lvshun: Scenario, run: Record, other: Record) -> None:
    table = rows(lvshun, JUDGING.criteria, [run, other])
    assert [row.label for row in table[:2]] == [run.label, other.label]
    assert [cell.published for cell in table[0].cells] == ["262", "74075", "0.0439", "0.0464", "20.658"]
    assert table[0].cells[0].measured == f"{run.score.values['itae']:.1f}"
    assert [row.label for row in table[2:]] == ["tpfc2", "tpfc1", "tdmc", "fuzzy_pid"]
    assert table[2].cells[4].published == "24.570"
    for index, key in enumerate(("itae", "energy_kj", "punctuality_s", "stop_error_m", "comfort")):
        values = [item.score.values[key] for item in (run, other)]
        best = [row.cells[index].best for row in table[:2]]
        assert best[values.index(min(values))]
    own = rows(lvshun, JUDGING.criteria, [run.copy_with(certificate={**run.certificate, "controller": "mine"})])
    assert ({cell.published for cell in own[0].cells}, len(own)) == ({""}, 6)


@pytest.mark.slow
def test_the_page_says_how_many_runs_stopped_within_strict_figures(
    lvshun: Scenario, run: Record, other: Record
) -> None:
    """Whatever the scenario allows; a run that never stopped is within none."""
    near, far = (run.copy_with(score=with_values(run.score, stop_error_m=error)) for error in (0.1, 0.25))
    never = other.copy_with(score=with_values(other.score, stop_error_m=None))
    text = words(page([near, far, never]))
    assert "Runs that stopped within 0.1 m: 1 of 3, 0.2 m: 1 of 3, 0.3 m: 2 of 3." in text
    assert stopped_within([]) == {0.1: 0, 0.2: 0, 0.3: 0}


def test_runs_of_one_law_are_told_apart(run: Record, other: Record) -> None:
    seed = run.copy_with(certificate={**run.certificate, "seed": 9})
    law = run.copy_with(label="tdmc", certificate={**run.certificate, "controller": "tdmc"})
    assert distinct_labels([run, law]) == ["ipfc", "tdmc"]
    assert distinct_labels([run, other]) == ["ipfc iq", "ipfc float64"]
    assert distinct_labels([run, seed, law]) == ["ipfc seed 5", "ipfc seed 9", "tdmc"]
    assert distinct_labels([run, run]) == ["ipfc #1", "ipfc #2"]


@pytest.mark.parametrize(
    ("training", "trained", "label"),
    [
        (None, False, "ipfc+abababab"),
        ({"scenario": "lvshun_tieshan", "seeds": [5, 7]}, False, "ipfc+abababab tuned"),
        ({"scenario": "lvshun_tieshan", "seeds": [5, 7]}, True, "ipfc+abababab tuned (on this seed)"),
    ],
)
def test_parameters_of_a_file_are_named_and_so_is_their_training_seed(
    run: Record, training: dict[str, object] | None, trained: bool, label: str
) -> None:
    given = {"law": "ipfc", "sha256": "ab" * 32, "values": {"softening_max": 0.8}, "training": training}
    certificate = {**run.certificate, "parameters": given, "perturbed": trained, "seed_was_trained": trained}
    found = row_of(run.folder, certificate, run.scenario, run.trace, run.score)
    assert found.label == label
    text = words(page([found]))
    tuned = ", tuned on 2 runs of lvshun_tieshan" if training else ""
    assert f"from a file, digest abababab{tuned}; softening_max = 0.8" in text
    sentence = "NOT AN EVALUATION: the parameters of ipfc were tuned on this very run, seed 5."
    assert (sentence in text) == trained
    assert found.caution == (sentence[:-1] if trained else "")


@pytest.mark.slow
def test_own_parameters_say_where_they_come_from(run: Record, single: str) -> None:
    assert "the law's own (the paper's, and ours where it prints none)" in words(single)
    certificate = {**run.certificate, "seed_was_trained": True}
    designed = row_of(run.folder, certificate, run.scenario, run.trace, run.score)
    assert designed.label == "ipfc (on this seed)"
    assert "the parameters of ipfc were designed on this very run, seed 5" in words(page([designed]))
    unknown = run.copy_with(certificate={**run.certificate, "own_parameters": None})
    assert "the law's own (not recorded where they come from)" in words(page([unknown]))


@pytest.mark.slow
def test_a_run_that_is_no_evaluation_is_never_the_best(lvshun: Scenario, run: Record, other: Record) -> None:
    trained = run.copy_with(certificate={**run.certificate, "seed_was_trained": True})
    third = other.copy_with(label="third")
    for cells in zip(*(row.cells for row in rows(lvshun, JUDGING.criteria, [trained, other, third])[:3]), strict=True):
        # Two of one score are both the best; the trained run is not, whatever its score.
        assert [cell.best for cell in cells] == [False, True, True]
    assert not any(cell.best for row in rows(lvshun, JUDGING.criteria, [trained, other]) for cell in row.cells)
    assert "of the runs that are an evaluation is bold" in words(page([trained, other]))


@pytest.mark.slow
def test_without_score_json_nothing_is_said_of_the_controller(run: Record) -> None:
    assert "not recorded: score.json is missing" in words(page([run.copy_with(score_document={})]))
    silent = run.copy_with(score_document={**run.score_document, "telemetry": None})
    assert "the controller has not reported on its arithmetic" in words(page([silent]))


def kept(trace: Trace, keep: Callable[[str, int], bool]) -> Trace:
    """The telegrams of a record for whose port and time ``keep`` is true."""
    found = Trace(wire_contract())
    for port in wire_contract().ports:
        times_ns = (trace.times_s(port.name) * 1e9).round().astype(int).tolist()
        data = trace._data.get(port.name, bytearray())
        size = len(data) // max(1, len(times_ns))
        for index, time_ns in enumerate(times_ns):
            if keep(port.name, time_ns):
                found.add(port.name, time_ns, bytes(data[index * size : (index + 1) * size]))
    return found


def without(trace: Trace, *ports: str) -> Trace:
    """The record without the telegrams of some ports."""
    return kept(trace, lambda port, _: port not in ports)


def cut(trace: Trace, end_ns: int) -> Trace:
    """The record up to some time."""
    return kept(trace, lambda _, time_ns: time_ns <= end_ns)


@pytest.mark.slow
def test_laws_without_basis_and_softening_have_no_such_figure(run: Record, other: Record) -> None:
    plain = run.copy_with(label="plain", trace=without(run.trace, CtlStat.PORT))
    text = page([plain])
    assert 'id="notch"' in text
    assert not re.search('id="(basis_in_use|softening_factor)"', text)
    assert "plain" not in figures(page([plain, other]))["basis_in_use"]


def test_every_set_of_basis_functions_has_a_row_and_a_name(run: Record) -> None:
    measured = curves(run.scenario, run.trace, run.certificate["notes"])
    (basis, values), *others = measured.notes
    used = np.resize([0.0, 1.0, 2.0, 3.0, 5.0, 9.0], len(values))
    drawn = Drawn("law", Style(), replace(measured, notes=((basis, used), *others)), run.score)
    (figure,) = [one for one in ato_panels.flags(run.scenario, [drawn]) if one.name == basis.name]
    (chart,) = figure.charts
    names = ["none", "step", "wavelet", "step+wavelet", "step+ramp", "step+bits 0x8"]
    assert list(chart.y_names.values()) == names
    np.testing.assert_array_equal(chart.curves[0].y[:6], range(6))


def test_close_views_show_where_a_run_is_off(run: Record) -> None:
    """A bump of 5 km/h in each half is found, and a larger one at crawling speed is not."""
    measured = curves(run.scenario, run.trace)
    bumps = [(700.0, 5.0), (2100.0, 5.0), (2935.0, 9.0)]
    speed_kmh = measured.speed_kmh + sum(
        size * np.exp(-(((measured.position_m - place_m) / 2) ** 2)) for place_m, size in bumps
    )
    places = ato_panels.widest_places(
        run.scenario, [Drawn("law", Style(), replace(measured, speed_kmh=speed_kmh), run.score)]
    )
    assert places == pytest.approx([700.0, 2100.0], abs=4.0)


def test_a_run_without_curves_is_reported_and_not_drawn(run: Record) -> None:
    lost = run.copy_with(
        label="lost",
        trace=Trace(wire_contract()),
        score=score(run.scenario, Trace(wire_contract())),
        invalid="controller lost",
    )
    text = page([lost])
    assert "<svg" not in text
    assert "INVALID lost: controller lost" in words(text)
    assert "did not stop" in words(text)
    assert "lost" not in "".join(figures(page([run, lost])).values())


@pytest.mark.slow
def test_a_record_that_breaks_off_is_drawn_as_far_as_it_goes(run: Record, other: Record) -> None:
    until = cut(run.trace, 40_000_000_000)
    lost = run.copy_with(label="lost", trace=until, score=score(run.scenario, until), invalid="lost")
    text = page([lost, other])
    assert {"speed", "error", "stop", "notch"} <= set(figures(text))
    assert "Outside the right-hand picture: lost." in words(text)
    assert "speed" in figures(page([lost.copy_with(trace=without(until, NotchCmd.PORT))]))


@pytest.mark.slow
def test_a_stop_far_off_is_said_instead_of_drawn(run: Record) -> None:
    far = run.copy_with(label="far", score=with_values(run.score, stop_error_m=12.0))
    assert "Outside the right-hand picture: far." in words(page([run, far]))
    assert "Outside" not in words(page([run]))


@pytest.mark.slow
def test_names_are_text_whatever_they_hold(run: Record) -> None:
    odd = '<b>&"$x_1^2$ </svg>'
    text = page([run.copy_with(label=odd, scenario=replace(run.scenario, title=odd)), run.copy_with(label="b")])
    assert words(text).count(odd) >= 4
    assert read(text).tags.isdisjoint({"b>", "img"})
    assert ET.fromstring(f"<p>{figures(text)['speed']}</p>") is not None


def test_sentences_hold_no_folders(run: Record) -> None:
    line = "plant lost: railhil:/tmp/railhil-x1/hub.sock gone, /a/b/c.toml wrong, /dev/ttyACM0, 60 km/h, tcp://host:1/x"
    found = words(page([run.copy_with(invalid=line)]))
    assert "railhil:hub.sock gone, c.toml wrong, /dev/ttyACM0, 60 km/h, tcp://host:1/x" in found


@pytest.mark.parametrize(
    ("transport", "known"),
    [
        ("socketcan:vcan0", "socketcan vcan"),
        ("socketcan:can0", "socketcan can"),
        ("railhil:tcp://localhost:9", "railhil"),
        ("slcan:/dev/ttyACM0", "slcan, serial adapters"),
        ("udp_multicast:ff15::1", "udp_multicast"),
    ],
)
def test_limits_of_a_transport(transport: str, known: str) -> None:
    assert limits_of(transport) == limits()[known]
    assert "does not know" in limits_of("kvaser:0")


def test_the_page_says_when_where_and_by_whom_and_links_the_files(run: Record, other: Record, tmp_path: Path) -> None:
    told = {"utc": "2026-11-28T22:10:34Z", "host": "bench <3>", "operator": "A. Operator"}
    later = told | {"utc": "2026-11-29T01:02:03Z", "host": "vm"}
    version = run.certificate["railhil"]
    runs = [
        one.copy_with(certificate=one.certificate | {"recorded": when})
        for one, when in ((run, told), (other, later))
    ]  # fmt: skip
    write_report(runs, tmp_path / "sub folder.html")
    text = (tmp_path / "sub folder.html").read_text(encoding="utf-8")
    said = "Recorded 2026-11-28 22:10 UTC to 2026-11-29 01:02 UTC on bench <3>, vm by A. Operator with railhil "
    assert said + version in words(text)
    links = [unquote(one) for one in read(text).references if not one.startswith("#")]
    assert {(tmp_path / one).resolve() for one in links} >= {
        (one.folder / name).resolve() for one in runs for name in ("certificate.json", "frames.log", "SHA256SUMS")
    }
    assert all((tmp_path / one).exists() for one in links)
    # A certificate of an earlier version says less.
    earlier = run.copy_with(certificate={key: run.certificate[key] for key in run.certificate.keys() - {"recorded"}})
    assert f"Recorded with railhil {version}." in words(page([earlier]))


def test_contents_name_what_is_on_the_page(run: Record, single: str) -> None:
    nav = re.search(r"<nav[^>]*>(.*?)</nav>", single)
    assert nav is not None
    anchors = re.findall(r'href="#([^"]*)"', nav[1])
    headed = re.findall(r'<(?:h2|section) id="([^"]*)"', single)
    assert set(headed) == set(anchors)
    assert "files" not in anchors
