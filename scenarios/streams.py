"""Independent random streams of a run: every random source has its own, so adding one does not change the others.

A stream is ``SeedSequence([seed, stream])`` feeding PCG64 (numpy's default bit generator, whose stream is
fixed by numpy's compatibility policy for seeded bit generators).
"""

from __future__ import annotations

import numpy as np

#: Draws of :func:`railhil.scenarios.perturb.perturbed`.
PERTURBATION = 0
#: Noise of the axle speed sensor.
SPEED_NOISE = 1
#: Search of tuning parameters.
TUNING = 5


def generator(seed: int, stream: int) -> np.random.Generator:
    """Random generator of one stream of one run; ``seed`` and ``stream`` are integers >= 0.

    Raises ``ValueError`` for negative numbers.
    """
    if seed < 0 or stream < 0:
        raise ValueError(f"seed {seed} and stream {stream} must be >= 0")
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, stream])))
