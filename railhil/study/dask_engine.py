"""The dask engine: items go to the workers of a scheduler, which may be on other machines without a shared disk."""

from __future__ import annotations

import asyncio
import logging
import math
import re
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import AbstractContextManager, closing, contextmanager
from typing import Any, TypeVar

from distributed import Client, as_completed
from distributed.comm.core import CommClosedError, connect
from distributed.scheduler import KilledWorker
from distributed.security import Security

from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.exit_codes import INVALID

T = TypeVar("T")
R = TypeVar("R")
#: Address forms that reach other machines; IPv6 in brackets.
_ADDRESS = re.compile(r"(tcp|tls)://([\w.-]+|\[[0-9a-fA-F:.]+\]):(?P<port>\d{1,5})")
_PORT_MAX = 65535
_CONNECT_S = 10.0
#: Time for which a study waits while there is no worker.
_WORKER_S = 60.0
_ASK_S = 1.0
_LOOK_S = 0.02
#: Items handed out per worker core: enough to keep all workers busy, few enough not to overload the scheduler.
_AHEAD = 4


class ClusterLost(Exception):
    """Scheduler or workers are lost; finished parts are kept."""

    exit_code = INVALID


@contextmanager
def connected(address: str, say: Callable[[str], None], *, connect_s: float = _CONNECT_S) -> Iterator[DaskEngine]:
    """The engine at a scheduler.

    :param connect_s: time limit for an answer from the address.
    :raises scenarios.errors.InputError: it is not an address, or there is no answer.
    """
    allowed = "tcp://HOST:PORT of a running dask scheduler"
    match = _ADDRESS.fullmatch(address)
    if match is None or not 1 <= int(match["port"]) <= _PORT_MAX:
        raise InputError("command line", "--scheduler", address, allowed)
    # dask's own log would repeat each loss in many lines.
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        # A client that fails to connect remains half initialised and prints errors when the process ends.
        asyncio.run(_knock(address, connect_s))
        client = Client(address, timeout=connect_s, set_as_default=False, name="railhil-campaign")
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise InputError("command line", "--scheduler", address, allowed, str(error)) from error
    try:
        yield DaskEngine(client, address, say)
    finally:
        client.close(timeout=connect_s)


async def _knock(address: str, connect_s: float) -> None:
    """Connect and disconnect.

    :raises OSError: there is no answer, or the TLS files of dask's configuration cannot be read.
    :raises TypeError, ValueError, RuntimeError: the address does not match dask's TLS configuration.
    """
    comm = await connect(address, timeout=connect_s, **Security().get_connection_args("client"))
    await comm.close()


class DaskEngine:
    """An :class:`~railhil.study.engines.Engine`.

    An item whose worker dies goes to another worker, as often as the scheduler allows (its setting
    ``distributed.scheduler.allowed-failures``, 3 by default).
    """

    def __init__(self, client: Client, address: str, say: Callable[[str], None]) -> None:
        self._client, self._address, self._say = client, address, say
        self._workers: set[str] = set()
        self._cores = 0
        self._asked_s = -math.inf
        self._seen_s = time.monotonic()

    def __call__(
        self, work: Callable[[T], R], items: Sequence[T], /
    ) -> AbstractContextManager[Iterator[tuple[int, R]]]:
        """Results as they arrive. Iterating raises :class:`ClusterLost`, and any exception of the function."""
        return closing(self._results(work, items))

    def _results(self, work: Callable[[T], R], items: Sequence[T]) -> Generator[tuple[int, R], None, None]:
        waiting = list(reversed(range(len(items))))
        places: dict[Any, int] = {}
        ready: Any = as_completed(loop=self._client.loop, with_results=True, raise_errors=False)
        while waiting or not ready.is_empty():
            self._ask()
            while waiting and ready.count() < _AHEAD * max(1, self._cores):
                place = waiting.pop()
                # Keys not derived from content: futures of another study with the same task must not be reused.
                future = self._client.submit(work, items[place], pure=False)
                places[future.key] = place
                ready.add(future)
            if ready.has_ready():
                future, result = next(ready)
                yield places.pop(future.key), self._result(future, result)
            else:
                time.sleep(_LOOK_S)

    def _result(self, future: Any, result: Any) -> Any:
        if future.status == "finished":
            return result
        if future.status != "error":
            raise self._lost()
        error = result[1]
        if isinstance(error, KilledWorker):
            # dask's own message would describe its internals.
            raise ClusterLost(
                f"dask gave up a chunk after its workers died {count_of(error.allowed_failures + 1, 'time')} (memory?)"
            )
        raise error

    def _lost(self) -> ClusterLost:
        return ClusterLost(f"dask scheduler at {self._address} is lost")

    def _ask(self) -> None:
        """Count the workers periodically; report lost ones, end when there have been none for too long."""
        now_s = time.monotonic()
        if self._client.status != "running":
            raise self._lost()
        if now_s - self._asked_s < _ASK_S:
            return
        self._asked_s = now_s
        try:
            cores = dict(self._client.ncores())
        except (OSError, CommClosedError, RuntimeError) as error:
            raise self._lost() from error
        if gone := self._workers - set(cores):
            self._say(f"{len(gone)} dask worker(s) lost, {len(cores)} left: what they had goes to others")
        self._workers, self._cores = set(cores), sum(cores.values())
        if cores:
            self._seen_s = now_s
        elif now_s - self._seen_s > _WORKER_S:
            raise ClusterLost(f"no worker at the dask scheduler {self._address} for {_WORKER_S:g} s")
