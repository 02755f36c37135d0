"""``railhil reproduce PAPER``: runs the protocol of a paper and sets what is measured beside what is published.

::

    paper.py     what a paper is: entries, tables, statements, figures
    papers.py    the papers by name
    ways.py      how an entry is made: a run over the in-process bus, or without a bus
    learned.py   and as a set of sequences
    protocol.py  makes the entries of a paper
    document.py  the result as one document, and back
    page.py      the result as a page with its pictures and tables
    show.py      the result on a terminal
    ipfc         one package per paper: ipfc, ngpc, ilc
"""
