"""What `python -m hil_tests.size` counts."""

from __future__ import annotations

from hil_tests.size import Size, files_here, measure


def test_product_generated_modules_and_tests_are_counted_apart() -> None:
    files = [
        ("bus/long.py", "x\n" * 60),
        ("bus/small.py", "x\n" * 59),
        ("bus/made.py", '"""Made from the table; do not edit."""\n' * 7),
        ("hil_tests/unit/test_it.py", "x\n" * 3),
        ("benchmarks/it.py", "x\n" * 2),
        ("railhil/__init__.py", ""),
    ]
    assert measure(files) == Size(lines=119, modules=3, small=2, generated=7, test_lines=5)


def test_a_file_is_counted_once() -> None:
    names = [name for name, _ in files_here()]
    assert len(names) == len(set(names)) > 500
    assert "hil_tests/cli/test_size.py" in names
