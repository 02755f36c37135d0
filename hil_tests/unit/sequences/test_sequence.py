"""``railhil sequence``: one hash over the runs of a law that learns, on every transport and after any interruption."""

from __future__ import annotations

import importlib
import json
import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.held_code import held_sha256
from railhil.panel.recorded import RecordedRuns
from railhil.scenarios.memory import load_memory
from railhil.sequences.evidence import Made, read_evidence, sequence_sha256
from railhil.sequences.sequence_command import main
from railhil.study.claim import claimed

pytestmark = [pytest.mark.slow, pytest.mark.loop]


def words(short: Path, out: Path, *more: str, runs: int = 3) -> list[str]:
    return ["run", str(short), "--controller", "learning", "--runs", str(runs), "--out", str(out), "--no-report", *more]


@pytest.fixture(scope="module")
def made(short: Path) -> Path:
    """Three runs in one process."""
    assert main(words(short, short.with_name("three"), "--bus", "local")) == PASS
    return short.with_name("three")


@pytest.fixture
def sequence(made: Path, tmp_path: Path) -> Path:
    """A copy of their folder that a test may change."""
    return Path(shutil.copytree(made, tmp_path / "three"))


def test_the_hash_is_that_of_the_lines() -> None:
    made = [
        Made(
            run=1, verdict="PASS", memory_before_sha256="a" * 64, frames_sha256="b" * 64, memory_after_sha256="c" * 64
        ),
        Made(run=2, verdict="FAIL", memory_before_sha256="d" * 64, frames_sha256="e" * 64, memory_after_sha256=None),
    ]
    # By sha256sum of: 1 aa.. bb.. cc..\n2 dd.. ee.. -\n
    assert sequence_sha256(made) == "d6d2d342390557fd0fe0686968c098b3ed806e57ae45a45ac5610adb45b0b162"


def test_a_sequence_is_recorded_verified_and_made_again(
    sequence: Path, short: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    evidence = read_evidence(sequence)
    # Nothing is left to do.
    assert main(words(short, sequence, "--bus", "local")) == PASS
    said = capsys.readouterr().out
    assert "3 of 3 runs are there already" in said
    assert f"sequence sha256 {evidence.sha256}" in said
    assert [one.run for one in evidence.made] == [1, 2, 3]
    assert len({one.frames_sha256 for one in evidence.made}) == 3
    assert load_memory(sequence / "run003" / "memory_before.json").newest is not None
    assert main(["verify", str(sequence)]) == PASS
    assert main(["rerun", str(sequence)]) == PASS
    assert f"same bytes: 3 runs, sequence sha256 {evidence.sha256}" in capsys.readouterr().out
    # Its page has a row for each run, with a link to it, and nothing of the place of the folder.
    assert railhil("report", sequence).exit_code == PASS
    page = (sequence / "report.html").read_text(encoding="utf-8")
    assert "3 of 3 runs of learning" in page
    recorded = json.loads((sequence / "sequence.json").read_text())["recorded"]
    assert f"UTC on {recorded['host']} by {recorded['operator']} with railhil " in page
    assert '<a href="run002">2</a>' in page
    assert str(sequence) not in page
    assert evidence.sha256 in page
    # Over the bus, in three processes.
    done = railhil("sequence", *words(short, sequence.with_name("hub"), "-i", "railhil"))
    assert done.exit_code == PASS, done.err
    assert read_evidence(sequence.with_name("hub")).sha256 == evidence.sha256


def test_an_interrupted_sequence_is_gone_on_with(
    sequence: Path, short: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = read_evidence(sequence)
    document = json.loads((sequence / "sequence.json").read_text())
    # As it is when killed in the third run: its folder is there, but not entered, and the list is not written. An
    # earlier version did not say who recorded it.
    del document["hash_list"], document["recorded"]
    (sequence / "sequence.json").write_text(json.dumps(document | {"made": document["made"][:2], "sha256": None}))
    (sequence / "SHA256SUMS").unlink()
    (sequence / "run003" / "certificate.json").unlink()
    assert main(["verify", str(sequence)]) == FAIL
    assert "2 of 3 runs are finished" in capsys.readouterr().out
    assert main(words(short, sequence, "--bus", "local")) == PASS
    assert "2 of 3 runs are there already" in capsys.readouterr().out
    assert read_evidence(sequence) == whole


def test_what_was_changed_is_named(sequence: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, old, new, line in (
        ("run002/frames.log", "(0.000000)", "(0.000001)", "frames.log has SHA-256 "),
        ("run001/memory.json", '"runs": 1', '"runs": 7', "memory.json: crc32: found "),
        ("run003/memory_before.json", '"slot": "A"', '"slot": "default"', "memory.sha256: found "),
    ):
        copy = sequence.with_name("copy")
        shutil.copytree(sequence, copy)
        file = copy / name
        text = file.read_text()
        file.write_text(text.replace(old, new, 1))
        assert file.read_text() != text
        assert main(["verify", str(copy)]) == FAIL
        assert line in capsys.readouterr().out
        shutil.rmtree(copy)
    # A run of another sequence does not fit between two, though each of its files is whole.
    shutil.rmtree(sequence / "run002")
    shutil.copytree(sequence / "run001", sequence / "run002")
    assert main(["verify", str(sequence), "--json"]) == FAIL
    problems = json.loads(capsys.readouterr().out)["problems"]
    assert "run002/memory_before.json is not the memory that run 1 has left" in problems[0]


def test_a_changed_sequence_is_not_gone_on_with(sequence: Path, short: Path) -> None:
    """Neither a complete one nor one with runs to make."""
    path = sequence / "sequence.json"
    whole = path.read_text()
    path.write_text(whole.replace('"runs": 3', '"runs": 5', 1))
    with pytest.raises(InputError, match=r"sequence.json: sha256: found '\w+', allowed \w+ \(SHA256SUMS beside it\)"):
        main(words(short, sequence, "--bus", "local"))
    path.write_text(whole)
    (sequence / "run001" / "junit.xml").write_text("<testsuites/>")
    with pytest.raises(InputError, match=r"run001/junit.xml: sha256: found"):
        main(words(short, sequence, "--bus", "local"))
    shutil.rmtree(sequence / "run001")
    shutil.copytree(sequence / "run002", sequence / "run001")
    score = sequence / "run002" / "score.json"
    score.write_text(score.read_text().replace('"verdict": "PASS"', '"verdict": "FAIL"', 1) + " ")
    with pytest.raises(InputError, match=r"run002/score.json: sha256: found"):
        RecordedRuns([str(sequence)])


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (("run", "{}", "--controller", "ipfc"), "--controller: found 'ipfc', allowed a law that keeps a memory"),
        (("verify", "nowhere"), r"sequence\.json: does not exist, expected a file of railhil sequence"),
        (("rerun", "nowhere"), r"sequence\.json: does not exist"),
    ],
)
def test_bad_input_is_one_line(given: tuple[str, ...], line: str, short: Path) -> None:
    with pytest.raises(InputError, match=line) as refused:
        main([word.format(short) for word in given])
    assert len(str(refused.value).splitlines()) == 1


def test_another_sequence_is_not_mixed_in(sequence: Path, short: Path) -> None:
    with pytest.raises(InputError, match=r"sequence\.json: is of another sequence, expected the same one to go on"):
        main(words(short, sequence, "--bus", "local", runs=4))


def test_a_second_process_in_the_same_folder_is_refused(sequence: Path, short: Path) -> None:
    with claimed(sequence, "sequence"):
        done = railhil("sequence", *words(short, sequence, "--bus", "local"))
    assert done.exit_code == 2
    assert f"{sequence}: is in use by a sequence" in done.err
    assert main(words(short, sequence, "--bus", "local")) == PASS


def test_a_sequence_is_not_gone_on_with_by_other_code(sequence: Path, short: Path) -> None:
    """A module more in the distribution of the law."""
    site = short.with_name("plug")
    added = (site / "beside_the_law.py", site / "laws_of_a_test-1.dist-info" / "top_level.txt")
    for path, text in zip(added, ("x = 1\n", "beside_the_law\n"), strict=True):
        path.write_text(text)
    importlib.invalidate_caches()
    held_sha256.cache_clear()
    try:
        with pytest.raises(InputError, match="has runs of other code: the distribution of the law has changed"):
            main(words(short, sequence, "--bus", "local"))
    finally:
        for path in added:
            path.unlink()
        held_sha256.cache_clear()
