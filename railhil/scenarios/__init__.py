"""Scenarios of any system: files and their layers, the description of a run, random streams, systems by name.

* :func:`railhil.scenarios.load.load_any`, :func:`railhil.scenarios.load.names`: scenarios by shipped name or TOML path
* :mod:`railhil.scenarios.model`: what the bench needs of a scenario
* :mod:`railhil.scenarios.task`: scenarios with a section ``[task]``, which a system defines
* :mod:`railhil.scenarios.run_spec`: what describes a run
* :class:`railhil.scenarios.system.System`: a kind of train and task
* :class:`railhil.common.errors.InputError`: bad input in one line, for all packages
"""
