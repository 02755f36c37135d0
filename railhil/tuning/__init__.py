"""Tuning of a law by one protocol: the same search, budget, training runs and objective for every law.

``objective`` is the formula, ``trials`` runs candidates, ``search`` finds the best of them, ``document`` writes the
parameter file, ``evaluation`` judges it on runs not used in the search, ``procedure`` is the order of these steps.
"""
