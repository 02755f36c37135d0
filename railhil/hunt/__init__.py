"""``railhil hunt``: a search for disturbances that violate a requirement, and the least one of each.

::

    plan.py      the request, the base run, the requirements; the cases in parts of a few runs
    cases.py     strategies: (seed, number) -> the faults of a case
    oracle.py    one case as a run, judged: requirements, rules of every run, cells reached
    study.py     the hunt as a study: rows, summary, runs made again
    bounds.py    what may be drawn: [hunt] of the scenario, --what
    draws.py     draws of [perturbations]: at random, by descent, the least ones
    shrink.py    from faults that violate a requirement to smaller ones that violate the same
    least.py     the least case: faults and draws, and the nearest that keeps the requirement
    found.py     the least cases as scenario files, each run again from its file
    tighten.py   the tightest bounds of kept requirements
    nearest.py   the nearest case that keeps the requirement
    show.py      what is printed; report.py, pictures.py: the page
    outcome.py   ``railhil.hunt``, the same as a function

Folder, lock, parts, shards, engines, resuming and ``--verify`` are those of :mod:`railhil.study`.
"""

from __future__ import annotations

from railhil.common.callable_package import stand_for

stand_for(__name__, "railhil.hunt.outcome:hunt")
