"""Controllers of plug-in systems: the inputs of a law are a vector of readings, its outputs a vector of commands."""
