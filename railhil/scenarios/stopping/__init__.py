"""Precise stopping at a platform: the system and the keys of its scenarios."""
