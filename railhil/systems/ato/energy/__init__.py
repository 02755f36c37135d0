"""Least traction work of a section: shortest time, bound over all drivings of an ideal train, share of a run."""
