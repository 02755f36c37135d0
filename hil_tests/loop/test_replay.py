"""Replayed and forged telegrams do not keep a stale speed fresh."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.replay import TIME_ATTACKS, Choice, TimeAttack
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import local_run
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlMode, NotchCmd

pytestmark = pytest.mark.faults

#: The train is at its highest speed.
LOST_TICK = 1000


@pytest.fixture(scope="module")
def train_72m(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return load(str(path))


@pytest.mark.long_after(3)
@pytest.mark.parametrize(("choice", "cause"), TIME_ATTACKS, ids=lambda item: getattr(item, "__name__", ""))
def test_no_other_time_keeps_the_last_speed_fresh(
    train_72m: Scenario, tmp_path: Path, choice: Choice, cause: str
) -> None:
    run = local_run(train_72m, tmp_path, wire=TimeAttack(LOST_TICK, choice))
    times_s, modes = run.trace.times_s(NotchCmd.PORT), run.trace.raw(NotchCmd.PORT, "CtlMode")
    bounds_s = {CtlMode.TRACTION_CUT: 0.07, CtlMode.SERVICE_BRAKE: 0.27, CtlMode.EMERGENCY: 1.02}
    for mode, bound_s in bounds_s.items():
        assert 0 < times_s[modes >= mode][0] - LOST_TICK / 100 <= bound_s + 1e-9, mode
    assert run.counters["controller"][cause] > 0
