"""Bad scenario files of a line: one line with file, key, what was found and what is allowed."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import load_any

FOUR_STOPS = (DATA / "runs" / "four_stops.toml").read_text()

#: The rows of its stops.
ROWS = [line + "\n" for line in FOUR_STOPS.splitlines() if "{ name = " in line]

#: Texts of the four-stop line, what replaces them, and the message.
CHANGES: dict[str, tuple[dict[str, str], str]] = {
    "position before the last one": (
        {"position_m = 2300": "position_m = 1100"},
        "route.stops[2].position_m: found 1100, allowed more than 1200, the position of stop B",
    ),
    "one stop": (
        dict.fromkeys(ROWS[1:], ""),
        "route.stops: found 1 stop, allowed at least 2",
    ),
    "arrival too early": (
        {"arrive_s = 137": "arrive_s = 120"},
        "route.stops[1].arrive_s: found 120, allowed at least 129 (depart 30 + fastest 98.6 s with route.generate)",
    ),
    "arrival between control periods": (
        {"arrive_s = 137": "arrive_s = 137.3"},
        "route.stops[1].arrive_s: found 137.3, allowed a multiple of control_period_ms = 500",
    ),
    "departure between control periods": (
        {"depart_s = 30": "depart_s = 30.2"},
        "route.stops[0].depart_s: found 30.2, allowed a multiple of control_period_ms = 500",
    ),
    "dwell too short": (
        {"depart_s = 167": "depart_s = 150"},
        "route.stops[1].depart_s: found 150, allowed at least 157 (arrive 137 + dwell_min_s 20)",
    ),
    "first stop passed": (
        {'name = "A", position_m = 0': 'name = "A", position_m = 0, service = "pass"'},
        "route.stops[0].service: found pass, allowed stop (the first)",
    ),
    "last stop passed": (
        {'service = "terminal"': 'service = "pass"'},
        "route.stops[3].service: found pass, allowed terminal (the last)",
    ),
    "terminal on the way": (
        {'service = "pass"': 'service = "terminal"'},
        "route.stops[2].service: found terminal, allowed stop or pass (not the last)",
    ),
    "no platform": (
        {'position_m = 1200, platform = "left"': "position_m = 1200"},
        "route.stops[1].platform: found nothing, allowed left, right, both or none: doors need a side",
    ),
    "arrival where the train passes": (
        {'service = "pass"': 'service = "pass", arrive_s = 200'},
        "route.stops[2].arrive_s: found 200, allowed no such key: the train passes",
    ),
    "arrival at the first stop": (
        {"depart_s = 30": "depart_s = 30, arrive_s = 10"},
        "route.stops[0].arrive_s: found 10, allowed no such key: the first stop",
    ),
    "departure from the last stop": (
        {"arrive_s = 340": "arrive_s = 340, depart_s = 400"},
        "route.stops[3].depart_s: found 400, allowed no such key: no departure from the last stop",
    ),
    "arrival and running time": (
        {"arrive_s = 137": "arrive_s = 137, running_time_s = 107"},
        "route.stops[1].running_time_s: found 107, allowed no such key beside arrive_s",
    ),
    "a departure that the first stop has": (
        {"regulation =": "first_departure_s = 40\nregulation ="},
        "route.first_departure_s: found 40, allowed no such key: each stop has a time of its own",
    ),
    "a dwell that all stops have": (
        {"regulation =": "dwell_s = 50\nregulation ="},
        "route.dwell_s: found 50, allowed no such key: each stop has a time of its own",
    ),
    "running times that all stops have": (
        {"regulation =": "running_time_s = [120, 180]\nregulation ="},
        "route.running_time_s: found [120.0, 180.0], allowed no such key: each stop has a time of its own",
    ),
    "a reserve for stops without a time, of which there are none": (
        {"regulation =": "running_time_reserve_percent = 20\nregulation ="},
        "route.running_time_reserve_percent: found 20, allowed no such key: each stop has a time of its own",
    ),
    "no time": (
        {"arrive_s = 137, ": ""},
        "route.stops[1].arrive_s: found nothing, allowed a time, running_time_s, or route.running_time_reserve_percent",
    ),
    "running time too short": (
        {"arrive_s = 137": "running_time_s = 98.5"},
        "route.stops[1].running_time_s: found 98.5, allowed at least 99 (fastest 98.6 s with route.generate)",
    ),
    "no balise before a stop": (
        {"[180, 90, 40, 10, 0]": "[250]"},
        "line.balises: found none in the last 200 m before stop B, allowed at least 1",
    ),
    "window smaller than the limit": (
        {"door_window_m = 0.5": "door_window_m = 0.2"},
        "door_window_m: found 0.2, allowed at least stop_error_max_m",
    ),
    "safe data transmission": (
        {"[atp]": "[safety]\nsdt = true\n[atp]"},
        "safety.sdt: found true, allowed false with system line (32 mailboxes)",
    ),
    "end of authority behind the supervised location": (
        {"enabled = true ": "enabled = true\neoa_overlap_m = 40 "},
        "atp.eoa_overlap_m: found 40, allowed at most svl_overlap_m = 30",
    ),
    "balises of the protection on top of each other": (
        {"enabled = true ": "enabled = true\nbalise_spacing_m = 0.001 "},
        "atp.balise_spacing_m: found 0.001, allowed 0 (none) or at least 10",
    ),
    "heeding a protection that there is not": (
        {"enabled = true ": "enabled = false\nheed_atp = true "},
        "atp.heed_atp: found true, allowed false with enabled = false: no protection permits a speed",
    ),
    "overlaps of one stop": (
        {"arrive_s = 340": "arrive_s = 340, svl_overlap_m = 5"},
        "route.stops[3].eoa_overlap_m: found 10, allowed at most svl_overlap_m = 5",
    ),
    "signal outside": (
        {"[atp]": "[[route.signal]]\nposition_m = 3500\nclear_s = 50\n[atp]"},
        "route.signal[0].position_m: found 3500, allowed a place between the first and the last stop of its leg",
    ),
    "signal of a leg that there is not": (
        {"[atp]": "[[route.signal]]\nposition_m = 350\nclear_s = 50\nleg = 2\n[atp]"},
        "route.signal[0].leg: found 2, allowed at most 1, the number of legs",
    ),
    "disturbance below zero": (
        {"dwell_disturbance_s = [0, 8]": "dwell_disturbance_s = [-1, 8]"},
        "route.dwell_disturbance_s: found [-1.0, 8.0], allowed [low, high] with 0 <= low <= high",
    ),
    "reserves that fall": (
        {"profiles_percent = [0, 5, 12]": "profiles_percent = [0, 12, 5]"},
        "route.profiles_percent: found [0.0, 12.0, 5.0], allowed reserves that increase: fast, normal, economy",
    ),
    "a profile that passes the permitted speed": (
        {'"retime"  ': '"profiles"'},
        "target A - B, profile fast: found 57.2 km/h at 1019 m, allowed 56.1 km/h (atp: permitted 57.1 less "
        "ato_margin_kmh)",
    ),
    "masses out of order": (
        {"[atp]": "[perturbations]\nsection_mass_factor = [1.1, 0.9]\n[atp]"},
        "perturbations.section_mass_factor: found [1.1, 0.9], allowed [low, high] with low <= high",
    ),
    "a wheel that reads nothing": (
        {"[atp]": "[perturbations]\natp_wheel_factor = [0, 1]\n[atp]"},
        "perturbations.atp_wheel_factor: found [0.0, 1.0], allowed factors above 0",
    ),
    "stops from two sources": (
        {"regulation =": 'to_stop = "D"\nregulation ='},
        "route.to_stop: found 'D', allowed no such key beside route.stops",
    ),
    "plan beside a route": (
        {"[atp]": "[plan]\ndistance_m = 3\n[atp]"},
        "plan: unknown key",
    ),
    "a limit that the given times ask too much of": (
        {"[20, 80]": "[20, 40]"},
        "route.stops[1].arrive_s: found 137, allowed at least ",
    ),
    "a leg of an unknown line": (
        {"[atp]": '[[route.leg]]\nline = "nowhere"\n[atp]'},
        "route.leg[0].line: found 'nowhere', allowed a .toml path or one of lvshun_tieshan, yizhuang",
    ),
}


@pytest.mark.parametrize(("changes", "message"), CHANGES.values(), ids=CHANGES)
def test_a_bad_line_is_refused_in_one_line(tmp_path: Path, changes: dict[str, str], message: str) -> None:
    text = FOUR_STOPS
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    file = tmp_path / "four.toml"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        load_any(file)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


#: Text of [route], what a file says that extends the line, and the message.
ARRAYS = {
    "running times": (
        "running_time_s = [186, 108]",
        "route.running_time_s: found 2 values, allowed 13, one for each section of the leg",
    ),
    "running time too short": (
        "running_time_s = [170, 108, 158, 146, 94, 121, 109, 113, 167, 157, 163, 109, 116]",
        "route.running_time_s[0]: found 170, allowed at least 177 (fastest 177.0 s with route.generate)",
    ),
    "dwells": (
        "dwell_s = [30, 40]",
        "route.dwell_s: found 2 values, allowed 12, one for each stop between the first and the last of the leg",
    ),
    "dwell too short": ("dwell_s = 10", "route.dwell_s: found 10, allowed at least 20 (dwell_min_s 20)"),
    "sides": (
        'platform = ["left"]',
        "route.platform: found 1 value, allowed one for each stop of the leg; Xiaocun has none",
    ),
    "unknown stop": (
        'from_stop = "Nowhere"',
        "route.from_stop: found 'Nowhere', allowed one of Songjiazhuang, Xiaocun",
    ),
    "stops in the wrong order": (
        'from_stop = "Ciqu"\nto_stop = "Xiaocun"',
        "route.to_stop: found 'Xiaocun', allowed a stop behind from_stop in the direction of running",
    ),
    "target files": (
        'target_files = ["yizhuang_01"]',
        "route.target_files: found 1 file, allowed 13, one for each section of the leg",
    ),
    "unknown key": ("dwel_s = 30", "route.dwel_s: unknown key"),
}


@pytest.mark.parametrize(("text", "message"), ARRAYS.values(), ids=ARRAYS)
def test_arrays_must_fit_the_stops_of_the_route(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "own.toml"
    file.write_text(f'extends = "yizhuang_out"\nname = "own"\n[route]\n{text}\n')
    with pytest.raises(InputError) as caught:
        load_any(file)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{file}: ")


def test_a_setting_that_does_not_fit_is_named() -> None:
    with pytest.raises(InputError, match=r"^--set: route.dwell_min_s: found 40"):
        load_any("yizhuang_out", settings=["route.dwell_min_s=40"])
