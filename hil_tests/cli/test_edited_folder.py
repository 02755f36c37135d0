"""One edited byte of a run folder never turns a verdict without a word, whoever reads the folder."""

from __future__ import annotations

import json
import shutil
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import can
import pytest

from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil import library
from railhil.common.errors import InputError
from railhil.dbc import ContractError
from railhil.judge import rerun as again
from railhil.judge.record import checked_record
from railhil.panel.recorded import RecordedRuns
from railhil.record.blf_writer import write_blf
from railhil.record.hash_list import HASH_LIST, SIGNATURE, listed_files, write_hash_list
from railhil.record.signature import sign_list
from railhil.run.report import report_line

_needs_ssh_keygen = pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="MISSING CAPABILITY ssh-keygen")
_READERS: dict[str, Callable[[Path], object]] = {
    "score, report, replay, plot, export": lambda folder: checked_record(str(folder), None),
    "open_run": library.open_run,
    "panel": lambda folder: RecordedRuns([str(folder)]),
    "rerun": lambda folder: again.certified_run(str(folder)),
}
_FILES = (
    "SHA256SUMS", "certificate.json", "events.csv", "faults-plant.csv", "faults.csv", "frames.blf", "frames.log",
    "junit.xml", "ports.toml", "railhil.dbc", "report.html", "scenario.json", "score.json", "signals.csv",
    "telemetry.json",
)  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of 2 m with a fault, and its report."""
    place = tmp_path_factory.mktemp("made")
    (place / "short.toml").write_text(RUN_2M_TOML)
    run = library.run(place / "short.toml", faults=["TRN_SPEED loss 30% @0s"], out=place / "run")
    assert report_line([run], run.folder).startswith("report ")
    return run.folder


@pytest.fixture
def copy(made: Path, tmp_path: Path) -> Path:
    """A copy of that folder that a test may change."""
    return Path(shutil.copytree(made, tmp_path / "copy"))


@pytest.fixture(scope="module")
def run_of_shipped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of a shipped scenario with a fault."""
    folder = tmp_path_factory.mktemp("shipped") / "run"
    return library.run("lvshun_tieshan", faults=["TRN_SPEED loss 30% @0s"], out=folder).folder


@pytest.fixture
def shipped(run_of_shipped: Path, tmp_path: Path) -> Path:
    """A copy of that folder."""
    return Path(shutil.copytree(run_of_shipped, tmp_path / "shipped"))


@pytest.fixture
def earlier(copy: Path) -> Path:
    """The same as it was written before there were lists of hashes."""
    (copy / HASH_LIST).unlink()
    _edit(copy / "certificate.json", lambda document: document.pop("hash_list"))
    return copy


def _edit(path: Path, change: Callable[[dict[str, object]], object]) -> None:
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))


def test_every_file_of_a_folder_is_listed(made: Path) -> None:
    assert {*listed_files(made), HASH_LIST} == {path.name for path in made.iterdir()} == set(_FILES)


@pytest.mark.parametrize("place", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("name", _FILES)
def test_an_edited_byte_is_noticed_by_every_reader(copy: Path, name: str, place: float) -> None:
    content = bytearray((copy / name).read_bytes())
    content[round((len(content) - 1) * place)] ^= 1
    (copy / name).write_bytes(content)
    for read in _READERS.values():
        with pytest.raises(InputError) as refused:
            read(copy)
        assert "\n" not in str(refused.value)
        assert name in str(refused.value) or HASH_LIST in str(refused.value)


@pytest.mark.parametrize("name", [HASH_LIST, "certificate.json"])
def test_a_list_or_certificate_that_is_gone_is_missed(copy: Path, name: str) -> None:
    (copy / name).unlink()
    for read in _READERS.values():
        with pytest.raises(InputError, match=name):
            read(copy)


@pytest.mark.parametrize("name", sorted({*_FILES} - {HASH_LIST, "certificate.json", "frames.log", "report.html"}))
def test_a_listed_file_that_is_gone_is_missed(copy: Path, name: str) -> None:
    (copy / name).unlink()
    for read in _READERS.values():
        with pytest.raises(InputError, match=f"{name}: sha256: no such file"):
            read(copy)


def test_a_folder_made_before_the_lists_is_read_as_far_as_it_goes(earlier: Path) -> None:
    wanted = checked_record(str(earlier), None).score
    for name in ("frames.blf", "signals.csv", "events.csv", "report.html", "telemetry.json", "score.json"):
        (earlier / name).unlink()
    assert checked_record(str(earlier), None).score == wanted


def test_a_certificate_removed_with_its_line_is_missed(here: Railhil, copy: Path) -> None:
    (copy / "certificate.json").unlink()
    write_hash_list(copy)
    found = here("verify", copy)
    assert found.exit_code == 1
    assert "SHA256SUMS: no line of certificate.json" in found.out
    assert "certificate.json: does not exist" in complaint(here("score", copy))


def test_a_document_that_denies_its_list_is_refused(copy: Path) -> None:
    _edit(copy / "certificate.json", lambda document: document.pop("hash_list"))
    write_hash_list(copy, only=[name for name in listed_files(copy) if name != "certificate.json"])
    for read in _READERS.values():
        with pytest.raises(InputError, match=r"SHA256SUMS: has no line of certificate.json"):
            read(copy)


def test_a_named_scenario_does_not_hide_an_edited_file(made: Path, tmp_path: Path) -> None:
    scenario = made.parent / "short.toml"
    folder = library.run(scenario, out=tmp_path / "run").folder
    (folder / "junit.xml").write_text("<testsuites/>")
    record = checked_record(str(folder), str(scenario))
    assert "junit.xml: sha256: found" in record.invalid


@pytest.mark.parametrize(
    ("keys", "beside"),
    [
        ({"verdict": "INVALID"}, "score.json"),
        ({"line": "all is well"}, "score.json"),
        ({"seed": 1}, "score.json"),
        ({"controller": "tdmc"}, "score.json"),
        ({"arithmetic": "float64"}, "score.json"),
        ({"injected": []}, "score.json"),
    ],
)
def test_a_certificate_is_compared_with_what_lies_beside_it(
    earlier: Path, keys: dict[str, object], beside: str
) -> None:
    """A folder without a list: step by step, an attacker has to change every document, and then the record."""
    _edit(earlier / "certificate.json", lambda document: document.update(keys))
    for read in _READERS.values():
        with pytest.raises(InputError, match=rf"certificate.json: {next(iter(keys))}: .*as in {beside} beside it"):
            read(earlier)
    (earlier / beside).unlink()
    if "line" in keys:
        return
    where = "as in the logs of the faults" if "injected" in keys else "as in junit.xml"
    with pytest.raises(InputError, match=where):
        checked_record(str(earlier), None)
    (earlier / "junit.xml").unlink()
    if keys.keys() & {"seed", "controller", "arithmetic"}:
        with pytest.raises(InputError, match=r"certificate.json: handshake: .*PLT_IDENT, CTL_IDENT and SUP_IDENT"):
            checked_record(str(earlier), None)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"faults": ["TRN_SPEED loss 30% @0s", "TRN_SPEED loss 100% @20s for 1s"]}, "faults: .*loss 100%"),
        ({"settings": ["train.mass_kg=200000"]}, "scenario, settings, faults: .*train.mass_kg"),
        ({"faults": []}, "scenario, settings, faults: "),
        ({"scenario_sha256": "0" * 64}, "scenario_sha256: "),
    ],
)
def test_what_was_run_is_derived_again(shipped: Path, keys: dict[str, object], words: str) -> None:
    (shipped / "score.json").unlink()
    _edit(shipped / "certificate.json", lambda document: document.update(keys))
    write_hash_list(shipped)
    for read in _READERS.values():
        with pytest.raises(InputError, match=f"certificate.json: {words}.*PLT_IDENT"):
            read(shipped)


def test_another_verdict_in_the_certificate_is_said(here: Railhil, copy: Path) -> None:
    found = checked_record(str(copy), None).score.verdict
    other = {"PASS": "FAIL", "FAIL": "PASS"}[found]
    for name in ("score.json", "junit.xml"):
        (copy / name).unlink()
    _edit(copy / "certificate.json", lambda document: document.update(verdict=other))
    write_hash_list(copy)
    said = f"says {other}, the record gives {found}"
    assert said in " ".join(here("score", copy).out.split())
    assert said in here("score", copy, "--json").json["notes"][0]
    verified = here("verify", copy, "--json")
    assert (verified.exit_code, len(verified.json["remarks"])) == (0, 1)
    assert said in library.open_run(copy).notes[0]
    assert said in RecordedRuns([str(copy)]).describe()["runs"][0]["facts"]["verdict"]


@pytest.mark.parametrize("change", ["a failure more", "another number"])
def test_cases_that_contradict_their_junit_file_are_noticed(copy: Path, change: str) -> None:
    path = copy / "junit.xml"
    tree = ET.parse(path)
    suite = tree.getroot()
    if change == "another number":
        suite.set("failures", str(int(suite.attrib["failures"]) + 1))
    else:
        ET.SubElement(suite[-1], "failure", message="invented")
    tree.write(path, encoding="unicode", xml_declaration=True)
    write_hash_list(copy)
    for read in _READERS.values():
        with pytest.raises(InputError, match=r"junit.xml: failures: "):
            read(copy)


def test_a_failed_case_contradicts_the_verdict_pass(copy: Path) -> None:
    path = copy / "junit.xml"
    tree = ET.parse(path)
    suite = tree.getroot()
    ET.SubElement(suite[-1], "failure", message="invented")
    suite.set("failures", str(sum(1 for _ in suite.iter("failure"))))
    next(one for one in suite.iter("property") if one.get("name") == "verdict").set("value", "PASS")
    tree.write(path, encoding="unicode", xml_declaration=True)
    write_hash_list(copy)
    for read in _READERS.values():
        with pytest.raises(InputError, match=r"junit.xml: failures: .*verdict PASS"):
            read(copy)


def test_an_edited_scenario_with_a_renewed_list_is_noticed(copy: Path) -> None:
    _edit(copy / "scenario.json", lambda document: document.update(sha256="0" * 64))
    write_hash_list(copy)
    for read in _READERS.values():
        with pytest.raises(InputError, match=r"scenario.json: sha256: "):
            read(copy)


def test_a_scaled_port_table_is_noticed_without_a_list(earlier: Path) -> None:
    """Decoded is with the table; its DBC is derived again."""
    path = earlier / "ports.toml"
    scaled = path.read_text().replace("scale = 0.0001,", "scale = 0.00010004,")
    assert scaled != path.read_text()
    path.write_text(scaled)
    for read in _READERS.values():
        with pytest.raises(ContractError, match=r"ports.toml: sha256 of its DBC: found \w+, allowed \w+"):
            read(earlier)


def test_a_list_of_more_than_its_folder_is_refused(copy: Path) -> None:
    path = copy / HASH_LIST
    for line in (f"{'0' * 64}  ../other\n", f"{'0' * 64}  /etc/passwd\n", "no hash\n", ""):
        path.write_text(path.read_text() + line if line else "")
        with pytest.raises(InputError, match=HASH_LIST):
            checked_record(str(copy), None)
        write_hash_list(copy)


@_needs_ssh_keygen
def test_a_new_report_is_listed_and_a_signed_one_kept(here: Railhil, copy: Path, tmp_path: Path) -> None:
    (copy / "report.html").unlink()
    assert here("report", copy).exit_code == 0
    assert checked_record(str(copy), None).certificate
    _sign(copy, tmp_path)
    done = here("report", copy)
    assert done.exit_code == 2
    assert "report.html: belongs to a signed folder" in done.err
    assert here("report", copy, "--out", copy.parent / "elsewhere.html").exit_code == 0


def _sign(folder: Path, tmp_path: Path) -> None:
    key = tmp_path / "key"
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(key)], check=True)
    sign_list(folder, key)


@pytest.fixture
def signed(copy: Path, tmp_path: Path) -> Path:
    """The folder, signed."""
    _sign(copy, tmp_path)
    for read in _READERS.values():
        read(copy)
    return copy


@_needs_ssh_keygen
@pytest.mark.parametrize("broken", ["file and its line", "signature", "list and its key"])
def test_a_signature_of_another_list_is_refused_by_every_reader(here: Railhil, signed: Path, broken: str) -> None:
    signature = (signed / SIGNATURE).read_bytes()
    if broken == "file and its line":
        (signed / "events.csv").write_text("")
        write_hash_list(signed)
        (signed / SIGNATURE).write_bytes(signature)
    elif broken == "signature":
        (signed / SIGNATURE).write_text("none")
    else:
        (signed / HASH_LIST).unlink()
        _edit(signed / "certificate.json", lambda document: document.pop("hash_list"))
    for read in _READERS.values():
        with pytest.raises(InputError, match=SIGNATURE) as refused:
            read(signed)
        assert "\n" not in str(refused.value)
    assert SIGNATURE in complaint(here("score", signed))
    assert here("verify", signed).exit_code == 1


@_needs_ssh_keygen
def test_without_openssh_a_line_says_that_the_signature_is_not_checked(
    signed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    for read in _READERS.values():
        read(signed)
    assert capsys.readouterr().err == f"{signed / SIGNATURE} is not checked: no ssh-keygen\n"


def _verified(here: Railhil, folder: Path) -> dict[str, list[str]]:
    """Problems and what was not checked, after the list of hashes was written again."""
    write_hash_list(folder)
    found = here("verify", folder, "--json")
    assert found.exit_code == (1 if found.json["problems"] else 0)
    return {key: found.json[key] for key in ("problems", "not_checked")}


def test_verify_compares_the_frames_of_the_blf_with_the_log(here: Railhil, copy: Path, tmp_path: Path) -> None:
    lines = (copy / "frames.log").read_text().splitlines(keepends=True)
    at = next(place for place, line in enumerate(lines) if place > 100 and line.endswith("00 R\n"))
    edits = {
        "data": [*lines[:at], lines[at].replace("00 R", "01 R"), *lines[at + 1 :]],
        "order": [*lines[:at], lines[at + 1], lines[at], *lines[at + 2 :]],
        "one frame less": lines[:-1],
    }
    whole = (copy / "frames.blf").read_bytes()
    for edit, text in edits.items():
        (tmp_path / "other.log").write_text("".join(text))
        write_blf(tmp_path / "other.log", copy / "frames.blf")
        (problem,) = _verified(here, copy)["problems"]
        line = len(lines) if edit == "one frame less" else at + 1
        assert problem.startswith(f"frames.blf: other frames than frames.log: line {line}, "), edit
    (copy / "frames.blf").write_bytes(whole[:1000])
    assert "frames.blf" in _verified(here, copy)["problems"][0]
    # The same frames in other bytes.
    (copy / "frames.blf").write_bytes(whole)
    with can.BLFReader(copy / "frames.blf") as reader:
        messages = list(reader)
    with can.BLFWriter(copy / "frames.blf", compression_level=1) as writer:
        for message in messages:
            writer.on_message_received(message)
    assert (copy / "frames.blf").read_bytes() != whole
    assert _verified(here, copy) == {"problems": [], "not_checked": []}


def test_verify_derives_the_signals_from_the_log_again(here: Railhil, copy: Path) -> None:
    path = copy / "signals.csv"
    header, *rows = path.read_text().splitlines()
    column = header.split(",").index("true_speed_mps")
    cells = rows[50].split(",")
    cells[column] = f"{float(cells[column]) + 0.001:.10g}"
    path.write_text("\n".join([header, *rows[:50], ",".join(cells), *rows[51:], ""]))
    (problem,) = _verified(here, copy)["problems"]
    assert problem.startswith(f"signals.csv: line 52, true_speed_mps: {cells[column]}, ")
    path.write_text("\n".join([header, *rows[:-1], ""]))
    assert _verified(here, copy)["problems"][0].startswith(f"signals.csv: line {len(rows) + 1}: ")
    # Other code may make something else of the same log.
    _edit(copy / "certificate.json", lambda document: document.update(code_sha256="0" * 64))
    found = _verified(here, copy)
    assert found["problems"] == []
    assert found["not_checked"] == [
        f"{name}: not compared with the log: the code of the bench has changed since the record (code_sha256)"
        for name in ("signals.csv", "events.csv")
    ]
