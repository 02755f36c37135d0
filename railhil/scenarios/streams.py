"""Independent random streams of a run: every random source has its own, so adding one does not change the others.

A stream is ``SeedSequence([seed, stream])`` feeding PCG64 (numpy's default bit generator, whose stream is
fixed by numpy's compatibility policy for seeded bit generators). Where only a few of its numbers are needed, it feeds
:mod:`railhil.scenarios.counted_normals` instead: the speed sensor of a train on its line.
"""

from __future__ import annotations

import numpy as np

#: Draws of :func:`railhil.systems.ato.scenario.perturb.perturbed`.
PERTURBATION = 0
#: Noise of the axle speed sensors of a high-speed train.
SPEED_NOISE = 1
#: Search of tuning parameters.
TUNING = 5
#: Values of a fault that are drawn once for a run.
FAULT_VALUES = 6
#: All draws of a fault while it is active.
FAULT_SAMPLES = 7
#: Wind on a high-speed train.
WIND = 8
#: Grades of a high-speed line.
GRADES = 9
#: Draws for the train of a sequence of runs, and for its line.
SEQUENCE = 10
#: Draws that differ from run to run of a sequence: values drawn once, noise of the speed, wander of the speed, balises.
RUN_VALUES, RUN_SPEED_NOISE, RUN_WANDER, RUN_BALISES = 11, 12, 13, 14

#: Noise of the axle speed sensor of a train on its line. With this number seed 0, the default, is a typical run of the
#: default scenario: it stops 0.269 m short, the median over 2000 seeds is 0.267 m.
AXLE_NOISE = 24


#: Largest word of a ``SeedSequence``.
_WORD_MAX = 2**32 - 1


def seed_sequence(seed: int, stream: int) -> np.random.SeedSequence:
    """The ``SeedSequence`` of the list ``[seed, stream]``.

    Where each number is one word, it is given as such: numpy takes several times as long to find it in a list.
    """
    small = 0 <= seed <= _WORD_MAX and 0 <= stream <= _WORD_MAX
    return np.random.SeedSequence(np.array([seed, stream], dtype=np.uint32) if small else [seed, stream])


def generator(seed: int, stream: int) -> np.random.Generator:
    """Random generator of one stream of one run; ``seed`` and ``stream`` are integers >= 0.

    Raises ``ValueError`` for negative numbers.
    """
    if seed < 0 or stream < 0:
        raise ValueError(f"seed {seed} and stream {stream} must be >= 0")
    return np.random.Generator(np.random.PCG64(seed_sequence(seed, stream)))


def run_generator(seed: int, stream: int, run_number: int) -> np.random.Generator:
    """Random generator of one stream of one run of a sequence.

    :param seed: of the sequence.
    :param run_number: of the run in it, from 1.
    :raises ValueError: a negative number.
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, stream, run_number])))


def fault_generator(stream: int, run_seed: int, number: int, own_seed: int | None) -> np.random.Generator:
    """Random generator of one fault of a run.

    :param stream: :data:`FAULT_VALUES` or :data:`FAULT_SAMPLES`.
    :param number: the fault's place in the run's list, from 1; unused if it has a seed of its own.
    :param own_seed: the fault's seed; None: from the run's seed and the fault's number.
    :raises ValueError: a negative number.
    """
    entropy = [run_seed, stream, number] if own_seed is None else [own_seed, stream]
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))
