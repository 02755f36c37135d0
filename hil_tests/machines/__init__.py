"""Machines for tests that need more than the kernel with CAN of ``railhil vcan``: Docker engines, another processor.

``python -m hil_tests.machines.docker_engine -- COMMAND`` runs a command with an engine and returns its exit code.
"""
