"""What a record says: scores and verdict, events and their causes, invariants, expected reactions to faults."""
