"""README.md and the pages of docs, run: every command, and every figure in a table.

A page is cut into blocks. The first line of a fenced block, or a comment above a table or a paragraph, says what the
block is:

    ```console          commands after ``$``, and what they print: run, the lines and their figures are compared
    ```sh               commands: run, each must end with 0 or with a verdict (1)
    ```python           with ``>>>``: run as doctest; without: parsed
    ```python pytest    a test file: run by pytest
    ```toml             parsed
    ```usage            a command line with all that may follow; its options are compared with the parser's elsewhere
    ```text, ```c, ```yaml    nothing that is run
    <!-- before: railhil run --out RUN -->    what the commands of the block need is made first; may be several lines
    <!-- figures: laws.readings -->   the function ``readings`` of ``hil_tests/documents/laws.py`` computes the figures
    <!-- measured: WHEN, WHERE -->    speed, memory, other hosts: cannot be computed again
    <!-- given: WHAT -->              no result of ours: a published figure, a parameter, a limit

``long`` after the language or the name of the function makes it part of ``make test-long``. ``given 0.3 7`` after the
name of a function says which figures of a paragraph are no results. ``machine`` after the language says that it is not
run: it needs vcan, Docker, an adapter, another host, a file of another tool, a person, or half an hour and more.
A fenced block that does not say what it is fails a test; so does a table with a decimal figure, an output with one, and
in README.md a paragraph with one, that has no comment.

A figures function of a table returns its rows; that of a paragraph returns pieces of its text, in which the numbers are
right: they are looked for where the rest of the piece stands. ``python -m hil_tests.documents`` (``make figures``)
writes what was found into the pages.
"""
