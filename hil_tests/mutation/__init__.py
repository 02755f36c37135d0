"""Mutation tests: one change at a time in a module, which the module's tests must notice.

``python -m hil_tests.mutation MODULE...`` (without one: all of targets.toml) prints the mutants that survive and
are not explained in survivors.toml; exit code 1 if there are any.
"""
