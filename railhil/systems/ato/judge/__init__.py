"""Judging of the train with notches: its criteria, the score of a record, the rules of every run, its events."""
