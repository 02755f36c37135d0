"""Other versions beside this one, and a campaign that is killed."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import against, killed_campaign
from benchmarks.figures import MeasurementError
from benchmarks.memory import Peak

TOP = Path(__file__).resolve().parents[3]
#: Stands for an older railhil: knows one of the wished options and writes what the comparison reads.
OLDER = """
import json, pathlib, sys
words = sys.argv[1:]
if "--help" in words:
    print("--quiet")
elif "--no-report" in words:
    sys.exit(2)
elif words[0] == "score":
    sys.exit(SCORE["run"].get("scored", 0))
else:
    out = pathlib.Path(words[words.index("--out") + 1])
    out.mkdir()
    (out / "frames.log").write_bytes(out.name.encode())
    (out / "score.json").write_text(json.dumps(SCORE))
"""


def older(folder: Path, score: dict[str, object]) -> against.Version:
    package = folder / "tree" / "railhil"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "cli.py").write_text(f"SCORE = {json.dumps(score)}\n{OLDER}")
    (package.parent / "pyproject.toml").write_text(
        '[project]\nversion = "0.0.1"\n[project.entry-points."railhil.laws"]\nipfc = "railhil.cli:SCORE"\n'
    )
    return against.version_of(str(package.parent), folder)


def test_an_older_version_is_given_only_the_options_that_it_has(tmp_path):
    version = older(
        tmp_path, {"run": {"speed_factor": 50.0, "wall_time_s": -4.0, "transport": "railhil:/tmp/hub.sock"}}
    )
    against.describe(version, tmp_path)
    assert version.options == ["--quiet"]
    against.run_once(version, "line", tmp_path / "a")
    against.run_once(version, "line", tmp_path / "b")
    assert (version.factors, version.transports, len(version.hashes)) == ([50.0, 50.0], {"railhil:hub"}, 2)
    # What a command takes beside the loop; here the loop is said to have taken less than nothing.
    assert [taken_s > 4.0 for taken_s in version.rest_s] == [True, True]
    assert [taken_s > 0.0 for taken_s in version.score_s] == [True, True]


def test_a_version_that_cannot_score_its_own_run_is_no_measurement(tmp_path):
    version = older(tmp_path, {"run": {"speed_factor": 50.0, "wall_time_s": 4.0, "scored": 4}})
    with pytest.raises(MeasurementError, match="exit code 4: no message"):
        against.run_once(version, "line", tmp_path / "a")


def test_a_run_for_memory_gives_its_peak_and_no_speed(tmp_path):
    version = older(tmp_path, {"run": {"speed_factor": 50.0, "wall_time_s": 4.0}})
    against.weigh_once(version, "line", tmp_path / "a")
    (peak,) = version.peaks
    ((name, part_mb),) = peak.parts
    # An interpreter takes more than that.
    assert (name, part_mb > 1) == ("railhil.cli", True)
    assert (version.factors, len(version.hashes)) == ([], 1)
    version.options = ["--no-report"]
    with pytest.raises(MeasurementError, match="exit code 2: no message"):
        against.weigh_once(version, "line", tmp_path / "b")


def test_memory_is_compared_with_that_of_this_version(tmp_path):
    versions = [against.Version(name, sys.executable, {}) for name in ("older", "this version")]
    for version, parts in zip(versions, ((("plant", 50.0), ("hub", 30.0)), (("plant", 40.0),)), strict=True):
        version.factors, version.rest_s, version.score_s, version.cpu_s = [100.0], [1.0], [0.5], [2.0]
        version.peaks = [Peak(parts), Peak((("plant", 20.0),))]
    lines = against._lines(versions)
    assert "  start, end 1.00 s, median (1.00 to 1.00), before the first frame and after the last one together" in lines
    assert "  score      0.50 s, median (0.50 to 0.50), railhil score of the run" in lines
    assert "  memory     50.0 MB, peak of all processes together, median of 2 (20.0 to 80.0)" in lines
    assert "  of it      plant 50.0, hub 30.0" in lines
    assert [line for line in lines if "memory," in line] == [
        "  ratio      this version takes 0.60 times the memory, ratio of the medians"
    ]


@pytest.mark.long
@pytest.mark.slow
def test_this_version_beside_itself(capsys):
    assert against.work([str(TOP), "--pairs", "1", "--quick"]) == 0
    lines = capsys.readouterr().out.splitlines()
    hashes = [line for line in lines if "frames.log" in line]
    assert len(hashes) == 2
    assert hashes[0] == hashes[1]
    assert any("this version is" in line for line in lines)
    assert len([line for line in lines if "peak of all processes" in line]) == 2
    assert any("times the memory" in line for line in lines)


#: Stands for the campaign command: a part every 20 ms, and with all parts the results.
CAMPAIGN = """
import pathlib, sys, time
words = sys.argv[1:]
out = pathlib.Path(words[words.index("--resume" if "--resume" in words else "--out") + 1])
(out / "parts").mkdir(parents=True, exist_ok=True)
for k in range(10):
    path = out / "parts" / f"{k}.parquet"
    if not path.exists():
        time.sleep(0.02)
        path.write_bytes(bytes([k]))
(out / "results.parquet").write_bytes(b"".join(path.read_bytes() for path in sorted((out / "parts").iterdir())))
"""


def test_a_killed_campaign_is_compared_with_an_undisturbed_one(tmp_path, monkeypatch):
    """That campaigns go on with the same bytes is tested in unit/campaign."""

    def started(words):
        command = [sys.executable, "-c", CAMPAIGN, *words]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)

    monkeypatch.setattr(killed_campaign, "_campaign", started)
    found = killed_campaign.measure(tmp_path, [], kills=1, longest_s=0.0)
    assert found.same
    assert found.parts == 10
    assert 0 < found.parts_at_kill[-1] < 10
