"""The run on a bus, as identified by the handshake of its plant, and the installed scenario and law with these
hashes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent, Ident, PltIdent, is_perturbed, laws_of_code
from railhil.bus.store import TrafficStore
from railhil.common.errors import OptionError
from railhil.common.plug_ins import entries
from railhil.controller_node.telemetry_file import law_notes
from railhil.dbc import house_contract
from railhil.scenarios.load import load_any, names
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import DEFAULT, GROUP, System, UnknownScenario, system_named

#: Hexadecimal digits of a hash that the handshake carries.
_DIGITS = 8


@cache
def _shipped() -> Mapping[str, str]:
    """Name of each shipped scenario by the hash that the handshake carries."""
    return {load_any(name).sha256[:_DIGITS]: name for name in names()}


def _system(wire_hash: int) -> System | None:
    """The installed system with this wire contract."""
    systems = map(system_named, entries(GROUP))
    return next((one for one in systems if int(one.contract.sha256[:_DIGITS], 16) == wire_hash), None)


def named_scenario(name: str | None, settings: Sequence[str], faults: Sequence[str]) -> AnyScenario | None:
    """The scenario named on a watcher's command line; None: there is none.

    :raises InputError: it cannot be loaded, or only its settings or faults are named.
    """
    if name is not None:
        return load_any(name, settings, faults)
    if settings or faults:
        option = "--set" if settings else "--fault"
        raise OptionError(option, "used only after a SCENARIO")
    return None


class RunIdentity:
    """The run on a bus, identified by its handshake telegrams.

    :param named: the scenario that the user believes to run; None: the plant's. :param law: the same for the law.
    :raises InputError: there is no such law.
    """

    def __init__(self, named: AnyScenario | None, law: str | None = None) -> None:
        ports = [house_contract().port(kind.PORT) for kind in (PltIdent, CtlIdent)]
        self._ids = {can_id for port in ports for can_id in (*port.can_ids, port.fd_id)}
        self._store = TrafficStore(ports)
        self._named, self._law = named, law
        #: The displayed scenario; None: nothing, because the system is unknown.
        self.scenario = named
        #: The law's declaration of its notes; None: not known, or the same for every law of the system.
        self.notes: Sequence[Mapping[str, Any]] | None = None
        if named is not None:
            self.notes = law_notes(named.installed_system, law)
        if law is not None and not any(law in system_named(name).law_names() for name in entries(GROUP)):
            system_named(DEFAULT).check_law(law, "command line", "--controller")
        if named is None:
            # Computed now rather than while frames wait.
            _shipped()
        #: The named scenario runs with added faults: the plant's hash cannot confirm more.
        self.has_further_faults = False
        self._plant: Ident | None = None
        self._law_code = 0
        self._known_identity: tuple[int, ...] = ()

    def take(self, frames: Iterable[Frame]) -> bool:
        """Take frames in bus order; returns whether another run or scenario is shown from now on."""
        for frame in frames:
            if frame.can_id not in self._ids or (port := self._store.feed(frame, 0)) is None:
                continue
            kind = PltIdent if port == PltIdent.PORT else CtlIdent
            ident = kind.decode(self._store.raw(port))
            if not ident.is_own:
                continue
            if kind is PltIdent:
                if self._plant is None or ident.scenario_hash != self._plant.scenario_hash:
                    self._law_code = 0
                self._plant = ident
            self._law_code = ident.law or self._law_code
        if self._plant is None or self._identity == self._known_identity:
            return False
        self._known_identity = self._identity
        shown = self.scenario, self.notes
        self._look_up()
        return (self.scenario, self.notes) != shown

    @property
    def _identity(self) -> tuple[int, ...]:
        plant = self._plant
        told = () if plant is None else (plant.wire_hash, plant.scenario_hash, self._law_code)
        return *told, self.has_further_faults

    def _look_up(self) -> None:
        plant, named = self._plant, self._named
        assert plant is not None
        system = _system(plant.wire_hash)
        digits = f"{plant.scenario_hash:0{_DIGITS}x}"
        if system is None:
            self.scenario, self.notes = None, None
            return
        if named is not None and (self.has_further_faults or named.sha256[:_DIGITS] == digits):
            self.scenario = named
        elif (name := _shipped().get(digits)) is not None:
            self.scenario = load_any(name)
        else:
            self.scenario = UnknownScenario.from_handshake(system.name, plant.scenario_hash, system.contract)
        laws = laws_of_code(self._law_code, system.laws)
        law = laws[0] if len(laws) == 1 else self._law
        self.notes = law_notes(system, law if law in system.law_names() else None)

    @property
    def run(self) -> str:
        """The run in words: scenario, law and seed, each with the plant's statement."""
        plant = self._plant
        if plant is None:
            return "the plant has not told yet what it runs"
        digits = f"{plant.scenario_hash:0{_DIGITS}x}"
        known = self.scenario is not None and not isinstance(self.scenario, UnknownScenario)
        parts = [f"{self.scenario.name} ({digits})" if known and self.scenario is not None else f"scenario {digits}"]
        if self.scenario is not None and self._law_code:
            laws = laws_of_code(self._law_code, self.scenario.installed_system.laws)
            parts.append(f"law {' or '.join(laws) or f'{self._law_code:03x}'}")
        else:
            parts.append("law not told")
        parts.append(f"seed {plant.seed}{', perturbed' if is_perturbed(plant) else ''}")
        return ", ".join(parts)

    @property
    def said(self) -> tuple[str, str]:
        """Run and remark, either of them empty; before the plant has told what it runs, the remark alone says so."""
        return ("" if self._plant is None else self.run), self.warning

    @property
    def warning(self) -> str:
        """The remark on the display; empty: none."""
        plant, named = self._plant, self._named
        if plant is None:
            if named is None:
                return "the plant has not told yet what it runs: nothing is shown before; or name the scenario"
            return f"the plant has not told yet what it runs: shown as {named.name}, as the command line says"
        digits = f"{plant.scenario_hash:0{_DIGITS}x}"
        if self.scenario is None:
            return f"no system here has the wire contract {plant.wire_hash:08x} that the plant tells: nothing is shown"
        if isinstance(self.scenario, UnknownScenario):
            return (
                f"no scenario here has the hash {digits} that the plant tells: only what the wire says is shown. "
                "Name it, with its --set and --fault, on the command line"
            )
        if named is not None and self.scenario is not named:
            return f"the plant runs {self.scenario.name}, not {named.name} as the command line says"
        return ""
