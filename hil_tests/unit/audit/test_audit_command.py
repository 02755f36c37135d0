"""``railhil audit`` as a user runs it: tables, JSON, exit codes, one line for bad input."""

from __future__ import annotations

import json

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from railhil.audit import __main__ as command
from railhil.audit.result import Bar, audit

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
    "notch",
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
    "Bars",
)


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return path


@pytest.mark.loop
def test_an_audit_from_the_command_line(short, tmp_path):
    file = tmp_path / "audit.json"
    done = railhil("audit", short, "--runs", "4", "--json", file, cwd=tmp_path)
    assert done.exit_code == 0, done.out + done.err
    assert done.err == ""
    assert max(map(len, done.out.splitlines())) <= 100
    positions = [done.out.index(heading) for heading in HEADINGS]
    assert positions == sorted(positions)
    assert done.out.rstrip().endswith("all bars met")
    found = json.loads(file.read_text())
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
    for part in ("ranges", "errors"):
        assert {"speed", "notch"} <= {row["name"] for row in found[part]}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["audit.json", "short.toml"]


def test_a_missed_bar_is_exit_code_1(short, capsys, monkeypatch):
    def spoiled(*given):
        result = audit(*given)
        result.bars.append(Bar("a demand", "7", "0", False))
        return result

    monkeypatch.setattr(command, "audit", spoiled)
    monkeypatch.setattr("sys.argv", ["audit", str(short), "--runs", "0"])
    assert command.main() == 1
    out = capsys.readouterr().out
    assert "FAIL" in out
    assert out.rstrip().endswith("NOT all bars met")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "nowhere"),
        (["--controller", "ipcf"], "did you mean ipfc?"),
        (["--arithmetic", "iq32"], "'iq32'"),
        (["--arithmetic", "float64"], "--arithmetic"),
        (["--runs", "-1"], "found -1, allowed 0..100000"),
        (["--runs", "many"], "found many, allowed 0..100000"),
        (["--seed", "4294967296"], "found 4294967296, allowed 0..4294967295"),
        (["--json", "/nowhere/audit.json"], "--json: found '/nowhere/audit.json', allowed a file that can be written"),
        (["--json", "."], "is a directory"),
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


def test_a_file_that_fails_later_is_one_line_and_leaves_nothing(short, tmp_path, monkeypatch):
    def gone(*given):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", gone)
    monkeypatch.setattr("sys.argv", ["audit", str(short), "--runs", "0", "--json", str(tmp_path / "a.json")])
    with pytest.raises(Exception, match=r"--json: .*no space left on device") as caught:
        command.main()
    assert caught.value.exit_code == 2
    assert [path.name for path in tmp_path.iterdir()] == ["short.toml"]


def test_the_help_says_what_the_exit_codes_mean(tmp_path):
    done = railhil("audit", "--help", cwd=tmp_path)
    assert done.exit_code == 0
    assert "a bar is missed" in done.out
