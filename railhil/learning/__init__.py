"""Models learned from recorded runs: a record in, a weights file out."""
