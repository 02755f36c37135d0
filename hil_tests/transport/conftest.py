"""Check of the bus after every test of a transport."""

from hil_tests.support.health import healthy, noted_runs, pytest_runtest_setup  # noqa: F401 - fixtures, hook
