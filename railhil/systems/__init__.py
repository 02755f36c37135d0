"""The systems of railhil, a folder each, as ``railhil new system`` writes one.

===============  ======================================================================
``__init__.py``  the :class:`~railhil.scenarios.system.System`: names all parts
``task.py``      keys of its scenario files
``judge.py``     criteria, columns, texts of the report
``panels.py``    figures of the report
``batch.py``     many runs at once; with ``kernel.py``, its compiled loops; in ``ato``, which has more, folders
===============  ======================================================================

Its plant and its laws lie in the folders of the same name in :mod:`railhil.plant_sim` and
:mod:`railhil.controller_node`. No other room imports a system: a scenario names it, and it is found as an entry point.
"""
