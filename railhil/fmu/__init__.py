"""FMUs (Functional Mock-up Interface 2.0 and 3.0, co-simulation): names, units, checks, steps."""
