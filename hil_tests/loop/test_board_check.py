"""``railhil board check`` on a hub: our node, the C node of an export, those of somebody else, a wrong one."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from hil_tests.support.cli import Done, command, railhil
from hil_tests.support.foreign import build_node, export_node
from hil_tests.support.hub import running_hub
from hil_tests.support.paths import ROOT
from railhil.scenarios.load import load

pytestmark = [pytest.mark.slow, pytest.mark.loop]

EXAMPLES, DBC = ROOT / "docs/examples/wire", ROOT / "dbc/railhil.dbc"


def checked(controller: Sequence[str | Path], *arguments: str) -> Done:
    """The check with a controller on a hub, whose channel stands for ``HUB``; the controller must end with it."""
    with running_hub() as hub:
        words = [hub.channel if word == "HUB" else word for word in controller]
        node = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            done = railhil("board", "check", "-i", "railhil", "-c", hub.channel, *arguments)
            said, _ = node.communicate(timeout=20)
        finally:
            node.kill()
            node.wait()
    assert node.returncode == 0, said
    return done


def test_our_node_passes() -> None:
    done = checked(command("node", "controller", "-i", "railhil", "-c", "HUB"), "--json")
    assert (done.exit_code, done.json["verdict"], done.json["faults"]) == (0, "PASS", [])
    assert done.json["stated"] == {"law": "ipfc", "arithmetic": "iq", "indexing": "time"}
    assert done.json["latency_ms"]["NOTCH_CMD"]["min"] > 0


@pytest.mark.long
@pytest.mark.needs_compiler
def test_the_node_of_an_export_passes(tmp_path: Path) -> None:
    export_node(load("lvshun_tieshan"), tmp_path)
    done = checked([build_node(tmp_path), "hub", "HUB"])
    assert (done.exit_code, done.out.splitlines()[-1]) == (0, "PASS"), done.out
    assert "law: ipfc, arithmetic: iq, indexing: time" in done.out


@pytest.mark.long
@pytest.mark.needs_compiler
def test_the_c_controller_of_somebody_passes(tmp_path: Path) -> None:
    program = tmp_path / "controller"
    subprocess.run(["gcc", "-std=gnu99", "-O2", "-o", program, EXAMPLES / "controller.c", "-lm"], check=True)
    done = checked([program, "hub", "HUB"])
    assert (done.exit_code, done.out.splitlines()[-1]) == (0, "PASS"), done.out
    assert "law: not stated, arithmetic: not stated, indexing: not stated" in done.out
    assert "life signs of NOTCH_CMD: 0 1 2 3 4 5 6 7 8 9" in done.out


def test_the_python_controller_of_somebody_passes_and_its_mistakes_are_named(tmp_path: Path) -> None:
    text = (EXAMPLES / "controller.py").read_text()
    for mistake, fault in (
        (("", ""), ""),
        (('check(b"\\x10\\0")', 'check(b"\\x10\\0\\0\\0")'), "right 3E (that of 4 octets; it covers 2)"),
        (('"NotchChk": 1, ', ""), "NOTCH_CMD: NotchChk 00 (erroneous), right 01 (correct) (10 times)"),
    ):
        assert mistake[0] in text
        file = tmp_path / "controller.py"
        file.write_text(text.replace(*mistake) if fault else text)
        done = checked([sys.executable, file, "railhil", "HUB", DBC])
        assert done.exit_code == bool(fault), done.out
        assert fault in done.out
        assert done.out.splitlines()[-1] == ("FAIL" if fault else "PASS")


def test_without_a_controller_it_is_invalid() -> None:
    with running_hub() as hub:
        done = railhil("board", "check", "-i", "railhil", "-c", hub.channel, "--appear-timeout", "0.3")
    assert done.exit_code == 3
    assert "no controller answers the device status poll (080#F001C8) within 0.3 s" in done.one_line()


def test_wrong_use_is_one_line() -> None:
    for words, said in (
        (("board",), "KIND"),
        (("board", "check", "--polls", "0"), "--polls: found 0, allowed 1..1000"),
        (("board", "check", "no_such_scenario"), "no_such_scenario"),
        (("board", "check", "--rate", "2"), "allowed only with --pace realtime"),
        (("board", "check", "-i", "railhil", "-c", "/none/hub.sock"), "/none/hub.sock"),
    ):
        done = railhil(*words)
        assert (done.exit_code, said in done.one_line()) == (2, True), done.err
