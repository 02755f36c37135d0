"""Evaluation of a record: scores and verdict, events and their causes, invariants, expected reactions to faults."""
