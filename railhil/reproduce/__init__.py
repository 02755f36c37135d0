"""``railhil reproduce PAPER``: runs the protocol of a paper and sets what is measured beside what is published.

::

    paper.py     what a paper is: runs, tables, statements, figures
    papers.py    the papers by name
    protocol.py  makes the runs of a paper
    document.py  the result as one document, and back
    page.py      the result as a page with its pictures and tables
    show.py      the result on a terminal
    ipfc.py      one module per paper
"""
