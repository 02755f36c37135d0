"""``railhil new line --from``: a scenario on a line of another tool's file, which runs as it is."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from hil_tests.support.cli import complaint
from hil_tests.support.paths import ROOT, TEST_DATA
from railhil.scenarios.load import load_any

RAILML = ROOT / "docs" / "examples" / "north_south.xml"
FILES = {
    "ttobench": (TEST_DATA / "ttobench" / "two_tunnels.json", [], "# not used of its file: curvatures, tunnels"),
    "railtoolkit": (TEST_DATA / "railtoolkit" / "paths" / "valley_2024_07.yaml", [], "# stop 1: Mill, 221 m"),
    "railml": (RAILML, ["--track", "t1", "t2", "t3"], "# level where its file has no gradient: 1900 to 2200 m"),
}


def test_a_new_line_explains_each_value_and_says_where_all_keys_stand(here, tmp_path):
    assert here("new", "line", "mine").exit_code == 0
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    assert (ROOT / re.findall(r"https://\S+/blob/main/(\S+)", text)[0]).is_file()
    values = text.partition("[train]")[2].partition("[perturbations]")[0].splitlines()
    silent = [line for line in values if "=" in line and "#" not in line and not line.startswith(("name", "    {"))]
    assert silent == []


@pytest.mark.long_after(1)
@pytest.mark.parametrize("kind", FILES)
def test_a_line_of_a_file_is_a_pass_by_the_commands_that_are_proposed(kind, here, tmp_path):
    source, options, note = FILES[kind]
    proposed = here("new", "line", "mine", "--from", source, *options, "--json").json["next"]
    lines = (tmp_path / "mine.toml").read_text(encoding="utf-8").splitlines()
    assert note in lines
    assert next(line for line in lines if line.startswith(f"{kind} = ")).endswith(f'/{source.name}"')
    for command in proposed:
        words = shlex.split(command)[1:]
        if words[0] == "run":
            words += ["--bus", "local", "--no-report", "--out", "run"]
        assert here(*words).exit_code == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--track", "t1"], "--track: used only with --from"),
        (["--stops", "6", "--from", "nothing.json"], "--stops: cannot be given with --from"),
        (["--stops", "1"], "--stops: found 1, allowed 2..60"),
        (["--from", "nothing.json"], "nothing.json: does not exist"),
        (["--from", str(RAILML)], "line.track_ids: no choice among several, expected some of t1, t2, t3"),
        (["--from", str(FILES["ttobench"][0]), "--track", "a"], "--track: found 'a', allowed no track"),
        (["--from", str(FILES["railtoolkit"][0]), "--track", "hill"], "paths id: found 'hill', allowed one of valley"),
    ],
)
def test_a_file_without_a_line_is_one_line(words, said, here, tmp_path: Path):
    assert said in complaint(here("new", "line", "mine", *words))
    assert not (tmp_path / "mine.toml").exists()


def stretched(folder: Path, values: list[float], permil: float = 4.0) -> Path:
    """A track with other stops, and another grade."""
    track = json.loads(FILES["ttobench"][0].read_text(encoding="utf-8"))
    track["stops"]["values"] = values
    track["gradients"]["values"] = [[0.0, permil]]
    path = folder / "track.json"
    path.write_text(json.dumps(track), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("values", "permil", "said"),
    [
        ([0.0, 900_000.0], 4.0, "track.json: plan.distance_m: found 900000"),
        ([0.0, 900.0], 600.0, "line.grade_permil[0]: found 600"),
        ([0.0, 900.0], 180.0, "target.generate: "),
    ],
)
def test_a_scenario_that_cannot_be_run_is_not_written(values, permil, said, here, tmp_path):
    source = stretched(tmp_path, values, permil)
    told = complaint(here("new", "line", "mine", "--from", source))
    assert said in told
    assert told.endswith("(mine.toml is not written)")
    assert not (tmp_path / "mine.toml").exists()


def test_a_scenario_on_an_own_line_is_run_with_the_law_that_knows_its_position(here, tmp_path):
    here("new", "line", "mine")
    assert here("new", "scenario", "s3", "--extends", "mine.toml", "--json").json["next"] == [
        "railhil scenarios s3.toml",
        "railhil run s3.toml --controller ipfc_plus",
    ]
    assert here("new", "scenario", "s4", "--json").json["next"][1] == "railhil run s4.toml"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["line", ""], "NAME: found '', allowed at most 80 small letters"),
        (["scenario", ""], "NAME: found '', allowed at most 80 small letters"),
        (["line", "mine", "--from", ""], "argument --from: found '', allowed a path"),
        (["line", "mine", "--out", ""], "argument --out: found '', allowed a path"),
    ],
)
def test_an_empty_text_is_named_by_what_it_should_be(words, said, here):
    assert said in complaint(here("new", *words))


def test_a_byte_order_mark_is_named(here, tmp_path):
    (tmp_path / "mine.toml").write_text("\ufeffschema_version = 1", encoding="utf-8")
    assert "it begins with a byte order mark (BOM): save it as UTF-8" in complaint(here("scenarios", "mine.toml"))


@pytest.mark.parametrize("count", [2, 6, 60])
def test_a_line_with_stops_is_complete_and_checked(count, here, tmp_path):
    done = here("new", "line", "metro", "--stops", str(count))
    assert done.exit_code == 0, done.err
    assert "extends" not in (tmp_path / "metro.toml").read_text(encoding="utf-8")
    scenario = load_any(tmp_path / "metro.toml")
    assert (scenario.system, len(scenario.stops), len(scenario.sections)) == ("line", count, count - 1)
    assert done.out.splitlines()[-1].strip() == "railhil run metro.toml"


def test_a_line_with_stops_explains_its_values_and_says_where_to_go_on(here, tmp_path):
    here("new", "line", "metro", "--stops", "6")
    text = (tmp_path / "metro.toml").read_text(encoding="utf-8")
    assert (ROOT / re.findall(r"https://\S+/blob/main/(\S+)", text)[0]).is_file()
    values = text.partition("[train]")[2].partition("[perturbations]")[0].splitlines()
    silent = [line for line in values if "=" in line and "#" not in line and not line.startswith(("name", "    {"))]
    assert silent == ["enabled = true"]


@pytest.mark.slow
def test_a_line_with_stops_is_a_pass_as_it_is_written(here):
    here("new", "line", "metro", "--stops", "3")
    done = here("run", "metro.toml", "--bus", "local", "--no-report", "--out", "run")
    assert done.exit_code == 0, done.err
    assert done.out.splitlines()[-1] == "PASS"
