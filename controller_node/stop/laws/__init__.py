"""The laws of the system ``stop``, one a module of its name."""
