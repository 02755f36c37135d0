"""Logs of faults that nodes of an attached run have left in a folder of their own."""

from __future__ import annotations

from pathlib import Path

from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.select import BusChoice
from railhil.judge.fault_report import fault_outcomes, missing_logs
from railhil.run.bus_run import BusRun
from railhil.run.run import Plan
from railhil.scenarios.run_spec import RunSpec, StartUp


def test_they_are_moved_into_the_run_folder(tmp_path: Path) -> None:
    logs, folder = tmp_path / "logs", tmp_path / "run"
    logs.mkdir()
    folder.mkdir()
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    how = StartUp(attach=True, fault_logs=logs)
    spec = RunSpec(str(path), faults=("safety_loop off @manual",), start_up=how)
    scenario = spec.load()
    (logs / "faults-inside-plant.csv").write_text("fault,time_ns,what,before,after\n1,10000000,begun,,\n")
    choice = BusChoice({"interface": "railhil", "channel": "nowhere"}, "given")
    run = BusRun(Plan(spec, scenario, choice, folder), after_loss_s=0.0)
    run._await_fault_logs()
    run.log.close()
    assert missing_logs(folder, scenario) == []
    assert [one.begun_s for one in fault_outcomes(folder, scenario, 0)] == [0.01]
    # A second run does not find those of the first.
    assert list(logs.iterdir()) == []
