"""Importers for open rail data: railtoolkit (paths, rolling stock), TTOBench (tracks), railML 3 (infrastructure)."""
