"""The one place where runs are made. ``railhil.run(...)`` is the library's function of that name.

::

    spec.py        a RunSpec from arguments, checked like a file
    make.py        record_run: a run on any transport, recorded into its folder and judged, with observers
    local.py       a run whose nodes are all in this process
    coupled.py     a run without telegrams: plant and law coupled by raw integers
    replay.py      one node driven by a record
    report.py      the report of runs that have just been recorded
"""

from __future__ import annotations

from railhil.common.callable_package import stand_for

stand_for(__name__, "railhil.library:run")
