"""An index of the folders below a directory: ``railhil runs``, ``railhil query`` and their page.

::

    find.py    the folders of runs and studies below a directory, and what tells that one has changed
    rows.py    one folder -> its rows, read by the readers of the record
    tables.py  all rows as tables, kept in DIR/.railhil-index as long as the folders are as they were
    show.py    rows by some conditions, as a table of the terminal
    query.py   SQL over the tables
    curves.py  a few points of the speed of a run
    page.py    the page

The folders are the only source. The index can be deleted at any time; the next command makes it again.
"""
