"""Controllers of systems that plug in: a law that is given a vector of readings and answers a vector of commands."""
