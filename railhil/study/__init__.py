"""Many runs, one table, one page: the engine of ``railhil campaign`` and ``railhil learn``.

::

    plan.py      what a study is: its chunks, its identity, a shard of it, hashes of the code that its figures depend on
    manifest.py  the definition of a study in its folder, from which it is resumed
    claim.py     exclusive access to the folder of a study or of a sequence
    parts.py     the folder: the manifest, which is also the lock, and parts that are complete or missing
    work.py      one chunk -> the bytes of its part (any process, any machine)
    engines.py   items -> results, in this process or over the cores; dask_engine.py: over machines
    execute.py   missing parts, made by an engine -> results and summary
    table.py     rows as Parquet, the same bytes for the same rows
    finished.py  summary and rows of a finished study, and what repeats its runs on the bench
    perturbed_runs.py  runs of a law with many seeds, and whether its parameters have seen them
    command.py   options that all studies have, from the command line to results, page and exit code, and ``--verify``

Runs that store no parts (fault table, pairs, ``railhil reproduce``) are made by the engines alone, without libraries of
extras.
"""
