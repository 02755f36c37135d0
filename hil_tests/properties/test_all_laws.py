"""What every registered law must do on the bench, whatever its scores: stop, keep below the limits, wrap nowhere, and
answer the same notches over the bus, coupled directly and in the batch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from railhil.batch import Case, run_batch, trace_digest
from railhil.bench import direct_run, local_run
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws import names
from railhil.scenarios.load import load

YIZHUANG = (
    "yizhuang_01_songjiazhuang_xiaocun",
    "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan",
    "yizhuang_11_jinghai_lu_ciqu_nan",
)
#: Of the perturbed runs; the train of each differs in mass, resistance, brakes, wheels, delays.
SEEDS = range(1000, 1020)


@pytest.mark.parametrize("scenario_name", YIZHUANG)
@pytest.mark.parametrize("law", names())
def test_law_takes_a_train_from_station_to_station(law: str, scenario_name: str) -> None:
    scenario = load(scenario_name)
    nominal = run_batch(Case(scenario, law, "iq", perturbed=False), [0])
    perturbed = run_batch(Case(scenario, law, "iq"), SEEDS)
    for runs in (nominal, perturbed):
        assert set(runs.ended) == {"ended_complete"}
        assert not np.isnan(runs.values["stop_error_m"]).any()
        assert runs.overspeed_mps.max() == 0.0
        assert not any("emergency" in text for texts in runs.failures for text in texts)
        assert runs.wraps.max() == 0
    # A wheel that is half a percent off puts the train that trusts it some ten metres off, not more.
    assert perturbed.values["stop_error_m"].max() < 20.0
    assert nominal.values["stop_error_m"][0] < 1.5


@pytest.mark.parametrize("law", names())
def test_bus_direct_coupling_and_batch_give_the_same_notches(law: str, tmp_path: Path) -> None:
    """With worn wheels and misplaced balises, so that a law that uses the balises must get the same readings."""
    scenario = load("lvshun_tieshan_worn_wheels")
    over_bus = local_run(scenario, tmp_path, seed=1003, drawn=True, controller=law)
    coupled = direct_run(scenario, seed=1003, drawn=True, controller=law)
    batch = run_batch(Case(scenario, law, "iq"), [1003])
    assert over_bus.notches == coupled.notches
    assert over_bus.score == coupled.score
    assert trace_digest(scenario, over_bus.trace) == batch.notch_digest[0]
    assert batch.values["itae"][0] == over_bus.score.values["itae"]
    assert batch.signed["stop_error_m"][0] == over_bus.score.signed["stop_error_m"]
    assert over_bus.refused == {}


def test_the_law_that_reads_balises_is_the_one_that_stops() -> None:
    """The inputs of track laws arrive: with worn wheels nothing else can know where the train is."""
    scenario = load("lvshun_tieshan_worn_wheels")
    worst = {
        law: run_batch(Case(scenario, law, "iq"), SEEDS).values["stop_error_m"].max() for law in ("ipfc", "ipfc_plus")
    }
    assert load_law("ipfc_plus").track
    assert worst["ipfc_plus"] < 0.1 < 5.0 < worst["ipfc"]
