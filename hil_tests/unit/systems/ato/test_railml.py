"""Lines of railML 3: the way along tracks, and what lies on it; one line for every file that is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from railhil.bench import unrecorded_run
from railhil.common.errors import InputError
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.importers.railml import load_line
from railhil.systems.ato.scenario.importers.section import Stop
from railhil.systems.ato.scenario.model import Line

EXAMPLE = ROOT / "docs" / "examples" / "north_south.xml"
SOUTHWARDS = ("t1", "t2", "t3")
LIMIT_MPS = 60 / 3.6


def limits_kmh(line: Line) -> list[tuple[float, float]]:
    return [(from_m, round(limit_mps * 3.6, 6)) for from_m, limit_mps in line.speed_limit_mps]


def southwards(file: Path = EXAMPLE) -> Line:
    return load_line(file, track_ids=SOUTHWARDS, default_limit_mps=LIMIT_MPS).line


def changed(tmp_path: Path, old: str, new: str) -> Path:
    text = EXAMPLE.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / EXAMPLE.name
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def test_tracks_are_joined_whichever_way_their_net_elements_point() -> None:
    whole = load_line(EXAMPLE, track_ids=SOUTHWARDS, default_limit_mps=LIMIT_MPS)
    assert whole.stops == (Stop("start", 0.0), Stop("North", 150.0), Stop("South", 2100.0), Stop("end", 2200.0))
    assert whole.line.name == "t1, t2, t3"


def test_grades_are_those_of_the_direction_of_running_and_an_arc_has_its_neighbours() -> None:
    assert southwards().grade_permil == ((0.0, 0.0), (400.0, 6.0), (1150.0, -4.0), (1900.0, 0.0))
    back = load_line(EXAMPLE, track_ids=SOUTHWARDS[::-1], reverse=True, default_limit_mps=LIMIT_MPS).line
    assert back.grade_permil == ((0.0, 0.0), (300.0, 4.0), (1050.0, -6.0), (1800.0, 0.0))


def test_limits_are_the_lowest_of_the_sections_of_the_direction_of_running() -> None:
    """The section of 75 km/h has falling positions, that of 40 km/h is for the other direction."""
    assert limits_kmh(southwards()) == [(0.0, 60.0), (400.0, 75.0), (1100.0, 55.0), (1300.0, 75.0), (1900.0, 60.0)]
    back = load_line(EXAMPLE, track_ids=SOUTHWARDS[::-1], reverse=True, default_limit_mps=LIMIT_MPS).line
    assert limits_kmh(back) == [(0.0, 60.0), (300.0, 40.0), (1800.0, 60.0)]


def test_balises_of_the_direction_of_running_are_numbered_downwards() -> None:
    assert [(one.number, one.surveyed_m) for one in southwards().balises] == [
        (255, 1000.0),
        (254, 2050.0),
        (253, 2095.0),
    ]


def test_a_file_without_balises_gives_its_groups_of_balises(tmp_path: Path) -> None:
    file = changed(tmp_path, "balise ", "baliseGroup ")
    text = file.read_text(encoding="utf-8").replace("</balise>", "</baliseGroup>").replace("balises>", "baliseGroups>")
    file.write_text(text, encoding="utf-8")
    assert southwards(file).balises == southwards().balises


def test_what_a_run_does_not_use_is_said() -> None:
    assert load_line(EXAMPLE, track_ids=SOUTHWARDS, default_limit_mps=LIMIT_MPS).remarks == (
        "not used of its file: horizontalCurves, places on groups of net elements (s5)",
        "level where its file has no gradient: 1900 to 2200 m",
        "limit of 60 km/h where its file has no speed section: 1900 to 2200 m",
    )


SPOT_OF_NORTH = '<spotLocation id="p1_s" netElementRef="ne_north" applicationDirection="normal" pos="150"/>'
LOCATION_OF_S3 = """
          <linearLocation id="s3_l" applicationDirection="both">
            <associatedNetElement netElementRef="ne_middle" keepsOrientation="true">
              <linearCoordinateBegin positioningSystemRef="km" measure="13.3"/>
              <linearCoordinateEnd positioningSystemRef="km" measure="13.1"/>
            </associatedNetElement>
          </linearLocation>"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (LOCATION_OF_S3, "", "what has no location of its kind (s3)"),
        (LOCATION_OF_S3, "<areaLocation/>", "what has no location of its kind (s3)"),
        (LOCATION_OF_S3, '<linearLocation id="s3_l"/>', "what has no location of its kind (s3)"),
        (SPOT_OF_NORTH, "", "what has no location of its kind (p1)"),
        ('netElementRef="ne_south" pos="195"', 'netElementRef="ne_line" pos="1"', "net elements (b4, s5)"),
        ('<gradientCurve id="g1"', '<gradient/><gradientCurve id="g1"', "gradient of gradientCurves"),
        ('id="s2_l"', 'id="s2_l" applicationDirection="normal"', "runs against its net element: s2"),
        ('posBegin="0" posEnd="700"', 'posBegin="700" posEnd="0"', "runs against its net element: g4"),
        ('posBegin="700" posEnd="800"', 'posBegin="800" posEnd="800"', "places without length (g3)"),
        ('name="North"', 'name="end"', "names stand twice: end 2"),
    ],
)
def test_what_is_left_out_or_chosen_is_a_remark(old: str, new: str, words: str, tmp_path: Path) -> None:
    file = changed(tmp_path, old, new)
    assert words in "; ".join(load_line(file, track_ids=SOUTHWARDS, default_limit_mps=LIMIT_MPS).remarks)


def test_stops_of_one_name_are_numbered_and_one_at_an_end_of_the_way_stays(tmp_path: Path) -> None:
    file = changed(tmp_path, 'name="North"', 'name="South"')
    file.write_text(file.read_text(encoding="utf-8").replace('pos="150"', 'pos="0"'), encoding="utf-8")
    whole = load_line(file, track_ids=SOUTHWARDS, default_limit_mps=LIMIT_MPS)
    assert whole.stops == (Stop("start", 0.0), Stop("South", 0.0), Stop("South 2", 2100.0), Stop("end", 2200.0))


def test_a_net_element_without_length_has_that_of_its_measures(tmp_path: Path) -> None:
    assert southwards(changed(tmp_path, ' length="1500"', "")) == southwards()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("railml.org/schemas/3.2", "railml.org/schemas/2021", "expected infrastructure in railML 3"),
        ("</railML>", "", "is no XML, expected infrastructure in railML 3 (no element found"),
        ("<railML ", "<!DOCTYPE railML [<!ENTITY a 'b'>]><railML ", "has a document type, expected"),
        ('maxSpeed="75"', 'maxSpeed="fast"', "speedSection s2 maxSpeed: found 'fast', allowed a number"),
        ('maxSpeed="75"', 'maxSpeed="0"', "found '0', allowed a speed above 0"),
        (' maxSpeed="75"', "", "speedSection s2 maxSpeed: missing"),
        ('gradient="-6"', 'gradient="inf"', "gradientCurve g2 gradient: found 'inf'"),
        ('posBegin="800"', 'posBegin="600"', "is -4 permil where another curve is 6"),
        ('Ref="ne_south" pos', 'Ref="ne_soth" pos', "allowed the id of a net element (did you mean ne_south?)"),
        (' length="300"', "", "netElement ne_south length: missing"),
        ('units="km"', 'units="miles"', "linearPositioningSystem km units: found 'miles', allowed m or km"),
        ('positionOnB="1"', 'positionOnB="0"', "track t3: is not connected, expected a track that begins"),
        ("track>", "trak>", "is no XML"),
        ('encoding="UTF-8"', 'encoding="none"', "is no XML"),
        ('posBegin="0" posEnd="300"', 'posBegin="0" posEnd="900"', "posEnd: found 900.0, allowed from 0 to 300"),
        (' intrinsicCoord="0.5"', "", "balise b3 spotLocation: missing"),
        ('intrinsicCoord="0.5"', 'intrinsicCoord="50"', "balise b3 intrinsicCoord: found 50.0, allowed from 0 to 1"),
        ('intrinsicCoord="1"', 'intrinsicCoord="1.5"', "intrinsicCoordinate ne_middle_1 intrinsicCoord: found 1.5"),
        ('pos="900"', 'pos="-9"', "balise b1 pos: found -9.0, allowed from 0 to 1500"),
        ('measure="13.3"', 'measure="23.3"', "s3 measure: found 23300.0, allowed from 12400 to 13900 m"),
        (
            'measure="12.4"',
            'measure="13.9"',
            "netElement ne_middle associatedPositioningSystem: has measures of km out",
        ),
        ("linearCoordinateBegin", "geometricCoordinateBegin", "geometricCoordinateBegin: gives no place on ne_middle"),
        ('Ref="km"', 'Ref="kn"', "positioningSystemRef: found 'kn', allowed the id of a linear positioning system"),
        ('positioningSystemRef="km" ', "", "positioningSystemRef: missing"),
        (' units="km"', "", "linearPositioningSystem km units: missing, expected m or km"),
        ('id="s3_l" applicationDirection="both"', 'id="s3_l" applicationDirection="Both"', "s3 applicationDirection"),
        ('keepsOrientation="true"', 'keepsOrientation="True"', "keepsOrientation: found 'True', allowed one of true"),
        ('positionOnB="1"', 'positionOnB="2"', "positionOnB: found '2', allowed one of 0, 1"),
        ('navigability="Both"', 'navigability="both"', "navigability: found 'both', allowed one of Both, AB, BA, None"),
        ('navigability="Both"', 'navigability="BA"', "track t2: is not connected"),
        ('navigability="Both"', 'navigability="None"', "track t2: is not connected"),
        (' gradient="4"', "", "gradientCurve g4 gradient: missing"),
        ('netElement id="ne_south"', 'netElement id="ne_north"', "netElement id: ne_north stands twice"),
        ('track id="t3"', 'track id="t1"', "track id: t1 stands twice"),
        (' length="300"', ' length="-3"', "netElement ne_south length: found -3.0"),
        (
            "https://www.railml",
            "http://www.railml",
            "begins with <railML> of http://www.railml.org/schemas/3.2, expected",
        ),
        ("schemas/3.2", "schemas/3.9", "begins with <railML> of https://www.railml.org/schemas/3.9, expected"),
        (' xmlns="https://www.railml.org/schemas/3.2"', "", "begins with <railML> of no namespace, expected"),
        ('encoding="UTF-8"', 'encoding="big5"', "is no XML"),
        ('encoding="UTF-8"', 'encoding="idna"', "is no XML"),
    ],
)
def test_a_wrong_file_gives_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        southwards(changed(tmp_path, old, new))
    assert "\n" not in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("tracks", "words"),
    [
        ((), "line.track_ids: no choice among several, expected some of t1, t2, t3"),
        (("t9",), "line.track_ids: found 't9', allowed some of t1, t2, t3"),
        (("t1", "t3"), "track t3: is not connected"),
        (("t1", "t1"), "track t1: is not connected"),
        (("t1", "t2", "t1"), "track t1: is not connected"),
    ],
)
def test_tracks_that_are_no_way_give_one_line(tracks: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError) as caught:
        load_line(EXAMPLE, track_ids=tracks, default_limit_mps=LIMIT_MPS)
    assert words in str(caught.value)


def test_net_elements_of_one_track_must_be_connected(tmp_path: Path) -> None:
    end = 'posEnd="400"/>\n          </linearLocation>\n        </track>'
    both = end.replace("\n", '\n<associatedNetElement netElementRef="ne_middle" keepsOrientation="false"/>', 1)
    file = changed(tmp_path, end, both)
    assert load_line(file, track_ids=["t1"], default_limit_mps=LIMIT_MPS).stops[-1] == Stop("end", 1900.0)
    file.write_text(file.read_text(encoding="utf-8").replace('ref="ne_middle"', 'ref="ne_south"'), encoding="utf-8")
    with pytest.raises(InputError, match="track t1: is not connected, expected a track whose net elements"):
        load_line(file, track_ids=["t1"], default_limit_mps=LIMIT_MPS)


def test_a_relation_of_one_way_is_run_that_way(tmp_path: Path) -> None:
    assert southwards(changed(tmp_path, 'navigability="Both"', 'navigability="AB"')) == southwards()


def test_a_track_without_length_gives_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="track t3 linearLocation: has no length, expected a way to run on"):
        load_line(changed(tmp_path, 'posBegin="0" posEnd="300"', 'posBegin="300" posEnd="300"'), track_ids=["t3"])


def test_a_place_without_a_limit_must_be_given_one() -> None:
    with pytest.raises(InputError, match=r"line.default_limit_kmh: the file has no speed section for 1900 to 2200 m"):
        load_line(EXAMPLE, track_ids=SOUTHWARDS)


def test_a_run_on_a_line_of_railml_comes_to_its_verdict() -> None:
    scenario = load(EXAMPLE.with_suffix(".toml"))
    result = unrecorded_run(scenario, RunSpec(law=LawSpec("ipfc_plus")))
    assert result.verdict == "PASS", result.failures
