"""The place of a stop that the train passes without a halt.

It has a module of its own, because the compiled build (setup.py) cannot make a class of one with ``__slots__``.
"""

from __future__ import annotations

from railhil.systems.ato.scenario.model import Balise


class PassMark(Balise):
    """The place of a stop that the train passes; ``number`` is the stop's, from 0."""
