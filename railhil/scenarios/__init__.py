"""Scenarios: lines, trains, target speed curves and the requirements on a run.

* :func:`railhil.scenarios.load.load`, :func:`railhil.scenarios.load.names`: scenarios by shipped name or TOML path
* :mod:`railhil.scenarios.model`: the frozen dataclasses that everything else reads
* :class:`railhil.scenarios.target.Target`: exact values of a target speed curve
* :func:`railhil.scenarios.perturb.perturbed`, :func:`railhil.scenarios.streams.generator`: random runs, repeatable
* :func:`railhil.scenarios.generate.generate`: target speed curves for any line and train
* :mod:`railhil.scenarios.importers`: railtoolkit and TTOBench files
* :class:`railhil.common.errors.InputError`: bad input in one line, for all packages
"""
