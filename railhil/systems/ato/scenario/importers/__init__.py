"""Importers for open rail data: railtoolkit (paths, rolling stock) and TTOBench (tracks)."""
