"""``import railhil``: cheap, typed, and the same runs as the commands make."""

from __future__ import annotations

import dataclasses
import inspect
import json
import pydoc
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import railhil
from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil as command
from hil_tests.support.paths import ROOT, TEST_DATA
from railhil import library
from railhil.campaign import plan
from railhil.scenarios.load import load_any as load_scenario


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return path


def test_the_import_is_cheap() -> None:
    """Nothing but the standard library, and of that little."""
    code = (
        "import sys; before = set(sys.modules); import railhil; assert callable(dir)\n"
        "print(*(set(sys.modules) - before))"
    )
    done = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    found = set(done.stdout.split())
    assert not {name for name in found if name.startswith(("numpy", "can", "pydantic", "rich", "railhil."))}
    assert "railhil" in found


def test_every_name_is_there_and_typed() -> None:
    assert set(railhil.__all__) <= set(dir(railhil))
    for name in railhil.__all__:
        assert getattr(railhil, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'runs'"):
        railhil.runs  # noqa: B018
    assert {name for name in dir(railhil) if not name.startswith("__")} == set(railhil.__all__)


@pytest.mark.parametrize("name", ["run", "open_run", "compare", "campaign"])
def test_a_function_says_how_it_is_called(name: str) -> None:
    """Also those whose name a package has: ``inspect.signature``, ``help`` and notebooks see the function."""
    called, function = getattr(railhil, name), getattr(library, name)
    signature = inspect.signature(called)
    assert signature == inspect.signature(function)
    assert not {one.kind for one in signature.parameters.values()} & {
        inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD
    }  # fmt: skip
    said = inspect.getdoc(called) or ""
    for parameter in signature.parameters.values():
        assert parameter.annotation is not inspect.Parameter.empty
        assert f"{parameter.name}:" in said or f"{parameter.name}," in said
    assert ":raises InputError:" in pydoc.plain(pydoc.render_doc(called))


@pytest.mark.slow
def test_a_run_is_that_of_the_command(short: Path, tmp_path: Path) -> None:
    """Over the hub, in this process, and from the command: one log; the documents differ in what is measured."""
    made = railhil.run(short, seed=4, perturbed=True, out=tmp_path / "library")
    over_hub = railhil.run(dataclasses.replace(made.spec, bus="auto"), out=tmp_path / "hub")
    words = made.certificate["command"].split()
    done = command(*words[1:], "--out", tmp_path / "command", "--quiet", "--no-report")
    assert done.exit_code == (0 if made.passed else 1), done.err
    again = railhil.open_run(tmp_path / "command")
    assert made.frames_sha256 == over_hub.frames_sha256 == again.frames_sha256
    assert made.scores == over_hub.scores == again.scores
    assert made.spec == again.spec
    assert {path.name for path in (tmp_path / "library").iterdir()} == {
        path.name for path in (tmp_path / "command").iterdir()
    }
    assert (made.certificate["transport"], again.certificate["transport"]) == ("local", "local")


@pytest.mark.faults
def test_a_run_takes_faults(short: Path, tmp_path: Path) -> None:
    outcome = railhil.run(
        short, faults=["NOTCH_CMD loss x1 @1s", "TRN_SPEED.counter freeze x2 @2s"], out=tmp_path / "run"
    )
    injected = outcome.certificate["injected"]
    assert [one["hits"] for one in injected] == [1, 2]
    with pytest.raises(railhil.InputError, match="did you mean loss"):
        railhil.run(short, faults=["NOTCH_CMD los @1s"], out=tmp_path / "none")


@pytest.mark.slow
@pytest.mark.faults
def test_a_single_text_is_one_fault_one_setting_one_law(short: Path, tmp_path: Path) -> None:
    outcome = railhil.run(short, faults="NOTCH_CMD loss x1 @1s", settings="plan.overtime_max_s=2", out=tmp_path / "run")
    assert (outcome.spec.faults, outcome.spec.settings) == (("NOTCH_CMD loss x1 @1s",), ("plan.overtime_max_s=2",))
    given = dataclasses.replace(outcome.spec, faults="NOTCH_CMD loss x1 @1s")  # type: ignore[arg-type]
    assert railhil.run(given, out=tmp_path / "again").frames_sha256 == outcome.frames_sha256
    with pytest.raises(railhil.InputError, match=r"laws.*found 'nobody'"):
        railhil.campaign(laws="nobody", out=tmp_path / "none")


def test_signals_are_those_of_the_file(short: Path, tmp_path: Path) -> None:
    made = railhil.run(short, out=tmp_path / "run")
    header, *rows = (tmp_path / "run/signals.csv").read_text().splitlines()
    assert list(made.signals) == header.split(",") == list(made.signals.units)
    assert all(values.shape == (len(rows),) for values in made.signals.values())
    assert made.signals.units["traction_n"] == "N"
    assert all(f"{name} " in repr(made.signals) for name in header.split(","))
    with pytest.raises(KeyError, match=r"did you mean true_speed_mps\?.*odometer_m"):
        made.signals["true_sped"]
    assert made.signals.get("true_sped") is None
    milestones = [event.cause for event in made.events if event.kind == "milestone"]
    assert milestones[-1] == "ended_complete"
    assert len(set(milestones)) == len(milestones)
    pandas = pytest.importorskip("pandas", reason="MISSING CAPABILITY pandas")
    table = made.signals.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    assert np.array_equal(table["true_position_m"].to_numpy(), made.signals["true_position_m"])


@pytest.mark.slow
def test_values_of_parameters_stand_in_the_run_folder(short: Path, tmp_path: Path) -> None:
    """The certificate's command needs a file: it is the one that the folder holds, for processes too."""
    given = {"softening_max": 0.8}
    made, over_hub = (railhil.run(short, parameters=given, bus=bus, out=tmp_path / bus) for bus in ("local", "auto"))
    assert made.frames_sha256 == over_hub.frames_sha256
    assert json.loads((tmp_path / "local/parameters.json").read_text())["values"] == given
    assert str(tmp_path / "local/parameters.json") in made.certificate["command"]
    again = railhil.run(over_hub.spec, out=tmp_path / "again")
    assert again.frames_sha256 == made.frames_sha256


@pytest.mark.parametrize("name", ["lvshun_ipfc", "worn_wheels_tdmc"])
def test_a_certificate_of_version_0_1_0_is_a_run_description(name: str) -> None:
    path = TEST_DATA / "runs_0.1.0" / name / "certificate.json"
    document = json.loads(path.read_text())
    spec = railhil.RunSpec.from_json(document, path)
    assert (spec.scenario, spec.seed) == (document["scenario"], document["seed"])


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"bus": "can0"}, "bus: found 'can0', allowed auto, local, hub or INTERFACE:CHANNEL[@BITRATE]"),
        ({"bus": "slcan:/dev/ttyACM0@fast"}, "bus: found 'slcan:/dev/ttyACM0@fast'"),
        ({"bus": "virtual:x"}, "--interface: found 'virtual'"),
        ({"no_controller": True}, "no_controller: used only in a run over a bus"),
        ({"arithmetic": "iq9"}, "arithmetic: found 'iq9'"),
        ({"seed": -1}, "seed: found -1"),
        ({"seed": 1.5}, "seed: found 1.5"),
        ({"bus": "vcan0"}, "bus: found 'vcan0'"),
        ({"pace": "realtime"}, "railhil.run: bus local: used only with pace lockstep, not with pace realtime"),
        ({"rate": "x"}, "railhil.run: rate: found 'x'"),
        ({"rate": 2.0}, "railhil.run: rate: used only in a run with pace realtime"),
        ({"faults": 3}, "railhil.run: faults: found 3"),
        ({"faults": "NOTCH_CMD los @1s"}, "railhil.run: faults: notch_cmd los @1s: found 'los'"),
        ({"settings": [3]}, "railhil.run: settings: found [3]"),
        ({"settings": {"plan.stop_error_max_m": object()}}, "railhil.run: settings: plan.stop_error_max_m: found"),
        ({"settings": "plan"}, "railhil.run: settings: found 'plan'"),
        ({"memory": 3}, "railhil.run: memory: found 3"),
        ({"parameters": 3}, "railhil.run: parameters: found 3"),
        ({"controller": 3}, "railhil.run: controller: found 3"),
        ({"bus": None}, "railhil.run: bus: found None"),
        ({"settings": {"plan.nonsense": 1}}, "plan.nonsense"),
        ({"parameters": {"nonsense": 1}}, "railhil.run: parameters.nonsense: unknown key"),
        ({"parameters": {"softening_max": 7}}, "railhil.run: parameters.softening_max: found 7"),
        ({"parameters": "none.toml"}, "none.toml: does not exist"),
        ({"controller": "ipcf"}, "did you mean ipfc"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(short: Path, tmp_path: Path, given: dict, line: str) -> None:
    with pytest.raises(railhil.InputError) as raised:
        railhil.run(short, out=tmp_path / "run", **given)
    assert line in str(raised.value).lower() or line in str(raised.value)
    assert "\n" not in str(raised.value)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("called", [railhil.run, railhil.open_run, railhil.compare])
@pytest.mark.parametrize("given", [None, 3, {"a": 1}])
def test_what_is_no_run_is_named_by_its_argument(called: Any, given: Any) -> None:
    with pytest.raises(railhil.InputError, match=r"^railhil\.(run: scenario|open_run: folder|compare: runs): found "):
        called(given)


def test_the_folder_of_a_call_is_no_option(tmp_path: Path) -> None:
    file = tmp_path / "a.py"
    file.touch()
    for called in (railhil.run, railhil.campaign):
        with pytest.raises(railhil.InputError, match=r"^railhil\.(run|campaign): out: the folder"):
            called(out=file)
        with pytest.raises(railhil.InputError, match=r"^railhil\.(run|campaign): out: found 3"):
            called(out=3)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"laws": []}, "laws: empty"),
        ({"laws": ["ipfc", "ipfc"]}, "laws, parameters: ipfc twice"),
        ({"seed": -1}, "seed: found -1"),
        ({"jobs": 0}, "jobs: found 0"),
        ({"jobs": "x"}, "jobs: found 'x'"),
        ({"parameters": 3}, "parameters: found 3"),
    ],
)
def test_a_campaign_names_its_arguments(tmp_path: Path, given: dict, line: str) -> None:
    with pytest.raises(railhil.InputError) as raised:
        railhil.campaign(out=tmp_path / "campaign", **given)
    assert str(raised.value).startswith(f"railhil.campaign: {line}")
    assert not (tmp_path / "campaign").exists()


@pytest.mark.long
@pytest.mark.slow
def test_a_campaign_without_laws_has_the_law_of_the_system(tmp_path: Path) -> None:
    found = railhil.campaign("hst_short", runs=1, out=tmp_path / "campaign")
    assert found.laws == (load_scenario("hst_short").installed_system.law,)


def test_a_campaign_is_called_by_the_name_of_its_package(tmp_path: Path) -> None:
    assert railhil.campaign.plan is plan
    with pytest.raises(railhil.InputError, match="runs: found 0"):
        railhil.campaign(runs=0, out=tmp_path / "none")
    with pytest.raises(railhil.InputError, match=r"laws\[0\]: found 'nobody'"):
        railhil.campaign(laws=["nobody"], out=tmp_path / "none")


def test_a_run_in_a_thread_of_a_user(short: Path, tmp_path: Path) -> None:
    """Signals can be taken in the main thread only."""
    found: list[railhil.Outcome] = []
    thread = threading.Thread(target=lambda: found.append(railhil.run(short, out=tmp_path / "run")))
    thread.start()
    thread.join()
    assert found[0].verdict in ("PASS", "FAIL")
