"""What the wire cannot carry is refused when a scenario is loaded, in one line that names key and signal."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from railhil.common.errors import InputError
from railhil.scenarios.load import load, load_any
from railhil.scenarios.load import names as shipped_names
from railhil.scenarios.system import system_named
from railhil.scenarios.task import Task

FACTOR = "sensors.wheel_factor"
BEYOND = {
    "ODO": ("yizhuang_stop", ("task.start_m=0", "task.stop_m=17000"), "task.stop_m", "ODO.OdoDistance"),
    "wheel": ("yizhuang_stop", ("task.sensors.wheel_sigma=0.02",), "task.sensors.wheel_sigma", "TRUE_DATA.TrueWheel"),
    "gain": (
        "yizhuang_stop",
        ("task.service_braking_mps2=2.5", "task.true.gain=1.4"),
        "task.service_braking_mps2",
        "TRUTH.TrueDrive",
    ),
    "true gain": (
        "yizhuang_stop",
        ("task.true.gain=2", "task.true.gain_train_sigma=0.2", "task.true.gain_run_sigma=0.2"),
        "task.true.gain",
        "TRUE_DATA.TrueGain",
    ),
    "start": ("yizhuang_stop", ("task.start_kmh=200", "task.cruise_sigma_mps=5"), "task.start_kmh", "SPEED_RAW.Speed5"),
    "wander": ("yizhuang_stop", ("task.wander_sigma_mps=1",), "task.brake.braking_max_mps2", "TRUTH.TrueAccel"),
    "wind": ("hst_short", ("task.wind_sigma_mps2=1",), "task.wind_sigma_mps2", "MUTATION.TrueWind"),
    "distance": ("emu3_short", ("task.curve.distance_km=2500",), "task.curve.distance_km", "TRUTH.TruePos"),
    "brake": ("lvshun_tieshan", ("train.brake.force_max_kn=1311",), "train.brake.force_max_kn", "SIM_TRUTH.BrakeForce"),
    "accel": ("lvshun_tieshan", ("train.brake.force_max_kn=900",), "train.brake.force_max_kn", "SIM_TRUTH.TrueAccel"),
    "light": (
        "lvshun_tieshan",
        ("perturbations.mass_factor=[0.2, 1]",),
        "perturbations.mass_factor",
        "SIM_TRUTH.TrueAccel",
    ),
    "notch": ("lvshun_tieshan", ("train.notch_max=12",), "train.notch_max", "NOTCH_CMD.NotchCmd"),
    "limit": ("lvshun_tieshan", ("line.speed_limit_kmh=[[-1000, 1000]]",), "line.speed_limit_kmh[0]", "SpeedLimit"),
    "grade": (
        "lvshun_tieshan",
        ("perturbations.grade_offset_permil=[0, 400]",),
        "perturbations.grade_offset_permil",
        "TRK_INFO.Gradient",
    ),
    "reading": (
        "lvshun_tieshan",
        ("sensors.speed_noise_sigma_kmh=1000",),
        "sensors.speed_noise_sigma_kmh",
        "TRN_SPEED.TrainSpeed",
    ),
    "drawn noise": (
        "lvshun_tieshan",
        ("perturbations.speed_noise_sigma_kmh=[0, 1000]",),
        "perturbations.speed_noise_sigma_kmh",
        "TRN_SPEED.TrainSpeed",
    ),
}


@pytest.mark.parametrize("case", BEYOND)
def test_one_line_names_key_and_signal(case: str) -> None:
    scenario, settings, key, signal = BEYOND[case]
    with pytest.raises(InputError) as caught:
        load_any(scenario, settings)
    assert key in str(caught.value)
    assert signal in str(caught.value)


def test_every_quantity_is_that_of_a_signal_of_its_system() -> None:
    """And the shipped scenarios stay within all of them."""
    for name in shipped_names():
        scenario = load_any(name)
        task = getattr(scenario, "task", None)
        if isinstance(task, Task):
            contract = system_named(scenario.system).contract
            for reach in task.reaches():
                assert contract.has(*reach.signal.split(".")), reach


LONG = """
schema_version = 1
name = "long"
title = "long"
[train]
name = "fast"
mass_t = 400
rotating_mass_factor = 0.06
length_m = 200
actuator_pole_per_s = 0.34
accel_per_notch_mps2 = 0.2088
speed_limit_kmh = 420
davis = { a_n_per_kn = 0.5, b_n_per_kn_kmh = 0.001, c_n_per_kn_kmh2 = 0.00001 }
traction = { force_max_kn = 400 }
brake = { force_max_kn = 600 }
[line]
name = "flat"
grade_permil = [[-1000, 0.0]]
speed_limit_kmh = [[-1000, 400]]
[target.generate]
[plan]
distance_m = 203000
running_time_reserve_percent = 1
stop_error_max_m = 3
time_error_max_s = 30
[sensors]
speed_lsb_kmh = 0.01
odometer_lsb_m = 0.01
[energy]
xi_m = 0.9
xi_b = 0.0
auxiliary_power_kw = 100
"""


@pytest.mark.slow
def test_the_wheels_count_for_the_length_of_a_run(tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_text(LONG, encoding="utf-8")
    assert load(path, ("sensors.wheel_factor=1.97",)).wheel_factor_max == 1.97
    for setting, key in (
        ("sensors.wheel_factor=1.98", FACTOR),
        ("perturbations.wheel_factor=[0.9, 1.98]", "perturbations.wheel_factor"),
    ):
        with pytest.raises(InputError, match=rf"{key}: found 1\.98, allowed at most 1\.97"):
            load(path, (setting,))
    # A law that uses the position reads 200 km at most, by the train's own odometer.
    done = railhil("run", str(path), "--controller", "ipfc_plus", "--bus", "local", "--no-report", cwd=tmp_path)
    assert (done.exit_code, "plan.distance_m: found 203000.0" in done.one_line()) == (2, True)
    path.write_text(LONG.replace("203000", "190000"), encoding="utf-8")
    worn = ("--set", f"{FACTOR}=1.1")
    done = railhil("run", str(path), "--controller", "ipfc_plus", "--bus", "local", "--no-report", *worn, cwd=tmp_path)
    assert (done.exit_code, "allowed at most 181818 m" in done.one_line()) == (2, True)


PERIODS = {
    "NOTCH_CMD": ("lvshun_tieshan", 40, 30, ()),
    "TRN_SPEED": ("lvshun_tieshan", 30, 20, ()),
    "TRN_POS": ("lvshun_tieshan", 1200, 1000, ()),
    "TRK_INFO": ("lvshun_tieshan", 1010, 1000, ()),
    "NOTCH_SDT": ("lvshun_tieshan", 40, 20, ("safety.sdt=true",)),
    "ODO": ("yizhuang_stop", 128, 112, ()),
    "REF": ("hst_short", 800, 600, ()),
    "UNIT3_FB": ("emu3_short", 200, 160, ()),
    "SIM_TRUTH": ("lvshun_tieshan", 1010, 1000, ()),
    "TRUTH": ("hst_short", 1040, 1000, ()),
}


@pytest.mark.parametrize("port", PERIODS)
def test_a_period_older_than_a_watch_allows_is_refused(port: str) -> None:
    """One that it does allow is not."""
    scenario, too_long, longest, settings = PERIODS[port]
    load_any(scenario, (*settings, f"timing.port_period_ms.{port}={longest}"))
    with pytest.raises(InputError, match=rf"timing\.port_period_ms\.{port}: found {too_long}"):
        load_any(scenario, (*settings, f"timing.port_period_ms.{port}={too_long}"))


def test_a_weaker_watch_allows_longer_periods() -> None:
    load("lvshun_tieshan", ("watch.hold_ms=40", "timing.port_period_ms.NOTCH_CMD=50"))
    with pytest.raises(InputError, match="found 60"):
        load("lvshun_tieshan", ("watch.hold_ms=40", "timing.port_period_ms.NOTCH_CMD=60"))
    with pytest.raises(InputError, match=r"timing\.port_period_ms\.NOTCH_CMD: found 10"):
        load("lvshun_tieshan", ("safety.sdt=true", "timing.port_period_ms.NOTCH_CMD=10"))
