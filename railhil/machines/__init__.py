"""Machines for tests that ask more of the host than it has: a kernel with CAN, a Docker engine.

Each is a command that runs another command inside the capability and returns its exit code:
``railhil vcan -- COMMAND`` and ``python -m railhil.machines.docker_engine -- COMMAND``.
"""
