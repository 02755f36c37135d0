"""``railhil campaign`` in this process: results, resuming, comparison with the bench."""

from __future__ import annotations

import argparse
import json
import re
import shutil
from hashlib import sha256
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from railhil.bench import direct_run
from railhil.campaign.study import CAMPAIGN
from railhil.cli import report as cli_report
from railhil.common.errors import InputError
from railhil.record.hash_list import write_hash_list
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.study.pages import report_of
from railhil.study.plan import bench_sha256
from railhil.systems.ato.judge.criteria import CRITERIA
from railhil.systems.ato.scenario.canonical import judged_sha256

#: Of every campaign here that is to give the same results.
SAME = ("--runs", "24", "--seed", "50")


@pytest.fixture(scope="module")
def finished(short, tmp_path_factory):
    """An undisturbed campaign."""
    folder = tmp_path_factory.mktemp("campaign") / "finished"
    done = railhil("campaign", short, *SAME, "--chunk", "24", "--out", folder)
    assert done.exit_code == 0, done.err
    return folder


def same_results(folder: Path, finished: Path) -> bool:
    return all(
        (folder / name).read_bytes() == (finished / name).read_bytes() for name in ("results.parquet", "summary.json")
    )


@pytest.mark.slow
def test_results_are_those_of_the_bench(finished, short):
    rows = pq.read_table(finished / "results.parquet").to_pylist()
    assert [(row["law"], row["seed"]) for row in rows] == [("ipfc", seed) for seed in range(50, 74)]
    for row in rows[::8]:
        score = direct_run(
            load(short), RunSpec(law=LawSpec(arithmetic="float64"), seed=row["seed"], perturbed=True)
        ).score
        assert {name: row[name] for name in score.values} == score.values
        assert (row["verdict"], tuple(row["failures"])) == (score.verdict, score.failures)


@pytest.mark.slow
def test_a_report_shows_a_run_among_those_of_a_campaign_of_its_law(finished, short, tmp_path):
    """One beside it is found; a named one must have its law."""
    for law in ("ipfc", "tpfc2"):
        run = finished.parent / law
        assert railhil("run", short, "--controller", law, "--bus", "local", "--no-report", "--out", run).exit_code < 2
        assert railhil("report", run).exit_code == 0
    text = (finished.parent / "ipfc/report.html").read_text(encoding="utf-8")
    assert "24 perturbed runs of ipfc in float64, seeds 50 to 73" in text
    assert re.findall(r'<a href="([^"]*)">campaign</a>', text) == ["../finished"]
    figure = text[text.index('<figure id="noise">') :].partition("</figure>")[0]
    values = np.sort(np.abs(pq.read_table(finished / "results.parquet")["energy_kj"].to_numpy()))
    chart = next(part for part in figure.split('<div class="chart"') if "energy" in part)
    low, high = map(float, re.search(r'<path class="block"[^>]* d="M(\S+) \S+?V\S+?H(\S+?)V', chart).groups())
    assert (low, high) == (pytest.approx(values[1]), pytest.approx(values[22]))
    assert 'id="noise"' not in (finished.parent / "tpfc2/report.html").read_text(encoding="utf-8")
    refused = railhil("report", finished.parent / "tpfc2", "--campaign", finished)
    assert refused.exit_code == 2
    assert "a finished campaign of" in refused.one_line()


def test_manifest_and_summary(finished, short):
    manifest = json.loads((finished / "campaign.json").read_text())
    scenario = load(short)
    assert manifest["campaign"]["scenario_sha256"] == judged_sha256(scenario)
    assert manifest["scenario"]["plan"]["distance_m"] == scenario.plan.distance_m
    assert (manifest["campaign"]["runs"], manifest["campaign"]["first_seed"]) == (24, 50)
    summary = json.loads((finished / "summary.json").read_text())
    assert (summary["runs"], summary["first_seed"], summary["last_seed"]) == (24, 50, 73)
    assert list(summary["laws"]["ipfc"]["scores"]) == [criterion.key for criterion in CRITERIA]
    assert summary["warnings"] == []
    # In the manifest: the summary is the same for the same runs, wherever and whenever they are made.
    assert manifest["recorded"].keys() == {"utc", "host", "operator"}
    assert "recorded" not in summary


@pytest.mark.slow
def test_chunks_do_not_change_results(campaign, finished, short):
    done = campaign(short, *SAME, "--chunk", "7", "--out", "mine")
    assert done.exit_code == 0
    (took,) = done.said
    assert took.startswith("24 runs in ")
    assert took.endswith(" s of processor time for them")
    assert [path.name for path in sorted(Path("mine/parts").iterdir())] == [f"ipfc-0000{i}.parquet" for i in range(4)]
    assert same_results(Path("mine"), finished)
    again = campaign("--resume", "mine", "--json")
    assert again.out == (finished / "summary.json").read_text(encoding="utf-8")
    assert sorted(path.name for path in Path("mine").iterdir()) == [
        "SHA256SUMS",
        "campaign.json",
        "parts",
        "results.parquet",
        "summary.json",
    ]
    assert max(map(len, done.out.split("Worst runs")[0].splitlines())) <= 100


def test_shards_make_the_same_campaign(campaign, finished, short):
    same = (short, *SAME, "--chunk", "5", "--out", "mine")
    first = campaign(*same, "--shard", "2/2", "--json")
    assert (first.exit_code, json.loads(first.out)) == (0, {"folder": "mine", "shard": "2/2"})
    assert "shard 2/2 is complete; the last shard, or railhil campaign --resume mine, joins all" in first.err
    assert not Path("mine/results.parquet").exists()
    last = campaign("--resume", "mine", "--shard", "1/2", "--json")
    assert last.out == (finished / "summary.json").read_text(encoding="utf-8")
    assert same_results(Path("mine"), finished)
    assert not [*Path("mine/parts").glob("*.sha256")]


def test_it_goes_on_with_what_is_missing(campaign, finished, short):
    same = (short, *SAME, "--chunk", "5", "--out", "mine")
    assert campaign(*same).exit_code == 0
    parts = [Path("mine/parts") / f"ipfc-0000{i}.parquet" for i in range(5)]
    times_ns = [part.stat().st_mtime_ns for part in parts]
    parts[1].unlink()
    parts[2].write_bytes(parts[2].read_bytes()[:1000])
    parts[3].write_bytes(parts[0].read_bytes())
    Path("mine/parts/.part-abc.parquet").touch()
    Path("mine/results.parquet").unlink()
    done = campaign("--resume", "mine")
    assert done.exit_code == 0
    *said, took = done.err.splitlines()
    assert took.startswith("15 runs in ")
    assert said == [
        "mine/parts/ipfc-00002.parquet is torn or damaged: its 5 runs are made again",
        "mine/parts/ipfc-00003.parquet is of other runs: its 5 runs are made again",
        "mine: 9 of 24 runs are there already",
    ]
    assert same_results(Path("mine"), finished)
    again_ns = [part.stat().st_mtime_ns for part in parts]
    assert [a == b for a, b in zip(times_ns, again_ns, strict=True)] == [True, False, False, False, True]
    # The same command on the same folder goes on too, here with nothing to do.
    assert campaign(*same).err.splitlines() == ["mine: 24 of 24 runs are there already"]
    assert [part.stat().st_mtime_ns for part in parts] == again_ns
    assert not list(Path("mine/parts").glob(".part-*"))


def test_a_manifest_that_was_never_finished_begins_anew(campaign, short):
    Path("mine").mkdir()
    Path("mine/campaign.json").write_text('{"format": 1, "camp')
    assert campaign(short, "--runs", "2", "--out", "mine").exit_code == 0
    assert json.loads(Path("mine/campaign.json").read_text())["campaign"]["runs"] == 2


def test_a_default_folder(campaign, short):
    done = campaign(short, "--runs", "1")
    (folder,) = Path("runs").iterdir()
    assert folder.name.endswith("-benchmark_quick-campaign")
    assert done.out.rstrip().endswith(f"campaign folder {folder}")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--runs", "25"), "campaign.runs: found 24, allowed 25 to go on with it; another --out begins a new campaign"),
        (("--seed", "51"), "campaign.first_seed: found 50, allowed 51"),
        (("--arithmetic", "iq"), "campaign.arithmetic: found 'float64', allowed 'iq'"),
        (("--indexing", "distance"), "campaign.indexing: found 'time', allowed 'distance'"),
        (("--chunk", "3"), "campaign.chunk: found 24, allowed 3"),
        (("lvshun_tieshan",), "campaign.scenario: found 'benchmark_quick', allowed 'lvshun_tieshan'"),
    ],
)
def test_another_campaign_in_the_folder_is_refused(campaign, finished, arguments, words):
    before = {path: path.read_bytes() for path in finished.rglob("*.*")}
    done = campaign("--resume", finished, *arguments)
    assert done.exit_code == 2
    assert words in done.one_line()
    assert {path: path.read_bytes() for path in finished.rglob("*.*")} == before


def test_other_code_and_another_scenario_are_refused(campaign, tmp_path):
    own = tmp_path / "own.toml"
    own.write_text(QUICK_TOML)
    assert campaign(own, "--runs", "1", "--out", "mine").exit_code == 0
    own.write_text(QUICK_TOML.replace("overtime_max_s = 1", "overtime_max_s = 2"))
    assert "campaign.scenario_sha256: found " in campaign("--resume", "mine").one_line()
    own.write_text(QUICK_TOML)
    manifest = Path("mine/campaign.json")
    manifest.write_text(manifest.read_text().replace(bench_sha256(), "0" * 64))
    write_hash_list(Path("mine"))
    assert "campaign.code_sha256: found '" in campaign("--resume", "mine").one_line()


@pytest.mark.slow
def test_parameters_have_rows_of_their_own(campaign, short, tmp_path):
    tuned = tmp_path / "tuned.toml"
    tuned.write_text('law = "ipfc"\n[parameters]\n[training]\nscenario = "benchmark_quick"\nseeds = [1001]\n')
    refused = campaign(short, "--runs", "3", "--parameters", tuned, "--out", "mine")
    assert refused.exit_code == 2
    assert "tuned.toml: training.seeds: seed 1001" in refused.one_line()
    assert not Path("mine").exists()
    same = (short, "--runs", "3", "--parameters", tuned, "--both", "--out", "mine")
    done = campaign(*same, "--allow-training-seeds")
    assert done.exit_code == 0
    # Above each of the tables: scores, limits, stops, paired.
    assert done.out.count("NOT AN EVALUATION") == 4
    assert "Runs that stopped within" in done.out
    rows = pq.read_table("mine/results.parquet").to_pylist()
    labels = [row["law"] for row in rows]
    assert labels[:3] == ["ipfc"] * 3
    assert labels[3].startswith("ipfc+")
    assert [row["training"] for row in rows] == [False] * 4 + [True, False]
    # No parameter differs from the law's own, so no run does.
    summary = json.loads(Path("mine/summary.json").read_text())
    assert summary["against_baseline"][labels[3]]["itae"]["equal_runs"] == 3
    tuned.write_text('law = "ipfc"\n[parameters]\n[training]\nscenario = "benchmark_quick"\nseeds = [1002]\n')
    assert "campaign.laws[1].training_seeds[0]: found 1001, allowed 1002" in campaign("--resume", "mine").one_line()


def test_a_changed_file_is_noticed_without_the_bench(campaign, finished, tmp_path):
    """By report and --resume, whether or not the change can be seen from the file alone."""
    for name, old, new in (
        ("campaign.json", b'"runs": 24', b'"runs": 6000000'),
        ("summary.json", b'"runs": 24', b'"runs": 6000000'),
        ("results.parquet", b"", b""),
    ):
        copy = tmp_path / name.partition(".")[0]
        shutil.copytree(finished, copy)
        content = (copy / name).read_bytes()
        changed = content.replace(old, new) if old else content[:200] + bytes([content[200] ^ 1]) + content[201:]
        assert changed != content
        (copy / name).write_bytes(changed)
        with pytest.raises(InputError, match=rf"{name}: sha256: found '\w+', allowed {sha256(content).hexdigest()}"):
            report_of(CAMPAIGN, copy, copy / "report.html")
        again = campaign("--resume", copy)
        if name == "campaign.json":
            assert again.exit_code == 2
            assert "campaign.json: sha256: found" in again.one_line()
        else:
            assert f"{copy / name} is not as listed in SHA256SUMS: it is written again" in again.err
            assert (copy / name).read_bytes() == content
            report_of(CAMPAIGN, copy, copy / "report.html")
            assert "report.html" in (copy / "SHA256SUMS").read_text()


@pytest.mark.slow
def test_a_campaign_without_a_list_has_as_many_rows_as_it_says(finished, tmp_path):
    """As before there were lists."""
    copy = tmp_path / "copy"
    shutil.copytree(finished, copy)
    (copy / "SHA256SUMS").unlink()
    document = json.loads((copy / "campaign.json").read_text())
    with pytest.raises(InputError, match=r"SHA256SUMS: does not exist"):
        report_of(CAMPAIGN, copy, copy / "report.html")
    del document["hash_list"], document["recorded"]
    (copy / "campaign.json").write_text(json.dumps(document))
    report_of(CAMPAIGN, copy, copy / "report.html")
    assert f"Recorded with railhil {document['railhil']}." in (copy / "report.html").read_text(encoding="utf-8")
    document["request"]["runs"] = document["campaign"]["runs"] = 6_000_000
    (copy / "campaign.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"results.parquet: rows: found 24, allowed 6000000"):
        report_of(CAMPAIGN, copy, copy / "report.html")


@pytest.mark.slow
@pytest.mark.loop
def test_the_bench_verifies(campaign, finished):
    done = campaign("--verify", finished, "--runs", "1")
    assert (done.exit_code, done.said) == (0, [])
    assert done.out.rstrip().endswith("1 of 1 runs are the same on the bench")


@pytest.mark.slow
@pytest.mark.loop
def test_the_bench_finds_a_forged_figure(campaign, short):
    assert campaign(short, "--runs", "1", "--out", "mine").exit_code == 0
    table = pq.read_table("mine/results.parquet")
    forged = table.to_pylist()
    forged[0] |= {"itae": forged[0]["itae"] + 1e-9, "notch_digest": "0" * 16}
    pq.write_table(table.from_pylist(forged, schema=table.schema), "mine/results.parquet")
    assert "results.parquet: sha256: found" in campaign("--verify", "mine").one_line()
    write_hash_list(Path("mine"))
    done = campaign("--verify", "mine")
    assert done.exit_code == 1
    assert "seed 1000: itae " in done.out
    assert f"seed 1000: notch_digest {'0' * 16} in the campaign" in done.out
    assert "0 of 1 runs are the same" in done.out


def test_an_unfinished_campaign_cannot_be_verified(campaign, short):
    assert campaign(short, "--runs", "1", "--out", "mine").exit_code == 0
    Path("mine/results.parquet").unlink()
    assert "results.parquet: sha256: no such file" in campaign("--verify", "mine").one_line()
    write_hash_list(Path("mine"))
    assert "mine: has no results.parquet, expected a finished campaign" in campaign("--verify", "mine").one_line()


def test_help_in_the_list_of_commands():
    done = railhil("campaign", "--help")
    assert done.exit_code == 0
    assert "every run was made (whatever its verdict)" in done.out


@pytest.mark.slow
def test_the_report_has_distributions_and_links_runs_made_again(finished, tmp_path):
    pages = [tmp_path / "one.html", tmp_path / "two.html"]
    for page in pages:
        report_of(CAMPAIGN, finished, page)
    text = pages[0].read_text(encoding="utf-8")
    assert pages[1].read_text(encoding="utf-8") == text
    recorded = json.loads((finished / "campaign.json").read_text())["recorded"]
    day = recorded["utc"][:16].replace("T", " ")
    assert f"Recorded {day} UTC on {recorded['host']} by {recorded['operator']} with railhil " in text
    summary = json.loads((finished / "summary.json").read_text())
    charts = re.findall(r'aria-label="Distributions of the scores: (.*?);', text)
    assert len(charts) > 1
    assert set(charts) == {", ".join(summary["laws"])}
    label, worst = next((label, law["worst"][0]) for label, law in summary["laws"].items() if law["worst"])
    name = f"{label}-{worst['seed']}"
    assert f"--seed {worst['seed']}" in text
    assert f"--out worst/{name}" in text
    assert "<a href=" not in text
    again = tmp_path / "copy"
    shutil.copytree(finished, again)
    (again / "worst" / name).mkdir(parents=True)
    (again / "worst" / name / "report.html").touch()
    assert cli_report.work(argparse.Namespace(folder=[str(again)], scenario=None, out=None)) == 0
    assert f'<a href="worst/{name}/report.html">' in (again / "report.html").read_text(encoding="utf-8")
    (again / "summary.json").unlink()
    with pytest.raises(InputError, match=r"summary\.json: sha256: no such file"):
        report_of(CAMPAIGN, again, again / "report.html")
