"""Events of a run with their causes, derived from the record alone.

``declared``: the reports of a system's reactions; ``derive``: the events of a record; ``summary``: the events in a line
and in ``score.json``.
"""
