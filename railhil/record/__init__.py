"""The record of a run: what the supervisor writes while the run is made, and the same read back as telegrams."""
