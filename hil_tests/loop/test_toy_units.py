"""Units of a plug-in system: one without a valid position, faults of one, a memory and notes over all."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from hil_tests.support.toy_system import SCENARIO, certificate, install_toy, python, railhil

pytestmark = [pytest.mark.loop, pytest.mark.slow]

#: One second of a cart's telegrams is lost, stuck, or marked invalid by its check variable.
_FAULTY = """
import json, sys
from dataclasses import replace
from pathlib import Path
from railhil.bus.layout import CHECK_ERRONEOUS
from railhil.bus.mvb import TelegramSource
from railhil.bench import local_run
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.scenarios.load import load_any
from two_carts.wire import COMMANDS, STATS
scenario = load_any(sys.argv[1])
folder, kind, what = Path(sys.argv[2]), STATS[int(sys.argv[3])], sys.argv[4]
port = kind.port()
seen, before = 0, None
def wire(frame):
    global seen, before
    if frame.can_id != port.address:
        return [frame]
    seen += 1
    if not 50 <= seen < 150:
        before = frame
        return [frame]
    if what == "invalid":
        telegram = replace(kind.decode(frame.data[:port.data_bytes]), check=CHECK_ERRONEOUS)
        return TelegramSource(port).frames(telegram.encode())
    return [before] if what == "stuck" else []
law = LawSpec(system_named(scenario.system).law, "float64")
run = local_run(scenario, folder, RunSpec(law=law), wire=wire)
time_s = run.trace.times_s(COMMANDS[0].PORT)
force_n = run.trace.values(COMMANDS[0].PORT, "Unit1Force")
kept = force_n[(time_s > 0.48) & (time_s <= 0.48 + 0.256)].tolist()
safe = force_n[(time_s > 0.48 + 0.256) & (time_s < 1.49)].tolist()
counters = {cause: count for cause, count in run.counters["controller"].items() if cause != "unknown_id"}
print(json.dumps([run.score.verdict, counters, kept, safe]))
"""


_TOLD = """
import json, sys
from pathlib import Path
from railhil.bench import local_run
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.judge.events.telegrams import events_of
from railhil.judge.judging import judging_of
from railhil.record.telemetry import shown_telemetry
from two_carts.wire import LAW_STAT, STATS
scenario = load_any(sys.argv[1])
judging = judging_of(scenario)
run = local_run(scenario, Path(sys.argv[2]), RunSpec(law=LawSpec(system_named(scenario.system).law)))
def told():
    shown = shown_telemetry(run.trace, judging.status)
    found = judging.score(scenario, run.trace)
    print(json.dumps([shown.as_json(), shown.sentence(), found.verdict, list(found.failures)]))
told()
run.trace.add(LAW_STAT.PORT, 11_000_000_000, LAW_STAT(overflow_flags=1).encode())
told()
def happened():
    events = events_of(scenario, run.trace)
    print(json.dumps([[event.kind, event.source, event.cause, event.count] for event in events]))
happened()
last_ns = run.trace.end_ns
run.trace.add(STATS[1].PORT, last_ns, STATS[1](0, life=5).encode())
run.trace.add(STATS[1].PORT, last_ns, STATS[1](0, life=5).encode())
run.trace.refuse(STATS[1].PORT, last_ns, "wrong_check_sequence")
happened()
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_toy(tmp_path_factory.mktemp("toy"))


@pytest.mark.long_after(1)
@pytest.mark.parametrize("unit", [0, 1])
@pytest.mark.parametrize(
    ("what", "refused"),
    [("silent", {"gap": 1}), ("stuck", {"duplicate": 100, "gap": 1}), ("invalid", {"check_variable": 100})],
)
def test_a_unit_without_a_valid_position_makes_every_command_the_safe_one(
    site: Path, tmp_path: Path, unit: int, what: str, refused: dict[str, int]
) -> None:
    """No accepted telegram from one cart for one second: commands continue for 0.256 s, then both forces are 0."""
    ((verdict, counters, kept, safe),) = python(site, _FAULTY, str(SCENARIO), str(tmp_path), str(unit), what)
    assert verdict == "PASS", "it comes back"
    assert counters.pop("stale") == 2 * len(safe)
    assert counters == refused
    assert len(kept) > 10
    assert all(kept)
    assert len(safe) > 30
    assert not any(safe)


_FAULTS = """
[[fault]]
where = "STAT"
what = "loss"
when = { position = "500 mm" }
for = "300 ms"
unit = 2

[[fault]]
where = "UNIT1_CMD.counter"
what = "freeze"
when = "3 s"
count = 5
"""


@pytest.mark.long
@pytest.mark.faults
def test_faults_of_a_unit_are_injected_alike_over_the_hub_and_in_process(site: Path, tmp_path: Path) -> None:
    path = tmp_path / "faulty.toml"
    path.write_text(SCENARIO.read_text(encoding="utf-8").replace("two_carts_2m", "faulty") + _FAULTS)
    more = "LAW_STAT loss 50% @v>100mm/s for 1s"
    found = []
    for bus in ("local", "auto"):
        folder = tmp_path / bus
        words = ["run", str(path), "--bus", bus, "--out", str(folder), "--quiet", "--no-report", "--fault", more]
        refused = railhil(site, *words)
        assert refused.returncode == 2
        assert "found 'LAW_STAT loss" not in refused.stderr
        words[-1] = "LAW_STAT loss 50% @v>1km/h for 1s"
        done = railhil(site, *words)
        assert done.returncode == 0, done.stderr
        found.append(certificate(folder))
        lines = (folder / "faults.csv").read_text(encoding="utf-8").splitlines()
        # Of the second unit only.
        assert {line.split(",")[3][:3] for line in lines if line.startswith("1,") and ",loss," in line} == {"118"}
    first, second = found
    assert first["frames_sha256"] == second["frames_sha256"]
    assert first["injected"] == second["injected"]
    injected = first["injected"]
    assert isinstance(injected, list)
    assert [one["hits"] for one in injected[:2]] == [30, 5]
    assert injected[0]["fault"] == "STAT loss @0.5m for 300ms units 2"


_COUNTING = """
from two_carts.laws import Apart


class Counting(Apart):
    def __init__(self, arithmetic, scenario, parameters=None, memory=None):
        super().__init__(arithmetic, scenario, parameters)
        self.runs = memory.values["runs"] if memory.values else 0

    @classmethod
    def memory_key(cls, scenario):
        return scenario.name

    def memory(self, state):
        return {"runs": self.runs + 1, "last_01mm": [self._ar.raw(place, 0) for place in state.position]}
"""


@pytest.mark.long_after(1)
@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_a_law_over_several_units_keeps_a_memory_too(site: Path, tmp_path: Path, arithmetic: str) -> None:
    """Over the hub and in one process: the same bytes."""
    plug = tmp_path / "site"
    shutil.copytree(site, plug)
    (plug / "counting.py").write_text(_COUNTING, encoding="utf-8")
    package = plug / "counting-1.dist-info"
    package.mkdir()
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: counting\nVersion: 1\n")
    (package / "entry_points.txt").write_text("[two_carts.laws]\ncounting = counting:Counting\n")

    def ran(bus: tuple[str, str], number: int) -> tuple[bytes, object]:
        """Memory after the run of this number, and the hash of its frames."""
        memory, folder = (tmp_path / f"{bus[1]}{name}" for name in ("", number))
        words = ("--controller", "counting", "--arithmetic", arithmetic, "--memory", str(memory), *bus)
        done = railhil(plug, "run", str(SCENARIO), *words, "--out", str(folder), "--quiet", "--no-report")
        assert done.returncode == 0, done.stderr
        slot = memory / ("a.json" if number == 1 else "b.json")
        document = json.loads(slot.read_text(encoding="utf-8"))
        assert (document["key"], document["runs"], document["values"]["runs"]) == ("two_carts_2m", number, number)
        assert (folder / "memory.json").read_bytes() == slot.read_bytes()
        return slot.read_bytes(), certificate(folder)["frames_sha256"]

    local = [ran(("--bus", "local"), number) for number in (1, 2)]
    if arithmetic == "iq":
        assert ran(("-i", "railhil"), 1) == local[0]
    else:
        (tmp_path / "railhil").mkdir()
        (tmp_path / "railhil" / "a.json").write_bytes(local[0][0])
    assert ran(("-i", "railhil"), 2) == local[1]


def test_the_record_says_what_the_arithmetic_did_where_the_interface_has_it(site: Path, tmp_path: Path) -> None:
    """This also works without a file of the controller, as with --attach; a wrap fails the run, as in ``ato``."""
    whole, wrapped, healthy, disturbed = python(site, _TOLD, str(SCENARIO), str(tmp_path))
    assert whole[0]["source"] == "LAW_STAT"
    assert whole[1:] == ["no overflow, as LAW_STAT tells it", "PASS", []]
    assert wrapped[0]["happened"] == ["wrap"]
    assert wrapped[2:] == ["FAIL", ["fixed-point wrap in the controller, reported at 11.00 s"]]
    # The record also says what happened, by the system's own ports and milestones.
    assert healthy == [["milestone", "plant", name, 1] for name in ("arrived", "ended_complete")]
    assert [event for event in disturbed if event not in healthy] == [
        ["refused", "UNIT2_STAT", "duplicate", 1],
        ["refused", "UNIT2_STAT", "wrong_check_sequence", 1],
    ]
