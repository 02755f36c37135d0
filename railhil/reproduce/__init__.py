"""``railhil reproduce PAPER``: runs the protocol of a paper and sets measured figures beside the published ones.

::

    paper.py        a paper as data: its text, the entries of its protocol, their measurements
    experiments.py  makes an entry: over the in-process bus, without a bus, as a set of sequences
    measurement.py  makes and measures the entries
    comparison.py   tables, bounds and statements, measured beside published
    document.py     the result as JSON, as a page, as CSV
    papers/         printed values, statements, bounds and readings of each paper, perhaps its sets of runs
    ipfc, ngpc, ilc the papers: protocol and measures (``runs``), tables, statements and figures (``findings``)
"""
