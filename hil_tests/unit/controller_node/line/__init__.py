"""Tests of the controller of a line."""
