"""The bench as an environment of Gymnasium (extra ``gym``); guide: docs/howto/gym.md.

::

    commands.py      a controller whose commands come from outside, or from a list
    episode.py       a run that waits at each control period for its commands
    environment.py   the environment: readings, commands, reward

``gymnasium.make("railhil.gym:railhil/Run-v0", scenario=...)`` makes the same environment as :class:`RunEnv`.
"""

from __future__ import annotations

from railhil.common.extras import need
from railhil.gym.commands import GymCommands

gymnasium = need("gymnasium", "gym", command="railhil.gym")

from railhil.gym.environment import RunEnv  # noqa: E402

__all__ = ["GymCommands", "RunEnv"]

gymnasium.register("railhil/Run-v0", entry_point=RunEnv)
