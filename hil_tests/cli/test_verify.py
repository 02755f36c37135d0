"""``railhil verify`` and ``--sign``: hashes of all files of a folder, signed with an SSH key."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.record.hash_list import HASH_LIST, SIGNATURE, write_hash_list
from railhil.record.signature import sign_list

_needs_ssh_keygen = pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="MISSING CAPABILITY ssh-keygen")


def _key(path: Path) -> Path:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(path)], check=True)
    return path


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """The scenario's file of a run of 2 m."""
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML)
    return path


def _run(here: Railhil, short: Path, out: Path, *more: str | Path) -> Path:
    done = here("run", short, "--bus", "local", "--no-report", "--quiet", "--out", out, *more)
    assert done.exit_code in (0, 1), done.err
    return out


@pytest.mark.slow
@_needs_ssh_keygen
def test_a_signed_run_is_verified_with_the_key(here: Railhil, short: Path, tmp_path: Path) -> None:
    key, other = _key(tmp_path / "key"), _key(tmp_path / "other")
    run = _run(here, short, tmp_path / "run", "--sign", key)
    signers = tmp_path / "allowed_signers"
    signers.write_text(f'# who may sign\nme@example.org namespaces="railhil" {key.with_suffix(".pub").read_text()}')
    assert here("verify", run, "--key", key.with_suffix(".pub")).exit_code == 0
    assert here("verify", run, "--key", signers).exit_code == 0
    assert "signed with ED25519 key SHA256:" in here("verify", run).out
    strange = here("verify", run, "--key", other.with_suffix(".pub"))
    assert strange.exit_code == 1
    assert "the signature is not good: it is of ED25519 key" in strange.out
    # Whoever changes a file and its hash has to sign again.
    (run / "junit.xml").write_text("<testsuites/>")
    assert "junit.xml: sha256 " in here("verify", run).out
    shutil.rmtree(run)
    _run(here, short, run)
    unsigned = here("verify", run, "--key", key.with_suffix(".pub"), "--json")
    assert (unsigned.exit_code, unsigned.json["signature"]) == (1, "unsigned")
    subprocess.run(["ssh-keygen", "-q", "-Y", "sign", "-n", "file", "-f", str(key), str(run / HASH_LIST)], check=True)
    wrong = here("verify", run)
    assert wrong.exit_code == 1, "signed, but not as evidence"
    assert (run / SIGNATURE).is_file()


def test_an_unsigned_run_says_so(here: Railhil, short: Path, tmp_path: Path) -> None:
    run = _run(here, short, tmp_path / "run")
    done = here("verify", run, "--json")
    assert done.exit_code == 0
    assert done.json == {
        "files": len((run / HASH_LIST).read_text().splitlines()),
        "problems": [],
        "not_checked": [],
        "remarks": [],
        "signature": "unsigned",
        "signed_by": None,
    }
    (run / "mine.txt").write_text("a note")
    (run / "frames.blf").unlink()
    found = here("verify", run, "--json")
    assert found.exit_code == 1
    assert found.json["not_checked"] == [f"mine.txt: not in {HASH_LIST}"]
    assert found.json["problems"][0].startswith("frames.blf: no such file, in SHA256SUMS ")


def test_the_events_are_derived_from_the_log_again_and_telemetry_is_not(
    here: Railhil, short: Path, tmp_path: Path
) -> None:
    run = _run(here, short, tmp_path / "run")
    assert "telemetry.json compared with its hash alone" in here("verify", run).out
    (run / "telemetry.json").unlink()
    header, *rows = (run / "events.csv").read_text().splitlines()
    cells = rows[0].split(",")
    time_s = f"{float(cells[0]) + 0.01:.4g}"
    for edited, said in (
        ([",".join([time_s, *cells[1:]]), *rows[1:]], f"events.csv: line 2, time_s: {time_s}, "),
        (rows[:-1], f"events.csv: line {len(rows) + 1}: "),
        ([*rows, rows[-1]], f"events.csv: line {len(rows) + 2}: "),
    ):
        (run / "events.csv").write_text("\n".join([header, *edited, ""]))
        write_hash_list(run)
        found = here("verify", run)
        assert found.exit_code == 1
        assert said in found.out
        assert "telemetry.json" not in found.out


def test_of_a_folder_without_a_list_it_is_said_what_is_checked(here: Railhil, short: Path, tmp_path: Path) -> None:
    run = _run(here, short, tmp_path / "run")
    (run / HASH_LIST).unlink()
    assert "SHA256SUMS: does not exist" in here("verify", run).out
    certificate = json.loads((run / "certificate.json").read_text())
    del certificate["hash_list"]
    (run / "certificate.json").write_text(json.dumps(certificate))
    done = here("verify", run)
    assert done.exit_code == 0
    assert "only the record and what stands in two of its files can be checked" in done.out
    (run / "certificate.json").write_text(json.dumps(certificate | {"seed": 7}))
    assert here("verify", run).exit_code == 1


@_needs_ssh_keygen
def test_a_key_that_cannot_sign_is_refused_before_the_run(here: Railhil, short: Path, tmp_path: Path) -> None:
    (tmp_path / "none").write_text("no key")
    for key in ("none", "missing"):
        said = complaint(here("run", short, "--out", tmp_path / "run", "--sign", tmp_path / key))
        assert f"{tmp_path / key}: " in said
        assert "an SSH key that can sign" in said
    assert not (tmp_path / "run").exists()
    assert "nothing to verify" in complaint(here("verify", tmp_path))


def _check_code_of_the_table(here: Railhil, folder: Path, key: Path) -> None:
    """The table has the hashes of a certificate, and of other code it is said that it is."""
    table, certificate = (json.loads((folder / name).read_text()) for name in ("faults.json", "T1b/certificate.json"))
    for name in ("railhil", "code_sha256", "system_sha256", "law_sha256", "system", "controller"):
        assert table[name] == certificate[name], name
    assert here("verify", folder, "--json").json["remarks"] == []
    content = (folder / "faults.json").read_text()
    (folder / "faults.json").write_text(json.dumps(table | {"code_sha256": "0" * 64}))
    write_hash_list(folder)
    found = here("verify", folder, "--json")
    assert (found.exit_code, found.json["problems"]) == (0, [])
    assert found.json["remarks"] == ["faults.json: the code of the bench has changed since the table (code_sha256)"]
    (folder / "faults.json").write_text(content)
    write_hash_list(folder)
    sign_list(folder, key)


@pytest.mark.slow
@_needs_ssh_keygen
def test_comparison_and_fault_table_cover_their_run_folders(here: Railhil, short: Path, tmp_path: Path) -> None:
    key = _key(tmp_path / "key")
    words = (short, "--bus", "local", "--sign", key, "--out")
    assert here("compare", "--laws", "ipfc,tpfc2", "--no-report", *words, tmp_path / "compared").exit_code in (0, 1)
    assert here("faults", "--only", "T1b", *words, tmp_path / "table").exit_code in (0, 1)
    _check_code_of_the_table(here, tmp_path / "table", key)
    for folder, below in ((tmp_path / "compared", "ipfc"), (tmp_path / "table", "T1b")):
        assert here("verify", folder, "--key", key.with_suffix(".pub")).exit_code == 0
        # The hash of the changed file is entered in the list of its own folder.
        changed = folder / below / "events.csv"
        changed.write_text(changed.read_text() + "\n")
        found = here("verify", folder, "--json")
        assert [text.split(":")[0] for text in found.json["problems"]] == [f"{below}/events.csv"]
        lines = (folder / below / HASH_LIST).read_text().splitlines(keepends=True)
        (folder / below / HASH_LIST).write_text("".join(line for line in lines if "events.csv" not in line))
        found = here("verify", folder, "--json")
        assert [text.split(":")[0] for text in found.json["problems"]] == [f"{below}/{HASH_LIST}"]
