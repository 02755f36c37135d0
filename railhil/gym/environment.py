"""The environment: one episode is one run of the bench, recorded and judged like any run."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from railhil.bus.codes import Event
from railhil.common.command_line import SEED_MAX, USUAL_SCENARIO
from railhil.common.errors import InputError, Words
from railhil.common.library_call import PATH, PATH_OR_NONE, TEXTS, Kind, library_call
from railhil.controller_node.given.computing import Quantity, Terms, checked_answer
from railhil.controller_node.given.python import PythonObject
from railhil.gym.commands import GymCommands
from railhil.gym.episode import Episode, EpisodeLeft
from railhil.judge.result import Result
from railhil.record.run_folder import remove_torn_run
from railhil.run.make import record_run
from railhil.run.spec import Settings, Texts, checked_spec, spec_of, with_requirements
from railhil.scenarios.given import NamedCode
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.tuning.objective import Scale, run_cost

#: One value for each reading, or for each command.
Values = NDArray[np.float64]
_CALL = "railhil.gym.RunEnv"
#: Ends of a run that are ends of its task; any other one is a limit of the bench, or no trustworthy run.
_OWN_ENDS = (Event.ENDED_COMPLETE, Event.ENDED_CONTROLLER_LOST)


class RunEnv(gymnasium.Env[Values, Values]):
    """A run as an environment: a step is one control period.

    The observation has the readings of a controller of the user, in their units and order (:attr:`terms`): what the
    controller has accepted from the bus. The action has its commands . The reward is 0 until
    the run ends, and then minus the cost of the run (:mod:`railhil.tuning.objective`), so that the judge alone knows
    what is good.

    An episode is ``terminated`` when the run reaches its own end, and ``truncated`` when its time is over or when it is
    not trustworthy. ``info`` of the last step has ``verdict``, ``reasons``, ``scores``, ``frames_sha256`` and, with
    ``out``, ``folder``. An episode that is left before its end leaves nothing.

    :param scenario, settings, faults, requirements, perturbed: as of :func:`railhil.run`.
    :param reference: law whose run gives the scales of criteria without a limit, such as energy; None: the reward has
        only the criteria with a limit of the scenario.
    :param out: folder in which each finished episode leaves its run folder, ``episode-1`` and so on; None: nothing is
        kept.
    :raises InputError: anything that is not allowed, in one line.
    """

    @library_call(
        _CALL,
        {
            "scenario": PATH,
            "faults": TEXTS,
            "requirements": TEXTS,
            "perturbed": Kind("True or False", lambda value: isinstance(value, bool)),
            "reference": Kind("the name of a law or None", lambda value: value is None or isinstance(value, str)),
            "out": PATH_OR_NONE,
            "render_mode": Kind("None", lambda value: value is None),
        },
        {"--set": "settings", "--fault": "faults"},
    )
    def __init__(
        self,
        scenario: str | Path = USUAL_SCENARIO,
        *,
        settings: Settings = (),
        faults: Texts = (),
        requirements: Texts = (),
        perturbed: bool = False,
        reference: str | None = None,
        out: str | Path | None = None,
        render_mode: None = None,
    ) -> None:
        spec = spec_of(
            scenario, controller=GymCommands, arithmetic=None, indexing="time", parameters=None, settings=settings,
            faults=faults, memory=None, perturbed=perturbed, bus="local",
        )  # fmt: skip
        spec, self._scenario = checked_spec(spec)
        self.run_spec = with_requirements(spec, requirements)
        #: Readings and commands with their units.
        self.terms: Terms = PythonObject(GymCommands).terms_of(self._scenario, self.run_spec)
        scores = [] if reference is None else [_unkept_run(self._with_law(reference), self._scenario).score]
        self._scale = Scale.of(self._scenario, scores, _CALL)
        self._out = None if out is None else Path(out)
        #: Of the last finished episode.
        self.result: Result | None = None
        #: Those given in this episode, for :meth:`GymCommands.play`.
        self.commands: list[tuple[float, ...]] = []
        self._episode: Episode | None = None
        self._finished = 0
        self._reading: tuple[float, ...] = ()
        size = len(self.terms.readings)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float64)
        low, high = (np.array(side, np.float64) for side in zip(*map(_bounds, self.terms.commands), strict=True))
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Values, dict[str, Any]]:
        """Begin a run, up to its first control period; ``info`` has its ``seed``.

        :param seed: of the run, as of :func:`railhil.run`; None: drawn.
        :raises InputError: there is an option, or the run ends before its first control period.
        """
        super().reset(seed=seed)
        if options:
            raise InputError(_CALL, "options", dict(options), "none")
        if seed is not None and seed > SEED_MAX:
            raise InputError(_CALL, "seed", seed, f"at most {SEED_MAX}")
        self.close()
        self.commands = []
        drawn = int(self.np_random.integers(SEED_MAX, endpoint=True)) if seed is None else seed
        self._episode = Episode(partial(self._make, replace(self.run_spec, seed=drawn)))
        found = self._wait()
        if isinstance(found, Result):
            raise InputError(_CALL, "reset", Words(found.line or "a run without one"), "a control period")
        return self._observed(), {"seed": drawn}

    def step(self, action: Values) -> tuple[Values, float, bool, bool, dict[str, Any]]:
        """One control period.

        :param action: the commands, in their units; a controller's limits and rounding apply.
        :raises InputError: they are no finite number for each command; the episode can go on.
        """
        if self._episode is None:
            raise InputError(_CALL, "step", Words("no episode"), "reset() first")
        command = tuple(checked_answer(_CALL, self.terms, np.ravel(action).tolist()))
        self.commands.append(command)
        self._episode.give(command)
        found = self._wait()
        if not isinstance(found, Result):
            return self._observed(), 0.0, False, False, {}
        self._finished += 1
        self.result = found
        is_own_end = found.trusted and found.ended in _OWN_ENDS
        return self._observed(), -run_cost(self._scale, found.score), is_own_end, not is_own_end, self._told(found)

    def close(self) -> None:
        """Leave the episode, if it has not ended."""
        if self._episode is not None:
            self._episode.leave()
            self._episode = None

    def _with_law(self, law: str) -> RunSpec:
        system = self._scenario.installed_system
        system.check_law(law, Path(_CALL), "reference")
        return replace(self.run_spec, law=LawSpec(law, system.arithmetic))

    def _make(self, spec: RunSpec, controller: GymCommands) -> Result:
        """The run, in the thread of its episode."""
        spec = spec.with_code(NamedCode(spec.plant_fmu, PythonObject(controller)))
        if self._out is None:
            return _unkept_run(spec, self._scenario)
        folder = self._out / f"episode-{self._finished + 1}"
        try:
            return record_run(replace(spec, out=folder), scenario=self._scenario)
        except EpisodeLeft:
            remove_torn_run(folder)
            raise

    def _wait(self) -> Any:
        """The next readings, or the result; an episode that has ended is left."""
        assert self._episode is not None
        try:
            found = self._episode.wait()
        except Exception:
            self._episode = None
            raise
        if isinstance(found, Result):
            self._episode = None
        else:
            self._reading = found
        return found

    def _observed(self) -> Values:
        return np.array(self._reading, np.float64)

    def _told(self, result: Result) -> dict[str, Any]:
        """What a finished episode says in ``info``."""
        kept = {} if result.folder is None else {"folder": str(result.folder)}
        return {
            "verdict": result.verdict,
            "reasons": result.line,
            "scores": dict(result.score.values),
            "frames_sha256": result.frames_sha256,
            **kept,
        }


def _unkept_run(spec: RunSpec, scenario: AnyScenario) -> Result:
    """A judged run of which no file is kept."""
    with tempfile.TemporaryDirectory(prefix="railhil-") as private:
        result = record_run(replace(spec, out=Path(private) / "run"), scenario=scenario, keep=False)
        return replace(result, folder=None)


def _bounds(command: Quantity) -> tuple[float, float]:
    """Least and largest value of a command; infinite where they are not stated."""
    largest = np.inf if command.largest is None else command.largest
    return (-largest if command.least is None else command.least), largest
