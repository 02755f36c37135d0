"""Performance figures of the bench: ``python -m benchmarks`` prints them with the machine they were taken on."""
