"""The laws of the system ``ato``, one a module of its name."""
