"""The former place of :mod:`railhil.bench` for systems whose laws use an ``Interface``."""

raise ImportError("railhil.vector_bench is gone: direct_run and coupled_run of railhil.bench are for every system")
