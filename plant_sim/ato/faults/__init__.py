"""Faults inside this train."""
