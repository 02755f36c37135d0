"""Scenarios: lines, trains, target speed curves and what is asked of a run.

* :func:`scenarios.load.load`, :func:`scenarios.load.names`: scenarios by shipped name or TOML path
* :mod:`scenarios.model`: the frozen dataclasses that everything else reads
* :class:`scenarios.target.Target`: exact values of a target speed curve
* :func:`scenarios.perturb.perturbed`, :func:`scenarios.streams.generator`: random runs that can be repeated
* :func:`scenarios.generate.generate`: target speed curves for any line and train
* :mod:`scenarios.importers`: railtoolkit and TTOBench files
* :class:`scenarios.errors.InputError`: bad input in one line, for all packages
"""
