"""The plugin for users' tests: fixtures, options, markers, health, JUnit, requirements."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.short_runs import RUN_2M_TOML
from hil_tests.support.user_suite import properties, run_suite
from railhil.testing.settings import OPTIONS, Settings, settings_from

pytest_plugins = "pytester"

SUITE = """
import pytest
from railhil.testing import kmh

pytestmark = pytest.mark.railhil(scenario="short.toml", controller="ipfc_plus")

@pytest.mark.requirement("ATO-12", "ATO-13")
def test_stops_at_the_board(bench, seed):
    run = bench.run(seed=seed, perturbed=True)
    assert run.passed, run.reasons
    assert abs(run.score.stop_error_m) <= 2.0
    assert [stop.error_m for stop in run.stops] == [run.score.stop_error_m]
    assert run.spec.law.controller == "ipfc_plus"

@pytest.mark.requirement("ATO-13")
@pytest.mark.railhil(arithmetic="float64")
def test_two_runs(bench):
    assert bench.run().frames_sha256 != bench.run(controller="ipfc").frames_sha256
"""


@pytest.fixture
def suite(pytester: pytest.Pytester) -> pytest.Pytester:
    """A folder with a short scenario and a suite."""
    pytester.path.joinpath("short.toml").write_text(f"{RUN_2M_TOML}stop_error_max_m = 2\ntime_error_max_s = 2\n")
    pytester.makepyfile(test_suite=SUITE)
    return pytester


def test_the_plugin_loads_no_library() -> None:
    """pytest imports it in every session of an environment with railhil."""
    code = (
        "import sys, pytest; before = set(sys.modules); import railhil.pytest_plugin\n"
        "print(*(set(sys.modules) - before))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    found = set(done.stdout.split())
    heavy = ("numpy", "scipy", "can", "pydantic", "rich", "railhil.bus", "railhil.library", "railhil.scenarios")
    assert not {name for name in found if name.partition(".")[0] in heavy or name in heavy}
    assert "railhil.testing.settings" in found


@pytest.mark.slow
def test_a_suite_and_its_report(suite: pytest.Pytester) -> None:
    done = run_suite(
        suite.path,
        "--railhil-seeds",
        "3,5-6",
        "--railhil-runs",
        "kept",
        "--junitxml=junit.xml",
        "-o",
        "junit_family=xunit2",
    )
    done.assert_outcomes(passed=4)
    done.stdout.fnmatch_lines(
        ["*requirements (railhil)*", "ATO-12  PASSED     3 of 3 tests passed", "ATO-13 * 4 of 4 *"]
    )
    found = properties(suite.path / "junit.xml")
    assert sorted(found) == [*(f"test_stops_at_the_board[seed{seed}]" for seed in (3, 5, 6)), "test_two_runs"]
    one = dict(found["test_stops_at_the_board[seed5]"])
    assert one.keys() == {
        "requirement", "scenario", "controller", "arithmetic", "seed", "verdict", "frames_sha256", "certificate",
    }  # fmt: skip
    assert (one["scenario"], one["seed"], one["verdict"]) == ("short", "5", "PASS")
    assert [value for name, value in found["test_stops_at_the_board[seed5]"] if name == "requirement"] == [
        "ATO-12",
        "ATO-13",
    ]
    certificate = json.loads(Path(one["certificate"]).read_text())
    assert certificate["frames_sha256"] == one["frames_sha256"]
    assert Path(one["certificate"]).parent == suite.path / "kept/test_suite.test_stops_at_the_board_seed5"
    assert (Path(one["certificate"]).parent / "frames.log").is_file()
    two = dict(found["test_two_runs"])
    assert (two["controller"], two["controller.2"], two["arithmetic"]) == ("ipfc_plus", "ipfc", "float64")
    rows = (suite.path / "kept/requirements.csv").read_text().splitlines()
    assert rows[0] == "requirement,verdict,test,outcome,margin,unit,instant_s,antecedent_met"
    assert len(rows) == 1 + 3 + 4


@pytest.mark.long
@pytest.mark.slow
def test_over_processes_of_xdist(suite: pytest.Pytester) -> None:
    """Properties and table are those of a session in one process; folders of equal names do not meet.

    A wrong marker, which ends a session in one process, is an error of its test.
    """
    suite.makepyfile(test_wrong="import pytest\n@pytest.mark.requirement\ndef test_nothing(): pass\n")
    words = ("--railhil-seeds", "3,4", "--junitxml=junit.xml", "-o", "junit_family=xunit2")
    done = run_suite(suite.path, "-n", "2", *words)
    done.assert_outcomes(passed=3, errors=1)
    done.stdout.fnmatch_lines(["*marker requirement: allowed one or more names*"])
    done.stdout.fnmatch_lines(["ATO-13 * 3 of 3 *"])
    assert "Warning" not in done.stdout.str()
    found = properties(suite.path / "junit.xml")
    assert len(found) == 4
    for name in found.keys() - {"test_nothing"}:
        folder = Path(dict(found[name])["certificate"]).parent
        assert [path.name for path in folder.iterdir()] == ["certificate.json"], name


@pytest.mark.slow
def test_the_runs_of_a_test_are_judged_by_the_sentence_that_it_requires(suite: pytest.Pytester) -> None:
    suite.makepyfile(
        test_suite="""
        import pytest

        pytestmark = pytest.mark.railhil(scenario="short.toml", controller="ipfc_plus")

        @pytest.mark.requirement("A-1", requires="never true_speed < 0 km/h")
        def test_kept(bench):
            assert [one.kept for one in bench.run().outcome.requirements.values()] == [True]
        @pytest.mark.requirement("A-2", requires="always true_speed <= 1 km/h")
        def test_violated(bench):
            bench.run()
        @pytest.mark.requirement("A-3", requires="whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0")
        def test_not_shown(bench):
            assert bench.run().passed
        @pytest.mark.requirement("A-3", requires="whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0")
        def test_shown_by_hand(bench):
            with bench.start(faults=["TRN_SPEED loss @1s for 90ms"]) as live:
                live.finish()
        @pytest.mark.requirement("A-4", requires="never true_speed < 0 km/h")
        def test_without_a_run():
            pass
        """
    )
    done = run_suite(suite.path, "--railhil-runs", "kept", "-rA")
    done.assert_outcomes(passed=2, failed=3)
    done.stdout.fnmatch_lines_random(
        [
            "requirement A-2: always true_speed <= 1 km/h: violated, margin * m/s at * s (run folder */kept/*)",
            "NOT SHOWN: requirement A-3: whenever age(TRN_SPEED) > 64 ms, *: its antecedent was never met in 1 run",
            "NOT SHOWN: requirement A-4: never true_speed < 0 km/h: the test has finished no run",
            "A-1  PASSED     1 of 1 tests passed",
            "A-2  FAILED     0 of 1 tests passed",
            "A-3  PASSED     1 of 2 tests passed",
            "     not shown: *::test_not_shown",
            "A-4  NOT SHOWN  0 of 1 tests passed",
        ]
    )
    with (suite.path / "kept/requirements.csv").open() as stream:
        rows = {row["test"].partition("::")[2]: row for row in csv.DictReader(stream)}
    assert (rows["test_kept"]["margin"], rows["test_kept"]["unit"]) == ("0.0", "m/s")
    assert float(rows["test_violated"]["margin"]) < 0 < float(rows["test_violated"]["instant_s"])
    assert [rows[f"test_{name}"]["antecedent_met"] for name in ("not_shown", "shown_by_hand")] == ["0", "1"]
    assert rows["test_without_a_run"]["margin"] == ""


@pytest.mark.slow
def test_faults_of_a_suite(suite: pytest.Pytester) -> None:
    """Faults in ids, in the JUnit report and in the marker; what they disturb is no error of the test."""
    suite.makepyfile(
        test_suite="""
        import pytest

        pytestmark = pytest.mark.railhil(scenario="short.toml", controller="ipfc_plus")

        @pytest.mark.parametrize("fault", ["TRN_SPEED loss @1s for 200ms", "controller kill @v>1km/h"])
        def test_train_is_safe(bench, fault):
            run = bench.run(faults=[fault])
            assert run.faults[0].fired
            assert run.reaction("TRACTION CUT").after_s(fault) <= 0.5

        @pytest.mark.railhil(faults=["TRN_SPEED loss 5% @0s"])
        def test_noisy(bench):
            assert bench.run().faults[0].hits > 5
        """
    )
    done = run_suite(suite.path, "-v", "--junitxml=junit.xml")
    done.assert_outcomes(passed=3)
    done.stdout.fnmatch_lines(["*test_train_is_safe[[]TRN_SPEED_loss_@1s_for_200ms] PASSED*"])
    found = properties(suite.path / "junit.xml")
    assert dict(found["test_train_is_safe[controller_kill_@v>1km/h]"])["fault"] == "controller kill @v>1km/h"


@pytest.mark.long
@pytest.mark.slow
def test_the_same_suite_over_a_hub(suite: pytest.Pytester) -> None:
    """Three processes instead of one: the same bytes; nobody can hold their clock."""
    suite.makepyfile(
        test_suite="""
        import railhil

        def test_run(bench):
            run = bench.run(scenario="short.toml", seed=4)
            assert run.certificate["transport"].startswith("railhil:")
            assert run.frames_sha256 == railhil.run("short.toml", seed=4).frames_sha256

        def test_live(bench):
            bench.start(scenario="short.toml")
        """
    )
    done = run_suite(suite.path, "--railhil-bus", "hub")
    done.assert_outcomes(passed=1, failed=1)
    done.stdout.fnmatch_lines(["*bench.start: bus: found 'hub', allowed local*"])


@pytest.mark.slow
def test_a_failed_test_keeps_its_folder_and_attaches_the_report(suite: pytest.Pytester) -> None:
    suite.makepyfile(
        test_suite="""
        import pytest

        @pytest.mark.requirement("ATO-1")
        def test_strict(bench):
            run = bench.run(scenario="short.toml", settings={"plan.stop_error_max_m": 0.0001})
            assert run.passed, run.reasons
        """
    )
    done = run_suite(suite.path)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["run folder *: FAIL not stopped*", "[[][[]ATTACHMENT|*report.html]]"])
    done.stdout.fnmatch_lines(["ATO-1  FAILED     0 of 1 tests passed", "*failed: test_suite.py::test_strict"])
    attached = next(line for line in done.stdout.lines if line.startswith("[[ATTACHMENT|"))
    report = Path(attached.removeprefix("[[ATTACHMENT|").removesuffix("]]"))
    assert report.is_absolute()
    assert (report.parent / "frames.log").is_file()
    assert "<p>Test test_suite.py::test_strict, which shows requirement ATO-1: failed.</p>" in report.read_text()


@pytest.mark.slow
def test_health_is_asserted_after_each_test(suite: pytest.Pytester) -> None:
    """The counters are changed after the run: nothing is lost in a run of this process."""
    suite.makepyfile(
        test_suite="""
        import json
        import pytest

        def lossy(bench):
            run = bench.run(scenario="short.toml")
            path = run.folder / "score.json"
            score = json.loads(path.read_text())
            score["run"]["counters"]["wrong_check_sequence"] = 3
            path.write_text(json.dumps(score))

        def test_silent(bench):
            lossy(bench)

        @pytest.mark.expect_loss
        def test_expected(bench):
            lossy(bench)
        """
    )
    done = run_suite(suite.path)
    done.assert_outcomes(passed=2, errors=1)
    done.stdout.fnmatch_lines(["*frames were lost, refused or out of order*wrong_check_sequence 3*"])


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("marker", "line"),
    [
        ("railhil('short.toml')", "marker railhil: found 'short.toml', allowed scenario="),
        ("railhil(law='ipfc')", "marker railhil: found law=, allowed scenario="),
        ("requirement()", "marker requirement: allowed one or more names"),
        ("requirement(12)", "marker requirement: allowed one or more names"),
        ("requirement('A-1', needs='x')", "marker requirement: allowed one or more names"),
        ("requirement('A-1', 'A-2', requires='never fault')", "allowed requires= with a sentence, beside one name"),
        ("requirement('A-1', requires='nevr fault')", 'requirement A-1: "nevr"'),
        ("requirement('1 2', requires='never fault')", "requirement[0].id: found '1 2'"),
        ("expect_loss(True)", "marker expect_loss: allowed no arguments"),
    ],
)
def test_a_wrong_marker_is_a_usage_error(pytester: pytest.Pytester, marker: str, line: str) -> None:
    pytester.makepyfile(f"import pytest\n@pytest.mark.{marker}\ndef test_nothing(): pass\n")
    done = run_suite(pytester.path)
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    assert line in done.stderr.str()


def test_what_is_not_there_skips_with_its_reason(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.needs_adapter
        @pytest.mark.requirement("ATO-9")
        def test_adapter(bench): pass
        """
    )
    done = run_suite(pytester.path, "-rs", "--railhil-bus", "hub")
    done.assert_outcomes(skipped=1)
    done.stdout.fnmatch_lines_random(["*needs_adapter: the bus is hub*", "ATO-9  NOT SHOWN  0 of 1 *"])


def test_ids_have_no_spaces_and_users_override_the_fixtures(pytester: pytest.Pytester) -> None:
    pytester.makeconftest("import pytest\n@pytest.fixture\ndef seed(): return 'mine'\n")
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.parametrize("fault", ["speed stuck @60s for 2s"])
        def test_fault(fault): pass

        def test_seed(seed): assert seed == "mine"

        @pytest.mark.parametrize("seed", [8])
        def test_own_seeds(seed): assert seed == 8
        """
    )
    done = run_suite(pytester.path, "-v", "--railhil-seeds", "1-3")
    done.assert_outcomes(passed=3)
    done.stdout.fnmatch_lines(["*test_fault[[]speed_stuck_@60s_for_2s] PASSED*"])


@pytest.mark.slow
def test_settings_come_from_three_sources(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    pytester.makeini("[pytest]\nrailhil_bus = hub\nrailhil_seeds = 1\nrailhil_runs = there\n")
    monkeypatch.setenv("RAILHIL_SEEDS", "2")
    monkeypatch.setenv("RAILHIL_PACE", "realtime")
    pytester.makepyfile(
        """
        def test_settings(railhil_config, seed):
            assert (railhil_config.bus, railhil_config.seeds, railhil_config.pace) == ("hub", (2,), "lockstep")
            assert railhil_config.runs.name == "there"
        """
    )
    run_suite(pytester.path, "--railhil-pace", "lockstep").assert_outcomes(passed=1)
    run_suite(pytester.path).assert_outcomes(failed=1)
    bad = run_suite(pytester.path, "--railhil-bus", "can0")
    assert bad.ret == pytest.ExitCode.USAGE_ERROR
    assert "--railhil-bus: found 'can0', allowed local, auto, hub or INTERFACE:CHANNEL" in bad.stderr.str()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"bus": "hub"}, Settings(bus="hub")),
        ({"bus": "slcan:/dev/ttyACM0@500000"}, Settings(bus="slcan:/dev/ttyACM0@500000")),
        ({"seeds": "0,1,5-9,6"}, Settings(seeds=(0, 1, 5, 6, 7, 8, 9))),
        ({"seeds": "00, 03 - 5"}, Settings(seeds=(0, 3, 4, 5))),
        ({"no-controller": "1", "bus": "socketcan:can0"}, Settings(bus="socketcan:can0", no_controller=True)),
        ({"no-controller": "off"}, Settings()),
        ({"target": "qemu:cortex-m4f"}, Settings(target="qemu:cortex-m4f")),
        ({"runs": "there"}, Settings(runs=Path("/suite/there"))),
        ({"bus": "hub", "pace": "realtime"}, Settings(bus="hub", pace="realtime")),
        ({"bus": "vcan"}, "bus: found 'vcan', allowed local"),
        ({"bus": ":x"}, "bus: found ':x'"),
        ({"seeds": "1,"}, "seeds: found 1,, allowed"),
        ({"seeds": "5-4"}, "seeds: found 5-4, allowed"),
        ({"seeds": "4294967296"}, "seeds: found"),
        (
            {"seeds": "0-100000"},
            "seeds: found 0-100000, allowed seeds and ranges like 0-7,20 from 0 to 4294967295, at most",
        ),
        ({"pace": "slow"}, "pace: found 'slow', allowed lockstep or realtime"),
        ({"pace": "realtime"}, "pace: found 'realtime', allowed lockstep on the bus local"),
        ({"target": "cortex-m4f"}, "target: found 'cortex-m4f', allowed qemu:BOARD"),
        ({"no-controller": "maybe"}, "no-controller: found 'maybe', allowed 1"),
        ({"no-controller": "1"}, "no-controller: found '1', allowed nothing, or a bus"),
    ],
)
def test_settings(given: dict[str, str], said: Settings | str) -> None:
    assert given.keys() <= OPTIONS.keys()

    def look() -> Settings:
        return settings_from(lambda name: (given.get(name, ""), name), Path("/suite"))

    if isinstance(said, Settings):
        assert look() == said
        return
    with pytest.raises(ValueError, match="found") as refused:
        look()
    assert str(refused.value).startswith(said)
