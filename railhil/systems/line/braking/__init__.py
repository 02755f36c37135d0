"""Braking curves of the train protection: brake model, exact curves, limits of a target, ceiling.

Modelled after the published structure of SUBSET-026-3, 3.13; no implementation of it, no conformity claimed. Formulas
were cross-read in public programs that cite it; the subset itself was not read. Nothing here knows a plant, a law or a
bus: the protection of the train (:mod:`railhil.plant_sim.atp`) and the checks of a scenario use the same curves.
"""
