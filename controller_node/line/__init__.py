"""The controller on a line with stations: station automaton, and a law for each section."""
