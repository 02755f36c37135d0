"""The health of the bus after every test of a transport."""

from hil_tests.support.health import bench_runs, healthy  # noqa: F401 - fixtures
