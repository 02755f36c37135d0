"""The papers on nonlinear generalized predictive control of high-speed trains: with an extreme learning machine (one
power unit, DOI 10.12677/mos.2024.135479) and of three power units.

::

    published.py   what they print
    names.py       names of the runs and of their figures
    tables.py      modelling error, tracking, emergency stop, computing effort
    statements.py  what the papers say about them
"""
