"""A plug-in system, two carts connected by a spring, in a separate distribution: every command of railhil works on it.

Nothing in the tree depends on it: it is installed here, and railhil sees only its entry points.
"""

from __future__ import annotations

import json
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from mcap.reader import make_reader

from hil_tests.support.toy_system import SCENARIO, certificate, install_toy, python, railhil

pytestmark = [pytest.mark.loop, pytest.mark.slow]

_IN_PROCESS = """
import json, sys
from pathlib import Path
from railhil.bench import local_run
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
scenario = load_any(sys.argv[1])
law = system_named(scenario.system).law
for arithmetic in ("iq", "float64"):
    folder = Path(sys.argv[2]) / arithmetic
    folder.mkdir()
    run = local_run(scenario, folder, RunSpec(law=LawSpec(law, arithmetic)))
    quantities = [row["name"] for row in run.telemetry["quantities"]]
    print(json.dumps([run.score.verdict, run.score.values, run.frames_sha256, run.refused, quantities]))
"""


_LIVE = """
import json, sys
from pathlib import Path
from railhil.testing import Bench
from railhil.testing.settings import Settings
bench = Bench(Settings(), {"scenario": sys.argv[1]}, Path(), Path(sys.argv[2]), "toy")
run = bench.run()
with bench.start() as live:
    begun_s = live.wait_until("UNIT1_STAT", Unit1Pos=lambda metres: metres > 1, timeout_s=20)
    live.expect("UNIT2_CMD", within_s=0.1)
    passed_s = live.wait_until(position=1.5, timeout_s=20)
    whole = live.finish()
same = whole.frames_sha256 == run.frames_sha256
print(json.dumps([run.verdict, run.disturbed, run.spec.law.controller, begun_s, passed_s, same]))
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_toy(tmp_path_factory.mktemp("toy"))


@pytest.fixture(scope="module")
def recorded(site: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run folder of one run over the hub."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    done = railhil(site, "run", str(SCENARIO), "--out", str(folder), "--quiet", anew=True)
    assert done.returncode == 0, done.stderr
    assert "end" in done.stdout
    assert "apart (published)" in done.stdout
    return folder


def test_in_process_in_fixed_point_and_in_float(site: Path, recorded: Path, tmp_path: Path) -> None:
    """Both arithmetics drive the carts to their targets; in fixed point the record equals that of the hub's run."""
    runs = python(site, _IN_PROCESS, str(SCENARIO), str(tmp_path))
    for verdict, values, _, refused, quantities in runs:
        assert (verdict, refused) == ("PASS", {})
        assert 0 < values["error_m"] < 0.005
        assert {"position[0]", "position[1]", "force[0]", "force[1]", "stretch"} <= set(quantities)
    assert runs[0][2] == certificate(recorded)["frames_sha256"]
    assert runs[1][2] != runs[0][2]


def test_it_is_repeated_and_both_nodes_are_replayed(site: Path, recorded: Path) -> None:
    """The run over the hub, again in one process; each node driven by its record."""
    done = railhil(site, "rerun", str(recorded))
    assert (done.returncode, done.stdout.split(":")[0]) == (0, "same bytes"), done.stdout
    for node in ("controller", "plant"):
        done = railhil(site, "replay", str(recorded), "--node", node, "--json")
        assert done.returncode == 0, done.stdout + done.stderr
        assert json.loads(done.stdout)["same"]


def test_a_users_test_holds_its_clock(site: Path, tmp_path: Path) -> None:
    """Without a law the usual one of the system; conditions are those of its own ports and its truth."""
    ((verdict, disturbed, law, begun_s, passed_s, same),) = python(site, _LIVE, str(SCENARIO), str(tmp_path))
    assert (verdict, disturbed, law, same) == ("PASS", {}, "apart", True)
    assert 0.5 < begun_s < passed_s


def test_run_leaves_a_folder_that_says_all_of_the_system(recorded: Path) -> None:
    document = certificate(recorded)
    assert (document["system"], document["controller"], document["verdict"]) == ("two_carts", "apart", "PASS")
    assert len(str(document["system_sha256"])) == 64
    assert document["system_sha256"] != document["code_sha256"]
    header = (recorded / "signals.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header == "time_s,true_position1_m,true_position2_m,position1_m,force1_n,force2_n,stretch_m"
    cases = [case.get("name") for case in ET.parse(recorded / "junit.xml").getroot().iter("testcase")]
    assert cases == ["bench_valid", "end_error", "stop of cart 1", "stop of cart 2"]
    assert "UNIT2_CMD" in (recorded / "railhil.dbc").read_text(encoding="utf-8")
    scores = json.loads((recorded / "score.json").read_text(encoding="utf-8"))
    assert set(scores["scores"]) == {"error_m", "stretch_m"}
    assert "overspeed_mps" not in scores
    assert scores["telemetry"]["wraps"] == 0
    assert [(stop["name"], stop["verdict"]) for stop in scores["stops"]] == [
        ("of cart 1", "PASS"),
        ("of cart 2", "PASS"),
    ]


def test_a_law_that_declares_nothing_to_tune_is_refused_in_one_line(site: Path, tmp_path: Path) -> None:
    done = railhil(site, "tune", "apart", SCENARIO, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "railhil tune: command line: LAW: found 'apart', allowed a law that declares tunable parameters\n"
    )


def test_score_gives_the_same_numbers_from_the_folder_alone(site: Path, recorded: Path) -> None:
    done = railhil(site, "score", str(recorded), "--json")
    assert done.returncode == 0, done.stderr
    live = json.loads((recorded / "score.json").read_text(encoding="utf-8"))
    assert json.loads(done.stdout)["scores"] == live["scores"]


def test_a_log_alone_is_scored_with_the_scenario_that_is_named(site: Path, recorded: Path, tmp_path: Path) -> None:
    """Without the port table of a run folder, that of the scenario's system is used."""
    shutil.copy(recorded / "frames.log", tmp_path)
    done = railhil(site, "score", str(tmp_path / "frames.log"), "--scenario", str(SCENARIO), "--json")
    assert done.returncode == 0, done.stderr
    live = json.loads((recorded / "score.json").read_text(encoding="utf-8"))
    assert json.loads(done.stdout)["scores"] == live["scores"]


def test_score_of_a_limit_that_is_missed_is_a_fail(site: Path, recorded: Path, tmp_path: Path) -> None:
    """A limit affects only the judging and changes no frame: the same log is scored with a stricter scenario."""
    strict = tmp_path / "strict.toml"
    text = SCENARIO.read_text(encoding="utf-8")
    strict.write_text(text.replace("error_max_m = 0.02", "error_max_m = 1e-6"), encoding="utf-8")
    done = railhil(site, "score", str(recorded), "--scenario", str(strict))
    assert done.returncode == 1, done.stderr
    assert "end error 0.0008 m, allowed at most 1e-06 m" in done.stdout


def test_report_has_the_panel_of_the_system(site: Path, recorded: Path, tmp_path: Path) -> None:
    # In the folder, whose files the page names.
    copy = shutil.copytree(recorded, tmp_path / recorded.name)
    page = copy / "page.html"
    done = railhil(site, "report", str(copy), "--out", str(page))
    assert done.returncode == 0, done.stderr
    text = page.read_text(encoding="utf-8")
    assert text == (recorded / "report.html").read_text(encoding="utf-8")
    for said in ("Both carts over time", "12 s; allowed ±0.02 m", "1 kg and 2 kg", "Arrived", "end error"):
        assert said in text
    for foreign in ("stopping point", "notch", "Table 2 of the paper", "Runs that"):
        assert foreign not in text


def test_a_perturbed_run_draws_what_the_system_draws(site: Path, recorded: Path, tmp_path: Path) -> None:
    """The same over the hub and in one process."""
    folders = [tmp_path / "hub", tmp_path / "local"]
    for folder, bus in zip(folders, (("-i", "railhil"), ("--bus", "local")), strict=True):
        words = ("--perturbed", "--seed", "3", *bus, "--out", str(folder), "--quiet", "--no-report")
        done = railhil(site, "run", str(SCENARIO), *words)
        assert done.returncode == 0, done.stderr
    first, again = (certificate(folder)["frames_sha256"] for folder in folders)
    assert first == again != certificate(recorded)["frames_sha256"]
    assert railhil(site, "score", str(folders[0])).returncode == 0


def test_ports_of_the_system(site: Path, recorded: Path) -> None:
    done = railhil(site, "ports", "--system", "two_carts", "--dbc", str(recorded / "railhil.dbc"))
    assert done.returncode == 0, done.stderr
    assert "UNIT2_CMD" in done.stdout
    assert str(certificate(recorded)["dbc_sha256"]) in done.stdout
    assert "NOTCH_CMD" not in done.stdout


@pytest.mark.long
def test_compare(site: Path, tmp_path: Path) -> None:
    """Compares one law with two sets of parameters."""
    soft = tmp_path / "soft.toml"
    soft.write_text('law = "apart"\n[parameters]\nstiffness_n_per_m = 3.0\n', encoding="utf-8")
    folder = tmp_path / "compared"
    words = ("--parameters", str(soft), "--both", "--bus", "local", "--out", str(folder), "--quiet", "--no-report")
    done = railhil(site, "compare", str(SCENARIO), *words)
    assert done.returncode == 0, done.stderr
    rows = json.loads((folder / "compare.json").read_text(encoding="utf-8"))["runs"]
    assert [row["controller"] for row in rows] == ["apart", "apart"]
    assert rows[0]["scores"]["error_m"] < rows[1]["scores"]["error_m"]
    assert rows[0]["published"] == {"error_m": 0.001, "stretch_m": 0.2}


@pytest.mark.long
def test_campaign_goes_through_the_nodes_and_says_so(site: Path, tmp_path: Path) -> None:
    """Its figures are those of the run over the hub with the same seed."""
    folder = tmp_path / "campaign"
    words = ("--runs", "3", "--chunk", "2", "--laws", "apart", "--out", str(folder))
    done = railhil(site, "campaign", str(SCENARIO), *words)
    assert done.returncode == 0, done.stderr
    assert "no batch of trains for system two_carts: every run goes through the nodes" in done.stderr
    assert "stopped" not in done.stdout
    found = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["laws"]["apart"]
    assert set(found["scores"]) == {"error_m", "stretch_m"}
    assert found["inside"]["pass"]["runs"] == 3
    assert not {"not_stopped", "overspeeds"} & found.keys(), "what only the train of ato has"
    assert "over-" not in done.stdout
    assert all("overspeed_mps" not in run for run in found["worst"])
    again = railhil(site, "campaign", "--verify", str(folder), "--runs", "1")
    assert again.returncode == 0, again.stderr
    assert "1 of 1 runs are the same on the bench" in again.stdout


@pytest.mark.long
def test_plot_draws_the_signals_of_the_system(site: Path, recorded: Path, tmp_path: Path) -> None:
    pictures = [tmp_path / name for name in ("picture.svg", "again.svg", "picture.png")]
    for picture in pictures:
        done = railhil(site, "plot", str(recorded), "--out", str(picture))
        assert done.returncode == 0, done.stderr
    first, again, png = (picture.read_bytes() for picture in pictures)
    assert first == again
    assert png.startswith(b"\x89PNG")
    # A chart for quantities in metres, one for those in newtons, and one for the notes of the law, as on the page.
    assert first.count(b'<g id="axes_') == 3
    assert {f"<!-- {name} -->".encode() in first for name in ("true position2", "force1", "stretch")} == {True}


@pytest.mark.long
def test_export_writes_the_ports_and_signals_of_the_system(site: Path, recorded: Path, tmp_path: Path) -> None:
    done = railhil(site, "export", recorded, "--mf4", "--mcap", "--parquet", "--csv", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "run.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert {"/railhil/signals", "/telegrams/unit1_stat", "/telegrams/unit2_cmd"} <= {
        channel.topic for channel in summary.channels.values()
    }
    rows = (tmp_path / "run.csv").read_text(encoding="utf-8").splitlines()[2:]
    assert rows == (recorded / "signals.csv").read_text(encoding="utf-8").splitlines()


def test_plot_of_a_record_without_truth_is_one_line(site: Path, recorded: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(recorded, tmp_path / "run"))
    lines = (recorded / "frames.log").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "frames.log").write_text("".join(lines[:8]), encoding="utf-8")
    done = railhil(site, "plot", str(folder), "--scenario", str(SCENARIO))
    assert done.returncode == 2
    assert "TRUTH: found 0, allowed at least 2 telegrams to draw" in done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--controller", "ipfc"), "--controller: found 'ipfc', allowed apart"),
        (("--perturbed", "--set", "task.mass_spread=0"), "has nothing to draw"),
        (("--indexing", "distance"), "--indexing: found 'distance', allowed time with system two_carts"),
        (("--set", "task.mass_kg=[1, -3]"), "task.mass_kg[1]: found -3"),
        (("--set", "task.colour=3"), "task.colour: unknown key"),
        (
            ("--plant-fmu", str(SCENARIO), "--fmu-map", str(SCENARIO)),
            "system two_carts, expected a system with a part",
        ),
        (("--set", "timing.port_period_ms.NOTCH_CMD=20"), "timing.port_period_ms.NOTCH_CMD: no such port"),
    ],
)
def test_bad_input_is_one_line(site: Path, words: tuple[str, ...], said: str, tmp_path: Path) -> None:
    done = railhil(site, "run", str(SCENARIO), *words, "--out", str(tmp_path / "run"), "--quiet")
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "run").exists()


def test_a_record_whose_system_is_not_installed_is_refused(recorded: Path, tmp_path: Path) -> None:
    done = railhil(tmp_path, "score", str(recorded))
    assert done.returncode == 2
    assert "certificate.json: system: found 'two_carts', allowed one that is installed: ato" in done.stderr


def test_a_gain_that_could_wrap_is_refused_in_fixed_point(site: Path, tmp_path: Path) -> None:
    """For any system the interval analysis uses the whole range of the readings on the wire, not that of this run."""
    copy = tmp_path / "site"
    shutil.copytree(site, copy)
    law = copy / "two_carts" / "laws.py"
    text = law.read_text(encoding="utf-8")
    assert "*self._far)" in text
    law.write_text(text.replace("ar.clip(reading, *self._far)", "ar.mpy(reading, self._far[0], 0)"), encoding="utf-8")
    done = railhil(copy, "run", str(SCENARIO), "--bus", "local", "--out", str(tmp_path / "run"), "--quiet")
    assert done.returncode == 2
    assert "expected a law whose fixed point cannot wrap at 0.1 s on two_carts_2m" in done.stderr
