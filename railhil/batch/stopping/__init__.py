"""Runs of precise stopping, many at once."""
