"""A project rule that `make lint` does not check: the size of modules."""

from __future__ import annotations

from hil_tests.support.paths import ROOT

PACKAGES = (
    "dbc",
    "bus",
    "plant_sim",
    "controller_node",
    "railhil",
    "hil_tests",
    "benchmarks",
)
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def test_no_module_is_longer_than_one_sitting() -> None:
    lengths = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in MODULES}
    assert len(lengths) > 100
    assert {name: length for name, length in lengths.items() if length > 400} == {}
