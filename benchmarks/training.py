"""Training of the networks of the high-speed laws: ELM against BP."""

from __future__ import annotations

import numpy as np

from benchmarks.figures import Figure, Setting, cpu_ns
from railhil.controller_node.high_speed.training import Recipe, Rows, train

TITLE = "training of networks"
METHOD = (
    "CPU time of one training, best of the blocks, in turns, on the same 3453 rows (six inputs, a residual of running "
    "resistance and noise), as many as the paper's journey has at 1 s. 20 hidden nodes. ELM: ridge with exact sums in "
    "Python, pseudo-inverse by numpy. BP: L-BFGS-B of scipy, until it converges or after 500 iterations."
)
_ROWS, _QUICK_ROWS = 3453, 300
_SEED = 2024


def _rows(count: int) -> Rows:
    random = np.random.default_rng(_SEED)
    v = np.linspace(0.0, 83.0, count)[:, None] + 0.02 * random.standard_normal((count, 3))
    u = 0.1 * random.standard_normal((count, 3))
    residual = -0.05 - 0.07 * (v[:, 0] / 83.0) ** 2 + 0.1 * u[:, 2] + 0.02 * random.standard_normal(count)
    return Rows(np.column_stack([v, u]), residual)


def measure(setting: Setting) -> list[Figure]:
    """Each kind's training time, as a ratio to the time of the ELM with ridge."""
    rows = _rows(setting.count(_ROWS, _QUICK_ROWS))
    recipes = {
        "ELM, ridge": Recipe(),
        "ELM, pseudo-inverse": Recipe(ridge=None),
        "BP": Recipe("bp"),
    }
    times_ns = cpu_ns(
        setting,
        *(lambda recipe=recipe: train(rows, recipe, 1.0, 0.5, 0.4) for recipe in recipes.values()),
        calls=1,
        blocks=5,
    )
    first = times_ns[0]
    return [
        Figure(name, taken / 1e9, "s", ratio=taken / first, against="ELM, ridge")
        for name, taken in zip(recipes, times_ns, strict=True)
    ]
