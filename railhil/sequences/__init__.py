"""``railhil learn`` and ``railhil sequence``: runs in a row of a law that keeps a memory from run to run.

::

    plan.py      the plan: a law, seeds of sequences, runs of each; its identity is recorded in learn.json
    one.py       one run with the memory that it begins with, without a bus if the system can; a whole sequence
    table.py     a row per run; study.py: the work of a chunk, and the record of this kind of study (railhil/study)
    summary.py   results -> figures by run, and runs until the law has learned
    show.py      prints them; report.py draws them
    evidence.py  one sequence recorded as run folders, with one hash over all of them
"""
