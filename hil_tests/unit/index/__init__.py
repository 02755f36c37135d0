"""Tests of railhil.index."""
