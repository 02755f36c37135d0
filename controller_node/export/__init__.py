"""Export of a control law as C99 for the target, from the same recorded program that the bench runs and audits."""

from railhil.controller_node.export.bundle import Bundle, make_bundle, write_bundle

__all__ = ["Bundle", "make_bundle", "write_bundle"]
