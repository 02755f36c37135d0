"""Trunks of several systems, and random faults for branches of them."""

from __future__ import annotations

import os
import random
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.common.errors import InputError
from railhil.faults.capability import why_not
from railhil.faults.language import fault_text, parse
from railhil.faults.random_faults import Sent, random_fault, words_drawn
from railhil.faults.words import word_of
from railhil.run.make import record_run
from railhil.run.trunk import Branch, Standing
from railhil.scenarios.fault_list import fault_texts, list_disturbed_signals
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec

_DATA = Path(__file__).parents[1] / "data"
#: Scenario file of the system ato -> its content.
SHORT = {"short.toml": RUN_72M_TOML}
_FOR_40_S = ("task.duration_s=40", "task.rmse_max_kmh=9")
#: Name -> scenario, settings, law, duration in s.
TRUNKS: Mapping[str, tuple[str, tuple[str, ...], str, float]] = {
    "ato": ("short.toml", (), "ipfc_plus", 24.0),
    "ato_safe": ("short.toml", ("safety.sdt=true",), "ipfc", 24.0),
    "stop": ("yizhuang_stop_closed", (), "", 40.0),
    "hst1": ("hst_short", _FOR_40_S, "", 38.0),
    "emu3": ("emu3_short", _FOR_40_S, "", 38.0),
    "line": (str(_DATA / "tiny_line.toml"), (), "", 36.0),
}


def trunk_spec(name: str, folder: Path, *faults: str, seed: int = 3) -> RunSpec:
    """The run of a trunk.

    :param folder: for its scenario file.
    """
    scenario, settings, law, _ = TRUNKS[name]
    if scenario in SHORT:
        (folder / scenario).write_text(SHORT[scenario])
        scenario = str(folder / scenario)
    spec = RunSpec(scenario, settings, bus="local", seed=seed, faults=faults)
    return replace(spec, law=LawSpec(law or spec.load().installed_system.law))


def random_texts(scenario: AnyScenario, chance: random.Random, begin_s: float) -> list[str]:
    """One to three faults from an instant on that a branch of a run in one process can inject."""
    system = scenario.installed_system
    ports = list_disturbed_signals(system)
    sent = {port: Sent(0.0, 1e9, 0.1) for port in ports}
    found: list[str] = []
    count = chance.randint(1, 3)
    while len(found) < count:
        text = fault_text(random_fault(chance, begin_s + chance.expovariate(0.5), ports, sent, words_drawn()))
        try:
            known = fault_texts([*found, text], system, lambda row: Path("drawn"))
        except InputError:
            continue
        if not why_not(parse(text), "local", "lockstep") and not looks_back(text):
            found[:] = known
    return found


def looks_back(text: str) -> bool:
    """Whether a fault needs what was before its begin: a branch with it is a straight run."""
    fault = parse(text)
    word = word_of(fault.place.level, fault.place.name, fault.place.part, fault.what)
    assert word is not None
    return word.looks_back


def straight_sha256(spec: RunSpec, faults: tuple[str, ...], folder: Path) -> str:
    """The hash of the run that has its faults from the start on."""
    return record_run(replace(spec, faults=faults, out=folder), keep=False).frames_sha256


def fork_here(scenario: str, folder: str) -> None:
    """In a process of its own: a trunk that forks, with warnings as errors."""
    standing = Standing(RunSpec(scenario, bus="local"))
    standing.advance(1.0)
    why = standing.why_not(standing.scenario)
    assert why == "", why
    pid = os.fork()
    if not pid:
        Path(folder).mkdir()
        standing.become(Branch(("TRN_SPEED loss @1s for 50ms",), Path(folder), True, standing.spec.settings))
        os._exit(0)
    assert os.waitpid(pid, 0)[1] == 0
    standing.close()
    print(len(os.listdir("/proc/self/task")), "thread")
