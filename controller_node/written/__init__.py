"""The shipped laws written out: what a law computes in a control period, as one function of plain Python.

Everything here but ``parts.py`` and ``generate.py`` is written by ``make tables`` from the laws' recorded programs
(:mod:`railhil.controller_node.program.writer`). :mod:`railhil.controller_node.straight` binds the functions to a run.
"""
