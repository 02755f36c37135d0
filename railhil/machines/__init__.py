"""Machines for tests that need more than the host offers: a kernel with CAN, a Docker engine.

Each is a command that runs another command with this capability and returns its exit code:
``railhil vcan -- COMMAND`` and ``python -m railhil.machines.docker_engine -- COMMAND``.
"""
