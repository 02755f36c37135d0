"""Events of a run with their causes, derived from the record alone.

``telegrams``: the events of a record; ``summary``: the events in a line and in ``score.json``. The declarations of a
system from which they are found are in :mod:`railhil.judge.declared`.
"""
