"""Results in a notebook: what a cell shows, as text and as HTML."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

import railhil
from benchmarks.figures import QUICK_TOML
from railhil.batch.case import Case
from railhil.batch.nodes import run_nodes
from railhil.bench import direct_run

#: Luminance contrast of what is no text (WCAG 2.2, 1.4.11), and grounds of notebooks.
_CONTRAST, _GROUNDS = 3.0, ("#ffffff", "#111111")


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> railhil.Outcome:
    folder = tmp_path_factory.mktemp("notebook")
    (folder / "short.toml").write_text(QUICK_TOML)
    return railhil.run(folder / "short.toml", seed=3, out=folder / "run")


def block(html: str) -> ET.Element:
    """The block of a cell as a tree: every element is closed, and nothing but its styles stands beside it."""
    styles, _, rest = html.partition("</style>")
    assert styles.startswith("<style>.railhil-cell.railhil-cell {")
    return ET.fromstring(rest)


def words(tree: ET.Element) -> str:
    return " ".join(" ".join(tree.itertext()).split())


def rows(tree: ET.Element) -> list[list[str]]:
    return [["".join(cell.itertext()) for cell in row] for row in tree.iter("tr")]


def test_a_run_shows_its_verdict_its_scores_with_units_and_a_chart(outcome: railhil.Outcome) -> None:
    tree = block(outcome._repr_html_())
    heads, *scores = rows(tree)
    assert heads[:4] == ["score", "value", "unit", "allowed"]
    for criterion, row in zip(outcome.judging.criteria, scores, strict=True):
        value = outcome.score.with_sign(criterion)
        assert row[0].removeprefix("✗ ") == criterion.title
        assert float(row[1]) == pytest.approx(value, abs=10.0**-criterion.digits)
        assert row[2] == criterion.unit_typeset
        assert row[0].startswith("✗") == bool(criterion.missed(outcome.scenario, value))
    assert outcome.verdict in words(tree)
    assert str(outcome.folder) in words(tree)
    assert all(reason in words(tree) for reason in outcome.reasons)
    charts = [one for one in tree.iter("svg") if one.get("role") == "img"]
    assert len(charts) == 1
    assert outcome.label in str(charts[0].get("aria-label"))


def test_a_cell_asks_for_nothing_and_runs_nothing(outcome: railhil.Outcome) -> None:
    html = outcome._repr_html_() + outcome.signals._repr_html_()
    assert not re.search(r"<script|<link|@import|url\(|src=|href=|https?:|\son\w+=", html)


def test_every_text_is_escaped(outcome: railhil.Outcome) -> None:
    evil = "<script>alert(1)</script>&\x1b[2J"
    html = outcome.copy_with(label=evil)._repr_html_()
    assert "<script" not in html
    assert "\x1b" not in html
    assert evil.replace("\x1b", "\\x1b") in words(block(html))


def test_a_scores_figure_is_rounded_and_in_one_line(outcome: railhil.Outcome) -> None:
    text = repr(outcome)
    assert text.startswith(f"<{outcome.verdict}: ipfc on ")
    assert all(f"{one.title} " in text and f" {one.unit}" in text for one in outcome.judging.criteria)
    for shown in (text, repr(outcome.score)):
        assert "\n" not in shown
        assert not re.search(r"\d\.\d{7}", shown)


def test_a_run_without_folder_shows_the_same(outcome: railhil.Outcome) -> None:
    made = direct_run(outcome.scenario, outcome.spec)
    tree = block(made._repr_html_())
    assert rows(tree) == rows(block(outcome._repr_html_()))
    assert repr(made) == repr(outcome).removesuffix(f"; {outcome.folder}>") + ">"


def test_signals_are_a_table(outcome: railhil.Outcome) -> None:
    heads, *columns = rows(block(outcome.signals._repr_html_()))
    assert heads == ["column", "unit", "least", "most"]
    assert [row[0] for row in columns] == list(outcome.signals)
    by_name = {name: row for name, *row in columns}
    assert by_name["time_s"][0] == "s"
    assert float(by_name["true_speed_mps"][2]) == pytest.approx(outcome.signals["true_speed_mps"].max(), rel=1e-5)


def test_a_moved_folder_is_not_named(outcome: railhil.Outcome, tmp_path: Path) -> None:
    assert outcome.copy_with(log=tmp_path / "frames.log").place == ""


def test_runs_are_compared_with_the_marks_of_the_report(outcome: railhil.Outcome, tmp_path: Path) -> None:
    other = railhil.run(outcome.spec.scenario, seed=4, out=tmp_path / "other")
    found = railhil.compare([outcome, tmp_path / "other"])
    assert [run.label for run in found.runs] == ["ipfc seed 3", "ipfc seed 4"]
    tree = block(found._repr_html_())
    heads, *lines = rows(tree)
    assert [head.startswith("absolute ") for head in heads[2:]] == [bool(one.signed) for one in found.criteria]
    assert [line[:2] for line in lines[:2]] == [[run.label, run.verdict] for run in found.runs]
    for run, line in zip((outcome, other), lines, strict=False):
        values = [run.scores[criterion.key] for criterion in found.criteria]
        for value, text, one in zip(values, line[2:], found.criteria, strict=True):
            assert float(text.removeprefix("✗ ")) == pytest.approx(value, abs=10.0**-one.digits)
    assert [one.get("role") for one in tree.iter("svg")].count("img") == 1
    assert all(text in repr(found) for line in lines for text in line)
    pytest.importorskip("pandas", reason="MISSING CAPABILITY pandas")
    assert found.to_pandas().loc["ipfc seed 4", "itae"] == other.scores["itae"]


def test_one_run_is_compared_with_the_published_scores(outcome: railhil.Outcome) -> None:
    found = railhil.compare(outcome)
    assert [run.log for run in found.runs] == [outcome.log]
    assert [run.log for run in railhil.compare(str(outcome.folder)).runs] == [outcome.log]
    with pytest.raises(railhil.InputError, match=r"^railhil.compare: runs\[1\]: found None"):
        railhil.compare([outcome, None])  # type: ignore[list-item]
    with pytest.raises(railhil.InputError, match=r"^railhil.compare: runs: found \{"):
        railhil.compare({outcome})


def test_runs_of_two_scenarios_are_not_compared(outcome: railhil.Outcome, tmp_path: Path) -> None:
    other = railhil.run(outcome.spec.scenario, settings="plan.stop_error_max_m=0.1", out=tmp_path / "other")
    with pytest.raises(railhil.InputError, match=r"scenario: found .* as in "):
        railhil.compare([outcome, other])
    assert not other.passed
    assert all(reason in repr(other) for reason in other.reasons)
    with pytest.raises(railhil.InputError, match=r"runs: empty, expected one run"):
        railhil.compare([])


@pytest.mark.long
@pytest.mark.slow
def test_a_campaign_shows_the_tables_of_the_terminal_and_the_distributions(
    outcome: railhil.Outcome, tmp_path: Path
) -> None:
    found = railhil.campaign(outcome.spec.scenario, laws=["ipfc", "ipfc_plus"], runs=3, out=tmp_path / "campaign")
    assert re.fullmatch(
        r"<3 perturbed runs of .*: ipfc PASS [\d.]+%, ipfc_plus PASS [\d.]+%; .*/campaign>", repr(found)
    )
    tree = block(found._repr_html_())
    tables = ["".join(one.itertext()) for one in tree.iter("caption")]
    assert tables[0] == "Scores"
    assert tables[-1] == "Against ipfc, run by run on the same seeds"
    charts = [one for one in tree.iter("svg") if one.get("role") == "img"]
    # A law whose runs lie in a small part of an axis has a chart of its own beside it.
    laws = 2
    assert len(found.criteria) <= len(charts) <= (1 + laws) * len(found.criteria)
    median = next(row for row in rows(tree) if row[1:3] == ["time error", "s"])[3]
    assert float(median) == pytest.approx(sorted(found.runs("ipfc")["punctuality_s"])[1], abs=1e-3)
    with pytest.raises(KeyError, match="did you mean ipfc_plus"):
        found.runs("ipfc_pls")


def test_a_batch_shows_its_verdicts_and_the_range_of_each_score(outcome: railhil.Outcome) -> None:
    batch = run_nodes(Case(outcome.scenario, outcome.spec.law), [1, 2, 3])
    assert repr(batch).startswith(f"3 runs: {batch.verdicts[0]}")
    heads, *lines = rows(block(batch._repr_html_()))
    assert heads == ["score", "least", "median", "most"]
    assert [line[0] for line in lines] == [f"{one.title} ({one.unit_typeset})" for one in outcome.judging.criteria]
    for line, values in zip(lines, batch.values.values(), strict=True):
        assert [float(text) for text in line[1:]] == pytest.approx(sorted(values), rel=1e-5)


def luminance(colour: str) -> float:
    """Relative luminance (WCAG 2.2) of ``#rrggbb`` or ``#rgb``."""
    digits = colour[1:] if len(colour) == 7 else "".join(2 * digit for digit in colour[1:])
    parts = [int(digits[at : at + 2], 16) / 255 for at in (0, 2, 4)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_curves_are_seen_on_a_light_and_on_a_dark_ground(outcome: railhil.Outcome) -> None:
    """A notebook's theme is not the system's: no colour depends on it but through the colour of the text."""
    colours = dict(re.findall(r"--rc-(\w+): *([^;]+);", outcome._repr_html_()))
    curves = {name: colour for name, colour in colours.items() if name in {*"0123456", "fault"}}
    assert len(curves) == 8
    for name, colour in curves.items():
        for ground in _GROUNDS:
            if colour != "currentColor":
                lighter, darker = sorted((luminance(colour), luminance(ground)), reverse=True)
                assert (lighter + 0.05) / (darker + 0.05) >= _CONTRAST, (name, colour, ground)
    assert all("currentColor" in colours[name] for name in ("ink", "dim", "line", "target"))
