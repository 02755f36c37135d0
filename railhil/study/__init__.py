"""Many runs, one table, one page: the engine of ``railhil campaign`` and ``railhil learn``.

::

    plan.py      what a study is: its chunks, its identity, a shard of it, hashes of the code that its figures depend on
    manifest.py  the definition of a study in its folder, from which it is resumed
    parts.py     the folder: the manifest, which is also the lock, and parts that are complete or missing
    work.py      one chunk -> the bytes of its part (any process, any machine)
    engines.py   chunks -> parts, in this process or over the cores; dask_engine.py: over machines
    execute.py   missing parts -> results and summary
    table.py     rows as Parquet, the same bytes for the same rows
    verify.py    what repeats runs of a finished study on the bench
    page.py      tables on the terminal, and the report beside the results
    command.py   options that all studies have
    pool.py      results in the order of their items, in several processes, without a folder
"""
