"""``railhil probability``: the probability that a drawn run violates a requirement, a study (:mod:`railhil.study`).

::

    sampling.py     subset simulation on any limit state: a pilot fixes bounds and steps, repetitions estimate
    interval.py     repetitions, or counted runs -> the probability and its interval
    limit_state.py  the bench as a function of vectors: margins of a requirement in runs with given draws and noise
    plan.py         the request, the sides of the requirement, the pilot; repetitions as parts
    study.py        rows of a repetition, the summary, rare runs made again through the nodes
    causes.py       shares of the draws and of the noise in the variance of the margin
    least.py        the failing run with the least draws, as a scenario file
    show.py         what is printed; report.py: the page
    outcome.py      ``railhil.probability``, the same as a function

Folder, lock, parts, shards, engines, resuming and ``--verify`` are those of :mod:`railhil.study`.
"""

from __future__ import annotations

from railhil.common.callable_package import stand_for

stand_for(__name__, "railhil.probability.outcome:probability")
