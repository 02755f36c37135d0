"""A dask cluster on this machine, for tests and benchmarks."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from distributed import LocalCluster


def loopback_cluster(workers: int) -> LocalCluster:
    """Scheduler and workers with nannies, all on loopback; their dashboards get any free port and are not used."""
    # Every process that collects the tests would load it.
    from distributed import LocalCluster

    pages = "127.0.0.1:0"
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address=pages,
        worker_dashboard_address=pages,
    )
