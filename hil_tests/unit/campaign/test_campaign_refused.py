"""What ``railhil campaign`` refuses, in one line: options, folders, manifests, training seeds, a full disk."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from railhil.campaign.plan import Request, make_plan
from railhil.campaign.study import CAMPAIGN
from railhil.campaign.summary import training_sentence
from railhil.common.errors import InputError
from railhil.common.plug_ins import sort_laws
from railhil.controller_node.laws import names
from railhil.record.hash_list import write_hash_list
from railhil.study.manifest import manifest_of, read_manifest


@pytest.mark.slow
def test_seeds_on_which_a_law_was_designed_are_refused(campaign, short):
    same = ("--runs", "3", "--seed", "198", "--laws", "ipfc,ipfc_plus", "--out", "mine")
    refused = campaign(*same)
    assert refused.exit_code == 2
    assert "--seed: seed 198, on which ipfc_plus's own parameters were chosen" in refused.one_line()
    assert "--allow-training-seeds, which every table then says" in refused.one_line()
    assert not Path("mine").exists()
    request = Request(first_seed=198, runs=3, laws=("ipfc", "ipfc_plus"))
    plan = make_plan(replace(request, allow_training_seeds=True))
    assert [plan.training(entry) for entry in plan.entries] == [[], [198, 199]]
    assert [CAMPAIGN.work(plan, chunk).training for chunk in plan.chunks()] == [(), (198, 199)]
    assert training_sentence(plan) == (
        "NOT AN EVALUATION: parameters were tuned or chosen on seeds of this campaign (ipfc_plus on 2 of 3 runs)"
    )
    # The same runs under another name are the same runs.
    Path("copy.toml").write_text('schema_version = 1\nextends = "lvshun_tieshan"\nname = "copy"\ntitle = "Copy"\n')
    with pytest.raises(InputError, match="seed 0, on which ipfc_plus's own parameters were chosen"):
        make_plan(Request("copy.toml", first_seed=0, runs=5, laws=("ipfc_plus",)))
    # On another scenario it was not designed, and from 200 on it has seen nothing.
    assert make_plan(replace(request, scenario=str(short)))
    assert make_plan(replace(request, first_seed=200))


def test_runs_that_would_all_be_the_same_are_refused():
    draws, noise = f"draws={[0.0] * 15}", "noise=[[1, 1.0]]"
    with pytest.raises(InputError, match="the scenario lvshun_tieshan with draws and noise of its own"):
        make_plan(Request(settings=(draws, noise)))
    assert make_plan(Request(settings=(draws,))), "the noise of its runs differs"


def test_all_laws_stand_in_the_order_of_every_table():
    plan = make_plan(Request(laws=("all",)))
    assert [entry.law.controller for entry in plan.entries] == sort_laws(names())
    assert plan.entries[0].label == "ipfc"


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("laws", 5, "request.laws: found 5, allowed an array"),
        ("laws", ["nix"], "request.laws[0]: found 'nix', allowed one of ipfc, "),
        ("parameters", [7], "request.parameters[0]: found 7, allowed a text"),
        ("runs", "24", "request.runs: found '24', allowed a whole number"),
        ("chunk", 0, "request.chunk: found 0, allowed at least 1"),
        ("both", 1, "request.both: found 1, allowed true or false"),
        ("arithmetic", "nix", "request.arithmetic: found 'nix', allowed one of "),
        ("indexing", "nix", "request.indexing: found 'nix', allowed one of time, distance"),
        ("run", 1, "request.run: unknown key"),
    ],
)
def test_a_damaged_manifest_names_file_and_key(campaign, short, key, value, words):
    document = manifest_of(CAMPAIGN, make_plan(Request(scenario=str(short))))
    document["request"][key] = value
    Path("mine/parts").mkdir(parents=True)
    Path("mine/campaign.json").write_text(json.dumps(document))
    for option in ("--resume", "--verify"):
        done = campaign(option, "mine")
        assert done.exit_code == 2
        assert f"mine/campaign.json: {words}" in done.one_line()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xff\xfe", "campaign.json: is not UTF-8"),
        (b'{"format": 1, "campaign": [], "request": {}}', "campaign.json: campaign: found [], allowed a table"),
        (b'{"format": 1, "railhil": "0.2.0", "campaign": {}}', "campaign.json: request: missing, expected a value"),
        (
            b'{"format": 1, "campaign": {}, "request": {}}',
            "campaign.json: request.scenario, request.runs, request.first_seed, ",
        ),
    ],
)
def test_what_is_no_manifest_is_refused(campaign, short, content, words):
    Path("mine/parts").mkdir(parents=True)
    Path("mine/campaign.json").write_bytes(content)
    for arguments in (("--resume", "mine"), ("--verify", "mine"), (short, "--runs", "1", "--out", "mine")):
        done = campaign(*arguments)
        assert done.exit_code == 2
        assert words in done.one_line()


def test_the_request_comes_back_from_the_manifest(tmp_path):
    request = Request(runs=7, laws=("ipfc", "tpfc1"), both=True, arithmetic="iq", indexing="distance", chunk=3)
    path = tmp_path / "campaign.json"
    path.write_text(json.dumps(manifest_of(CAMPAIGN, make_plan(request))))
    write_hash_list(tmp_path)
    assert read_manifest(tmp_path, CAMPAIGN).request == request


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "nowhere"),
        (["--laws", "ipfc,ipcf"], "--laws: found 'ipcf', allowed all, or some of "),
        (["--laws", "ipfc,ipfc"], "ipfc twice"),
        (["--runs", "0"], "found 0, allowed 1..10000000"),
        (["--seed", "4294967290"], "last seed 4294968289, expected at most 4294967295"),
        (["--arithmetic", "nix"], "--arithmetic"),
        (["--engine", "nix"], "--engine"),
        (["--jobs", "2"], "--jobs: used only with --engine processes"),
        (["--engine", "dask"], "--scheduler: missing, expected tcp://HOST:PORT"),
        (["--scheduler", "tcp://127.0.0.1:9"], "--scheduler: used only with --engine dask"),
        (["--parameters", "none.toml"], "none.toml: does not exist"),
        (["--resume", "nowhere"], "nowhere/campaign.json: does not exist"),
        (["--resume", "a", "--out", "b"], "--out: cannot be given with --resume"),
        (["--verify", "nowhere"], "nowhere/campaign.json: does not exist"),
        (["--verify", "x", "--out", "y"], "--verify: cannot be given with --out, only with --runs and --draw"),
        (["--verify", "x", "--json"], "--verify: cannot be given with --json, only with --runs and --draw"),
        (["--out", "/proc/nothing"], "--out: the folder /proc/nothing cannot be written"),
    ],
)
def test_bad_input_is_one_line(campaign, tmp_path, arguments, words):
    done = campaign(*arguments)
    assert done.exit_code == 2, done.err
    assert done.out == ""
    assert words in done.one_line()
    assert not list(tmp_path.iterdir())


def test_a_folder_with_something_else_is_refused(campaign, short):
    Path("mine").mkdir()
    Path("mine/notes.txt").touch()
    assert "--out: found 'mine', allowed an empty or new folder" in campaign(short, "--out", "mine").one_line()
    Path("mine/campaign.json").write_text("[]")
    assert (
        "campaign.json: has no JSON object, expected a file of railhil campaign"
        in campaign("--resume", "mine").one_line()
    )


@pytest.mark.parametrize("module", ["pyarrow", "numba"])
def test_a_missing_library_is_one_line(campaign, short, tmp_path, monkeypatch, module):
    monkeypatch.setitem(sys.modules, module, None)
    done = campaign(short, "--engine", "processes", "--out", "mine")
    assert done.exit_code == 2
    assert f"{module} is not installed" in done.one_line()
    assert f"install '{module}>=" in done.one_line()
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_disk_that_fails_is_one_line_and_keeps_what_is_there(campaign, short, monkeypatch):
    def full(descriptor: int) -> None:
        if written.append(descriptor) or len(written) > 11:
            raise OSError(28, "No space left on device")

    written: list[int] = []
    monkeypatch.setattr("os.fsync", full)
    done = campaign(short, "--runs", "6", "--chunk", "1", "--out", "mine")
    assert done.exit_code == 4
    assert done.one_line().endswith(
        "mine/parts/ipfc-00002.parquet cannot be written: no space left on device; "
        "2 of 6 runs are kept; railhil campaign --resume mine goes on"
    )
    # One synchronisation for the manifest, two for its list of hashes, and two each for a part and its entry.
    assert [path.name for path in sorted(Path("mine/parts").iterdir())] == ["ipfc-00000.parquet", "ipfc-00001.parquet"]


def test_a_disk_that_is_full_from_the_beginning_is_no_bad_input(campaign, short, monkeypatch):
    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    done = campaign(short, "--runs", "1", "--out", "mine")
    assert done.exit_code == 4
    assert done.one_line().endswith("mine cannot be written: no space left on device")


@pytest.mark.parametrize("address", ["nowhere", "", "foo://x:1", "tcp://x", "tcp://:1", "tcp://x:0", "tcp://x:65536"])
def test_what_is_no_address_of_a_scheduler_is_one_line(campaign, address):
    done = campaign("--engine", "dask", "--scheduler", address, "--out", "mine")
    assert done.exit_code == 2
    assert done.one_line().endswith(
        f"--scheduler: found {address!r}, allowed tcp://HOST:PORT of a running dask scheduler"
    )
