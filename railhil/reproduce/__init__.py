"""``railhil reproduce PAPER``: runs the protocol of a paper and sets measured figures beside the published ones.

::

    paper.py        a paper as data: its text, the entries of its protocol, their measurements
    experiments.py  makes an entry: over the in-process bus, without a bus, as a set of sequences
    measurement.py  makes and measures the entries
    comparison.py   tables, bounds and statements, measured beside published
    document.py     the result as JSON, as a page, as CSV
    ipfc            one package per paper: ipfc, ngpc, ilc

A package of a paper has ``paper.toml`` (its printed values, statements, bounds and their readings, perhaps its sets of
runs), ``runs.py`` (protocol and measures) and ``findings.py`` (tables, statements, perhaps figures).
"""
