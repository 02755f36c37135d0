"""Laws with a memory from run to run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, LawInputs, LawOutputs
from railhil.controller_node.laws.memory import NOTHING, Remembered
from railhil.systems.ato.scenario.model import Scenario

#: Notches added in the next run for each km/h of deviation at the end of the last run.
_GAIN = 0.25


class _State(NamedTuple):
    """State of IPFC, and the deviation of the last period (km/h, Q20)."""

    of_ipfc: Any
    error: Any


class Learning(Ipfc[Any]):
    """IPFC that counts its runs and adds an offset to its notch, learned from the deviation at the end of each run."""

    name = "learning"

    def __init__(
        self,
        arithmetic: Arithmetic[Any],
        scenario: Scenario,
        parameters: Any = None,
        memory: Remembered = NOTHING,
    ) -> None:
        super().__init__(arithmetic, scenario, parameters)
        values = memory.values or {"runs": 0, "offset": 0.0}
        self._runs, self._learned = int(values["runs"]), float(values["offset"])
        most = scenario.train.notch_max
        held = {"offset": self._learned, "most": most, "least": -most}
        constants = [Constant(name, value, NOTCH_Q, "memory") for name, value in held.items()]
        self._offset, *self._range = arithmetic.load(constants)

    @classmethod
    def memory_key(cls, scenario: Scenario) -> str:
        return f"{scenario.line.name}, {scenario.train.name}"

    @classmethod
    def check_memory(cls, scenario: Scenario, values: Mapping[str, Any]) -> None:
        if not abs(values["offset"]) <= scenario.train.notch_max:
            raise ValueError(f"offset {values['offset']}, allowed +-{scenario.train.notch_max}")

    def memory(self, state: Any) -> dict[str, Any]:
        error_kmh = self._ar.raw(state.error, SPEED_Q) / 2**SPEED_Q
        return {"runs": self._runs + 1, "offset": self._learned + _GAIN * error_kmh}

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        return {f"of_ipfc.{name}": bounds for name, bounds in super().state_bounds().items()}

    def start(self, inputs: LawInputs[Any]) -> Any:
        return _State(super().start(inputs), self._ar.sub(inputs.set_point, inputs.speed))

    def step(self, state: Any, inputs: LawInputs[Any]) -> tuple[Any, LawOutputs[Any]]:
        ar = self._ar
        after, outputs = super().step(state.of_ipfc, inputs)
        notch = ar.clip(ar.add(outputs.notch, self._offset), *self._range)
        outputs = outputs._replace(notch=ar.note("shifted", notch, NOTCH_Q))
        return _State(after, ar.sub(inputs.set_point, inputs.speed)), outputs

    def with_sent(self, state: Any, notch: Any) -> Any:
        return state._replace(of_ipfc=super().with_sent(state.of_ipfc, notch))
