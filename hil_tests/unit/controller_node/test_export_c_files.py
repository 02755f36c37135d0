"""What an export writes: its form, its promises about C, memory and stack, the switch to TI's header."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from hil_tests.support.exported import STRICT, checked, compiled, written
from railhil.controller_node.arithmetic.base import INT32_MIN
from railhil.controller_node.ato.node import mailboxes
from railhil.controller_node.ecan import Mailbox
from railhil.controller_node.export.headers import mailbox_header
from railhil.controller_node.export.text import LENGTH_MAX, Names, comment, literal
from railhil.controller_node.program.model import identifier
from railhil.scenarios.load import load

SCENARIO = load("lvshun_tieshan")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An export by distance, which has all of the tables."""
    path = tmp_path_factory.mktemp("export")
    written(SCENARIO, path, "distance")
    return path


def _code(path: Path) -> str:
    """A C file without comments and strings."""
    text = re.sub(r"/\*.*?\*/", " ", path.read_text(encoding="ascii"), flags=re.DOTALL)
    return re.sub(r'"[^"\n]*"', '""', text)


def test_law_is_integer_code_without_memory_or_recursion(folder: Path) -> None:
    code = _code(folder / "ipfc.c") + _code(folder / "ipfc.h")
    assert not re.findall(r"\b(float|double|malloc|calloc|long|short|char|goto|while|for)\b", code)
    assert not re.findall(r"\d\.\d", code)
    # The four functions call nothing of the file itself.
    assert len(re.findall(r"\bipfc_(inputs|start|step|sent)\s*\(", _code(folder / "ipfc.c"))) == 4
    helpers = _code(folder / "railhil_iq.h")
    for name, body in re.findall(r"static inline \w+ (\w+)\([^)]*\)\s*\{(.*?)\n\}", helpers, flags=re.DOTALL):
        assert name not in re.findall(r"\b(\w+)\(", body)
        assert not re.search(r"\b(float|double)\b", body)


def test_numbers_have_the_width_of_int32_where_int_has_16_bits(folder: Path) -> None:
    """No bare literal stands in an expression of int32: on the target it would be an ``int`` of 16 bits."""
    body = _code(folder / "ipfc.c").partition("void ipfc_inputs")[2]
    bare = re.findall(r"[-+*/<>=?:\[]\s*\d+", re.sub(r"INT32_C\(-?\d+\)", "", body))
    assert bare == []


def test_library_names_are_those_the_library_has(folder: Path) -> None:
    """N from 1 to 30; names that the host's header supplies and nothing else."""
    code = _code(folder / "ipfc.c")
    used = set(re.findall(r"\b_IQ\w+", code))
    assert used
    numbers = {int(number) for name in used for number in re.findall(r"_IQ(\d+)", name)}
    assert numbers <= set(range(1, 31))
    assert used <= set(re.findall(r"#define (_IQ\w+)\(", _code(folder / "railhil_iq.h")))


def test_identifiers_differ_in_their_first_31_characters(folder: Path) -> None:
    for name in ("ipfc.c", "ipfc.h", "ipfc_mailboxes.h", "railhil_iq.h"):
        assert max(map(len, re.findall(r"[A-Za-z_]\w*", _code(folder / name)))) <= LENGTH_MAX, name


def test_names_are_unique_and_valid() -> None:
    names = Names("p_")
    long = "a" * 60
    given = [names.new(text) for text in (long, long, f"{long}b", "x[1]", "x_1", "-x", "3", "", "é")]
    assert len(set(given)) == len(given)
    assert all(re.fullmatch(r"[a-z]\w{0,30}", name) for name in given)
    assert Names().new("default") == "default_2"
    assert Names().new("in") == "in_2"
    assert (identifier("-free[3][0]"), identifier("9x")) == ("minus_free_3_0", "n_9x")
    assert (literal(INT32_MIN), literal(-5)) == ("INT32_MIN", "INT32_C(-5)")
    assert comment("a */ b\n/* é") == "a *? b ?* ?"


@pytest.mark.needs_compiler
def test_mailbox_header_says_what_the_table_says(folder: Path) -> None:
    """Every field of every mailbox, as the compiled table prints it."""
    expected = []
    for box in mailboxes():
        direction = "transmit" if box.transmit else "receive"
        expected.append(f"{box.number} 0x{box.can_id:X} 0x{box.mask:X} {direction} {box.length}")
    assert {line.split()[3] for line in expected} == {"transmit", "receive"}
    program = compiled(folder, "gcc", STRICT, "boxes")
    done = subprocess.run([program, "mailboxes"], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == expected


def test_mailbox_header_has_the_rare_fields_too() -> None:
    special = Mailbox(3, "X", "X.1", 0x1234567, mask=0x7, length=3, overwrite=False, extended=True)
    header = mailbox_header("law", [special])
    assert "{3, 3, 0, 0, 1, UINT32_C(0x1234567), UINT32_C(0x7)}, /* X.1 */" in header
    assert "#define RAILHIL_MBX_X_1 3\n" in header


def test_readme_states_memory_time_and_what_has_not_been_shown(folder: Path) -> None:
    text = (folder / "README.md").read_text()
    tables = dict(re.findall(r"\| table `(\w+)` \| (\d+) \|", text))
    code = _code(folder / "ipfc.c")
    arrays = re.findall(r"static const int32_t (\w+)\[(\d+)\]", code)
    assert tables == {name: str(2 * int(count)) for name, count in arrays}
    assert len(arrays) == 4
    singles = len(re.findall(r"static const int32_t \w+ =", code))
    total = 2 * singles + 2 * sum(int(count) for _, count in arrays)
    assert f"| all constants, in flash | {total} |" in text
    # 12 inputs, 12 words of state, 5 outputs, 2 counters.
    assert "| RAM: inputs, state, outputs, event counters | 62 |" in text
    assert "not been run on a C28x" in text
    assert re.search(r"About \d+ cycles", text)


@pytest.mark.needs_compiler
def test_stack_stays_below_the_stated_bound(folder: Path) -> None:
    """The compiler's own figure, with every local variable in memory (-O0) and as it is built (-O2)."""
    bound = int(re.search(r"\| stack, estimated for cl2000 \| (\d+) \|", (folder / "README.md").read_text())[1])  # type: ignore[index]
    assert bound < 1024
    for level in ("-O0", "-O2"):
        command = ["gcc", "-std=c99", level, "-fwrapv", "-fstack-usage", "-c", "ipfc.c", "-o", "stack.o"]
        subprocess.run(command, cwd=folder, check=True)
        rows = [line.split("\t") for line in (folder / "stack.su").read_text().splitlines()]
        assert {kind for _, _, kind in rows} == {"static"}
        # The target counts words of 16 bits.
        assert max(int(size) for _, size, _ in rows) <= 2 * bound


@pytest.mark.slow
@pytest.mark.needs_compiler
def test_makefile_checks_with_both_compilers(folder: Path) -> None:
    for compiler in ("gcc", "clang"):
        subprocess.run(["make", "-s", "clean"], cwd=folder, check=True)
        done = subprocess.run(
            ["make", f"CC={compiler}", "all", "check"], cwd=folder, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        assert f"{compiler} -std=c99 -O2 -Wall -Wextra -Werror -fwrapv" in done.stdout
        assert "480 control periods identical" in done.stdout
    assert (
        subprocess.run(["make", "-s", "ubsan", "stack"], cwd=folder, capture_output=True, check=False).returncode == 0
    )


@pytest.mark.needs_compiler
def test_law_compiles_where_int_has_16_bits(folder: Path) -> None:
    """clang for another processor of 16 bits: too wide shifts, literals and conversions would be warnings."""
    flags = ["--target=msp430", "-ffreestanding", "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    done = subprocess.run(
        ["clang", *flags, "-fsyntax-only", "ipfc.c"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def _library_header() -> str:
    """A stand-in for TI's header: its names for N = 1..30, with the results of the host's functions."""
    lines = ["#define FLOAT_MATH 1", "#define IQ_MATH 0", "#define MATH_TYPE IQ_MATH"]
    lines.append("#define _IQsat(A, Pos, Neg) iq_sat((A), (Pos), (Neg))")
    for q in range(1, 31):
        for name in ("mpy", "rmpy", "rsmpy", "div"):
            lines.append(f"#define _IQ{q}{name}(A, B) iq_{name}((A), (B), {q})")
        lines.append(f"#define _IQ{q}abs(A) iq_abs(A)")
    return "\n".join(lines) + "\n"


@pytest.mark.needs_compiler
def test_switch_takes_the_library_header_instead(folder: Path, tmp_path: Path) -> None:
    """With the switch nothing but the library's header supplies the names; without the header it does not compile."""
    (tmp_path / "IQmathLib.h").write_text(_library_header())
    switch = (*STRICT, "-DRAILHIL_USE_TI_IQMATH=1")
    program = compiled(folder, "gcc", (*switch, "-I", str(tmp_path)), "library")
    assert checked(program, folder / "ipfc_log.txt").returncode == 0
    assert subprocess.run(["gcc", *switch, "-fsyntax-only", "ipfc.c"], cwd=folder, capture_output=True).returncode != 0
    (tmp_path / "IQmathLib.h").write_text(_library_header().replace("MATH_TYPE IQ_MATH", "MATH_TYPE FLOAT_MATH"))
    done = subprocess.run(
        ["gcc", *switch, "-I", str(tmp_path), "-fsyntax-only", "ipfc.c"], cwd=folder, capture_output=True, text=True
    )
    assert "MATH_TYPE must be IQ_MATH" in done.stderr
