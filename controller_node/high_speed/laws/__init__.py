"""The laws of the systems ``hst1`` and ``emu3``, one a module of its name."""
