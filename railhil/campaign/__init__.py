"""``railhil campaign``: thousands of perturbed runs of several laws, a study (:mod:`railhil.study`).

::

    plan.py      the plan: laws, seeds, chunks; its identity is recorded in campaign.json
    rows.py      a row per run; study.py: the work of a chunk, runs made again, and the record of this kind of study
    summary.py   rows -> statistics.py's figures and worst.py's runs; show.py prints them, report.py draws them
"""

from __future__ import annotations

from railhil.common.callable_package import stand_for

stand_for(__name__, "railhil.library:campaign")
