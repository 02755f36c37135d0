"""What happened in a run and why: events derived from the record alone.

``declared`` says where a system reports its reactions, ``derive`` makes the events of a record, ``summary`` says them
in a line and in ``score.json``.
"""
