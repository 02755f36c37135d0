"""The files of the exported controller: includes, compilers, and constructs that must not occur in them."""

from __future__ import annotations

import re
import subprocess
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from hil_tests.support.exported import STRICT
from hil_tests.support.foreign import PORTABLE, PROGRAM, build, build_node, export_node
from railhil.scenarios.load import load

pytestmark = pytest.mark.needs_compiler


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An export of the law that uses most of the controller's functions."""
    path = tmp_path_factory.mktemp("export")
    export_node(load("lvshun_tieshan_worn_wheels"), path, law="ipfc_plus")
    return path


def test_files_include_each_other_one_way(folder: Path) -> None:
    """No circular includes, and each of railhil's headers compiles on its own."""
    found = {
        path.name: set(re.findall(r'#include "(\w+\.h)"', path.read_text(encoding="ascii")))
        for path in folder.glob("*.[ch]")
    }
    assert found["railhil_position.h"] == {"railhil_clock.h"}
    assert "railhil_guard.h" not in found["railhil_position.c"]
    # Raises CycleError if the includes are circular.
    TopologicalSorter(found).prepare()
    for name in ("mvb", "ports", "clock", "position", "motion", "guard", "law", "control"):
        (folder / "alone.c").write_text(f'#include "railhil_{name}.h"\nint nothing;\n')
        build(folder, ["alone.c"], "alone.o", (*STRICT, "-c"))


def test_program_is_integer_code_without_memory(folder: Path) -> None:
    """No float and no heap in any file; names differ in their first 31 characters."""
    headers = [
        f"railhil_{name}.h"
        for name in ("mvb", "ports", "clock", "position", "motion", "guard", "law", "control", "socket")
    ]
    names = [*PROGRAM, *headers, "ipfc_plus_node.h"]
    identifiers: set[str] = set()
    for name in names:
        text = re.sub(r"/\*.*?\*/", " ", (folder / name).read_text(encoding="ascii"), flags=re.DOTALL)
        text = re.sub(r'"[^"\n]*"', '""', text)
        assert not re.findall(r"\b(float|double|malloc|calloc|realloc|free|goto|alloca)\b", text), name
        assert not re.findall(r"\d\.\d", text), name
        identifiers.update(re.findall(r"[A-Za-z_]\w*", text))
        assert max(map(len, (folder / name).read_text().splitlines())) <= 120, name
    assert len({identifier[:31] for identifier in identifiers}) == len(identifiers)


def test_what_a_board_takes_compiles_where_int_has_16_bits(folder: Path) -> None:
    """clang for another 16-bit processor, with a warning for every implicit conversion."""
    flags = ["--target=msp430", "-ffreestanding", "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    (folder / "string.h").write_text(
        "void *memset(void *, int, unsigned);\nvoid *memcpy(void *, const void *, unsigned);\n"
        "int memcmp(const void *, const void *, unsigned);\n"
    )
    done = subprocess.run(
        ["clang", *flags, "-isystem", ".", "-fsyntax-only", *PORTABLE],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_make_node_builds_the_program(folder: Path, compiler: str) -> None:
    command = ["make", "-B", f"CC={compiler}", "node"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert f"{compiler} -std=c99 -O2 -Wall -Wextra -Werror" in done.stdout
    assert (folder / "ipfc_plus_node").is_file()
    subprocess.run(["make", "-s", "clean"], cwd=folder, check=True)
    assert not (folder / "ipfc_plus_node").exists()


@pytest.mark.slow
def test_program_has_no_warning_of_the_stricter_kind(folder: Path) -> None:
    build_node(folder, "ipfc_plus", (*STRICT, "-O2", "-Wshadow", "-Wcast-qual", "-Wstrict-prototypes", "-Wundef"))
