"""``railhil audit`` as a user runs it: tables, JSON, exit codes, one line for bad input."""

from __future__ import annotations

import json

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from hil_tests.support.plug import Wrapping, plug_in
from railhil.audit import __main__ as command

KEYS = {
    "scenario",
    "scenario_sha256",
    "controller",
    "arithmetic",
    "indexing",
    "seed",
    "runs",
    "met",
    "bars",
    "ranges",
    "bounds",
    "errors",
    "commands",
    "floor",
    "scores",
    "effect",
    "effect_counters",
    "standstill",
    "cost",
    "coarse_constants",
}
HEADINGS = (
    "Range and headroom",
    "Error of iq against float64",
    "Rounded (rmpy) and floored (mpy) products",
    "Scores of the run",
    "Medians of 4 perturbed runs",
    "Cycles of one control period",
    "Train held for 60 s",
    "Constants rounded",
    "Limits",
)


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return path


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_an_audit_from_the_command_line(short, tmp_path):
    done = railhil("audit", short, "--runs", "4", cwd=tmp_path)
    assert done.exit_code == 0, done.out + done.err
    assert done.said == []
    assert max(map(len, done.out.splitlines())) <= 100
    positions = [done.out.index(heading) for heading in HEADINGS]
    assert positions == sorted(positions)
    assert done.out.rstrip().endswith("all limits met")
    assert [path.name for path in tmp_path.iterdir()] == ["short.toml"]


@pytest.mark.slow
@pytest.mark.loop
def test_json_of_an_audit_is_all_that_is_printed(short, tmp_path):
    done = railhil("audit", short, "--runs", "4", "--json", cwd=tmp_path)
    assert (done.exit_code, done.said) == (0, [])
    found = json.loads(done.out)
    assert set(found) == KEYS
    assert found["met"] is True
    assert (found["runs"], found["arithmetic"], found["indexing"]) == (4, "iq", "time")
    assert [one["score"] for one in found["effect"]] == [
        "itae",
        "energy_kj",
        "punctuality_s",
        "stop_error_m",
        "comfort",
    ]
    for codes in (found["commands"], found["floor"]["commands"]):
        assert list(codes) == ["notch"]
        assert (codes["notch"]["q"], codes["notch"]["unit"]) == (8, "notch")
    for part in ("ranges", "errors"):
        assert {"speed", "notch"} <= {row["name"] for row in found[part]}


def test_a_missed_bar_is_exit_code_1(short, tmp_path, capsys, monkeypatch):
    plug_in(tmp_path, monkeypatch, wrapping=Wrapping)
    assert command.main([str(short), "--controller", "wrapping", "--runs", "0"]) == 1
    out = capsys.readouterr().out
    assert "FAIL" in out
    assert out.rstrip().endswith("NOT all limits met")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "nowhere"),
        (["--controller", "ipcf"], "did you mean ipfc?"),
        (["--arithmetic", "iq32"], "found iq32, allowed float32, "),
        (["--arithmetic", "float64"], "--arithmetic"),
        (["--runs", "-1"], "found -1, allowed 0..100000"),
        (["--runs", "many"], "found many, allowed 0..100000"),
        (["--seed", "4294967296"], "found 4294967296, allowed 0..4294967295"),
        (["--frobnicate"], "--frobnicate"),
    ],
)
def test_bad_input_is_one_line(arguments, words, tmp_path):
    done = railhil("audit", *arguments, cwd=tmp_path)
    assert done.exit_code == 2
    assert done.out == ""
    assert words in done.one_line()
    assert done.one_line().startswith("railhil audit: ")
    assert not list(tmp_path.iterdir())


def test_the_help_says_what_the_exit_codes_mean(tmp_path):
    done = railhil("audit", "--help", cwd=tmp_path)
    assert done.exit_code == 0
    assert "a limit is missed" in done.out
