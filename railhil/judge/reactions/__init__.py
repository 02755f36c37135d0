"""The fault catalogue: faults, required reactions of the watches, and the table of the actual reactions."""
