"""Performance figures of the bench: ``python -m benchmarks`` prints them with the machine on which they were
measured."""
