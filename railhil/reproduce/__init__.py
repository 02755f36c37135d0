"""``railhil reproduce PAPER``: runs the protocol of a paper and sets what is measured beside what is published.

::

    paper.py        what a paper is: its text, the entries of its protocol, their measurements
    experiments.py  how an entry is made: over the in-process bus, without a bus, as a set of sequences
    measurement.py  makes and measures the entries
    comparison.py   tables, bands and statements: measured beside published
    document.py     the result as JSON, as a page, as CSV
    ipfc            one package per paper: ipfc, ngpc, ilc

A package of a paper has ``paper.toml`` (what it prints and says, and how it is read), ``runs.py`` (protocol and
measures) and ``findings.py`` (tables, statements, figures).
"""
