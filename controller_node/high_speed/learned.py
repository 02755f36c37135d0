"""Base of the laws whose residual a network estimates, and the networks that come with the bench.

A law takes the network that was trained on the residual of its own linear model (sampling period, delay, lag): from its
parameters, a file that ``railhil train-model`` has written, else from the shipped file ``weights/<law>_<system>.toml``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, TypeAdapter, ValidationError

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.high_speed.identification import Estimate, Estimator, Past
from railhil.controller_node.high_speed.law import JOURNEYS, Unit
from railhil.controller_node.high_speed.network import Forward, Network
from railhil.controller_node.high_speed.ngpc import GpcParameters, NgpcLaw
from railhil.controller_node.vector.reals import Reals
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.validation import describe_allowed, join_keys

WEIGHTS = Path(__file__).with_name("weights")
_HINT = "railhil train-model makes one from a recorded run"
_NETWORKS = TypeAdapter(tuple[Network, ...])


def shipped_networks(law: str, system: str, folder: Path = WEIGHTS) -> tuple[Network, ...]:
    """The networks of a shipped weights file; none if there is no such file.

    :param law: the law in whose name they were trained.
    :raises InputError: the file is not a weights file.
    """
    path = folder / f"{law}_{system}.toml"
    if not path.is_file():
        return ()
    given = load_parameters(path)
    try:
        return _NETWORKS.validate_json(json.dumps(given.values.get("networks", ())), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = join_keys(("parameters", "networks", *first["loc"]))
        raise InputError(path, key, first["input"], describe_allowed(first), _HINT) from None


@dataclass(frozen=True)
class LearnedParameters(GpcParameters):
    """Parameters of a law with networks."""

    #: The model is identified, too, as in both papers; on differences, the reading that works (D4).
    ident: Literal["paper", "differenced", "off"] = "differenced"
    #: One for each linear model, as ``railhil train-model`` writes them; none: the networks that come with the bench.
    networks: Annotated[tuple[Network, ...], Field(max_length=8)] = ()


class LearnedLaw(NgpcLaw[T]):
    """A law whose estimator of xi contains a network.

    :raises InputError: as for every law of the family; there is no network for the linear model of a unit.
    """

    parameters_type = LearnedParameters
    #: Trained on 1; hidden layer and weight decay were chosen on 21 to 23 and 203.
    design_seeds: ClassVar[Mapping[str, range]] = dict.fromkeys(JOURNEYS, range(1, 204))
    #: Kind of its networks, and the law whose shipped file it uses.
    kind: ClassVar[str]
    weights_of: ClassVar[str]

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        given = parameters or self.parameters_type()
        self._networks = given.networks or shipped_networks(self.weights_of, scenario.system)
        super().__init__(arithmetic, scenario, given)

    def network(self, unit: Unit, parameters: GpcParameters) -> Network:
        """The network for the linear model of a unit.

        :raises InputError: there is none, or it is of another kind.
        """
        delay_s = unit.traction_delay_s if parameters.model_delay_s is None else parameters.model_delay_s
        lag_s = unit.lag_s if parameters.model_lag_s is None else parameters.model_lag_s
        wanted = (unit.sample_period_s, delay_s, lag_s)
        for network in self._networks:
            found = (network.sample_period_s, network.model_delay_s, network.model_lag_s)
            if all(abs(a - b) < 1e-9 for a, b in zip(wanted, found, strict=True)):
                if network.kind != self.kind:
                    raise InputError("controller", f"{self.name}, networks", network.kind, self.kind, _HINT)
                return network
        allowed = "one trained for T0 = {:g} s and a model with a delay of {:g} s and a lag of {:g} s".format(*wanted)
        raise InputError("controller", f"{self.name}, networks", Words("no such network"), allowed, _HINT)

    def estimator(self, re: Reals[T], unit: Unit, parameters: LearnedParameters) -> Estimator[T, Any]:
        network = self.network(unit, parameters)
        forward = Forward(re.ar, network)
        re.constants += [item for item in forward.constants if item not in re.constants]
        return self.learned(re, forward, parameters)

    def learned(self, re: Reals[T], forward: Forward[T], parameters: Any) -> Estimator[T, Any]:
        """The estimator with this network; by default it does not learn on-line."""
        return NetworkEstimator(forward)


class NetworkEstimator(Estimator[T, tuple[()]]):
    """xi(k-1) is the output of a network for the regressors, nothing is learned on-line (004 eq. 17)."""

    def __init__(self, forward: Forward[T]) -> None:
        self._forward = forward

    def start(self) -> tuple[()]:
        return ()

    def step(self, memory: tuple[()], past: Past[T], residual: T) -> tuple[tuple[()], Estimate[T]]:
        layer = self._forward.layer((*past.speeds, *past.commands))
        value = self._forward.value(layer, self._forward.output)
        return memory, Estimate(value, value)
