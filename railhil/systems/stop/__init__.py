"""Judging and pictures of precise stopping."""
