"""What a hunt draws keeps to ``[hunt]`` of the scenario and to ``--what``, and changes nothing of a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.faults.language import parse
from railhil.faults.random_faults import Sent
from railhil.faults.words import word_of
from railhil.hunt import plan
from railhil.hunt.cases import make_cases
from railhil.hunt.plan import Request, make_plan
from railhil.scenarios.load import load_any

SENT = {
    "TRN_SPEED": Sent(0.0, 42.0, 0.01),
    "TRN_POS": Sent(0.0, 42.0, 0.02),
    "NOTCH_CMD": Sent(0.0, 42.0, 0.02),
}


@pytest.fixture(autouse=True)
def _calm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan, "faultless_run", lambda base: (42.0, SENT))


def with_hunt(folder: Path, text: str) -> str:
    file = folder / "bounded.toml"
    file.write_text(f'schema_version = 1\nextends = "lvshun_tieshan"\n[hunt]\n{text}\n')
    return str(file)


def drawn(scenario: str, strategy: str = "swarm", what: tuple[str, ...] = (), count: int = 60) -> list[list[str]]:
    made = make_plan(Request(scenario, strategy=strategy, what=what))
    return [[*case.faults] for case in make_cases(strategy, 3, range(count), made.space)]


def test_the_keys_of_a_hunt_change_nothing_of_a_run(tmp_path: Path) -> None:
    plain, bounded = load_any("lvshun_tieshan"), load_any(with_hunt(tmp_path, "faults_max = 1"))
    assert bounded.sha256 == plain.sha256
    assert bounded.assumptions == plain.assumptions


@pytest.mark.parametrize("strategy", ["random", "swarm"])
def test_cases_keep_to_the_bounds_of_the_scenario(tmp_path: Path, strategy: str) -> None:
    text = (
        'faults_max = 2\nlongest_s = 0.5\nleft_out = ["bus", "TRN_POS", "speed stuck", "clock"]\n'
        'largest = ["TRN_SPEED delay 100ms", "speed offset 5km/h"]'
    )
    cases = drawn(with_hunt(tmp_path, text), strategy, count=300)
    assert max(map(len, cases)) == 2
    faults = [parse(text) for case in cases for text in case]
    assert not {fault.place.level for fault in faults} & {"bus", "clock"}
    assert "TRN_POS" not in {fault.place.name for fault in faults}
    assert not [fault for fault in faults if (fault.place.name, fault.what) == ("speed", "stuck")]
    assert all(fault.duration_s is None or fault.duration_s <= 0.5 for fault in faults)
    endless = [fault for fault in faults if fault.duration_s is None and fault.count is None]
    words = [word_of(fault.place.level, fault.place.name, fault.place.part, fault.what) for fault in endless]
    assert not [word for word in words if word is None or word.lasts]
    delays = [
        fault.parameter("delay_s") for fault in faults if (fault.place.name, fault.what) == ("TRN_SPEED", "delay")
    ]
    assert all(delay_s <= 0.1 for delay_s in delays)


@pytest.mark.parametrize("name", ["controller", "controller slow"])
def test_without_a_word_of_the_controller_the_other_nodes_are_not_disturbed_instead(tmp_path: Path, name: str) -> None:
    cases = drawn(with_hunt(tmp_path, f'left_out = ["{name}"]'), count=200)
    nodes = [fault for case in cases for fault in map(parse, case) if fault.place.level == "node"]
    assert {fault.place.name for fault in nodes} == (set() if name == "controller" else {"controller"})
    assert "slow" not in {fault.what for fault in nodes}


@pytest.mark.parametrize(
    ("what", "levels", "places"),
    [
        (("sensors",), {"sensor"}, None),
        (("adhesion",), {"train"}, {"adhesion"}),
        (("speed", "TRN_SPEED"), {"sensor", "telegram"}, {"speed", "TRN_SPEED"}),
        (("traction off", "brake"), {"actuator"}, {"traction", "brake"}),
    ],
)
def test_only_what_is_asked_for_is_disturbed(what: tuple[str, ...], levels: set[str], places: set[str] | None) -> None:
    faults = [parse(text) for case in drawn("lvshun_tieshan", what=what) for text in case]
    assert {fault.place.level for fault in faults} == levels
    assert places is None or {fault.place.name for fault in faults} == places
    if what[0] == "traction off":
        assert {fault.what for fault in faults if fault.place.name == "traction"} == {"off"}


@pytest.mark.parametrize(
    ("text", "what", "said"),
    [
        ("", ("sensor_s",), "--what: found 'sensor_s'"),
        ("", ("speed stuk",), "--what: found 'speed stuk'"),
        ('left_out = ["nothing"]', (), "hunt.left_out: found 'nothing'"),
        ('largest = ["speed offset"]', (), "speed offset: "),
        ("faults_max = 0", (), "hunt.faults_max: found 0"),
        ('left_out = ["sensor"]', ("sensors",), "--what: found 'sensors', allowed names of which [hunt] leaves"),
    ],
)
def test_bad_bounds_are_one_line(tmp_path: Path, text: str, what: tuple[str, ...], said: str) -> None:
    with pytest.raises(InputError) as refused:
        make_plan(Request(with_hunt(tmp_path, text), what=what))
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_name_that_is_asked_for_twice_counts_once() -> None:
    twice = make_plan(Request("lvshun_tieshan", what=("draws", "draws")))
    assert twice.results_origin == make_plan(Request("lvshun_tieshan", what=("draws",))).results_origin


@pytest.mark.parametrize("name", ["BENCH", "CONTROLLER", "INV-4"])
def test_a_sentence_cannot_have_the_id_of_a_finding_of_every_hunt(tmp_path: Path, name: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f'[[requirement]]\nid = "{name}"\nsays = "never true_speed < 0 km/h"\n')
    with pytest.raises(InputError, match=f"mine.toml: requirement.id: found '{name}'"):
        make_plan(Request("lvshun_tieshan", requirements=(str(file),)))
