"""Importers for open rail data: railtoolkit 2022.05 (paths, rolling stock) and TTOBench 1.1-1.2 (tracks)."""
