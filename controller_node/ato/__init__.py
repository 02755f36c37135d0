"""The controller of a train under automatic train operation: its watch, the parts of its laws, its C."""
