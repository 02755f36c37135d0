"""Laws defined in a test, registered like a user's law: by an entry point of a distribution on the path; scenarios of a
system defined in a test."""

from __future__ import annotations

import importlib
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.laws.ipfc import Ipfc, IpfcState
from railhil.controller_node.laws import GROUP
from railhil.controller_node.laws.base import LawInputs, LawOutputs
from railhil.controller_node.program.tracer import Tracer
from railhil.scenarios.system import System


class Wrapping(Ipfc[Any]):
    """IPFC with a product that wraps in every period; its recording hides this, because it would not start
    otherwise."""

    def step(self, state: IpfcState[Any], inputs: LawInputs[Any]) -> tuple[IpfcState[Any], LawOutputs[Any]]:
        """One control period, wrapped."""
        ar = self._ar
        if not isinstance(ar, Tracer):
            ar.mpy(ar.const(Constant("x", 1.5, 30)), ar.const(Constant("y", 1.5, 30)), 30)
        return super().step(state, inputs)


def plug_in(folder: Path, patch: pytest.MonkeyPatch, /, in_group: str = GROUP, **laws: type[Any]) -> None:
    """Register laws, top-level classes of a test module, under these names until the end of the test.

    :param folder: where the distribution is written. :param in_group: entry point group of the system's laws.
    """
    package = folder / "plug" / "laws_of_a_test-1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: laws-of-a-test\nVersion: 1\n")
    lines = [f"{name} = {law.__module__}:{law.__qualname__}" for name, law in laws.items()]
    (package / "entry_points.txt").write_text("\n".join((f"[{in_group}]", *lines, "")))
    patch.syspath_prepend(str(package.parent))
    importlib.invalidate_caches()


def with_system(scenario: Any, system: System) -> Any:
    """The same scenario, whose installed system is this one."""
    kind = type("Scenario", (type(scenario),), {"__slots__": (), "installed_system": system})
    return kind(**{item.name: getattr(scenario, item.name) for item in fields(scenario)})
