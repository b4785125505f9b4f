"""Where the runs of a sweep are computed: worker processes of this machine, or those of a scheduler elsewhere."""

from __future__ import annotations

import logging
import os
import signal
import socket
import sys
import threading
import warnings
from contextlib import contextmanager, suppress
from importlib.machinery import ModuleSpec
from typing import TYPE_CHECKING, Any

import vasculo
from vasculo.errors import InputError, missing_extra
from vasculo.springs.threads import VARIABLE, set_threads
from vasculo.study.sweep.home import PLAN

try:
    import dask
    from dask.system import CPU_COUNT
    from distributed import Client, LocalCluster, WorkerPlugin
except ImportError:
    raise missing_extra("sweeps", "dask and distributed", "sweep") from None

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ANSWER = 10.0
"""Seconds within which a scheduler must answer."""
WORKERS = 30.0
"""Seconds within which it must have a worker."""
DASHBOARD = 8787
_THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


class Prepared(WorkerPlugin):  # type: ignore[misc]  # dask has no types here
    """What a worker does before its first run, also one that is started anew: thread counts, Ctrl-C, checks.

    Parameters
    ----------
    home : Path
        Folder of the sweep, which the worker must see.
    threads : int or None
        Threads of a run; None: as the environment of the worker says, or its share of the processors.
    neighbours : int
        Workers on the same machine.
    """

    idempotent = False
    name = "vasculo-sweep"

    def __init__(self, home: Path, threads: int | None, neighbours: int = 1) -> None:
        self.home, self.threads, self.neighbours, self.version = home, threads, neighbours, vasculo.__version__

    def setup(self, worker: Any) -> None:
        """Prepare the worker.

        Raises
        ------
        InputError
            When it does not see the folder, has another version, or runs several tasks at once.
        """
        if self.version != vasculo.__version__:
            raise InputError(f"worker {worker.address} has vasculo {vasculo.__version__}, not {self.version}")
        if not (self.home / PLAN).is_file():
            raise InputError(
                f"worker {worker.address} does not see {self.home}: a sweep at a scheduler needs a folder on a file "
                "system that all workers share, give it with --out"
            )
        if worker.state.nthreads != 1:
            raise InputError(
                f"worker {worker.address} does {worker.state.nthreads} tasks at once: start it with --nthreads 1, and "
                f"say with the environment variable {VARIABLE} how many threads a run takes"
            )
        if self.threads is not None:
            set_threads(self.threads)
            if threading.current_thread() is threading.main_thread():
                signal.signal(signal.SIGINT, signal.SIG_IGN)  # the sweep tells its workers when to stop
        elif VARIABLE not in os.environ:
            set_threads(max(1, CPU_COUNT // self.neighbours))


@contextmanager
def local_cluster(workers: int | None, home: Path) -> Iterator[Client]:
    """Start worker processes on this machine, which share its processors.

    Parameters
    ----------
    workers : int, optional
        How many; one a processor when left out.
    home : Path
        Folder of the sweep.
    """
    count = workers or CPU_COUNT
    threads = max(1, CPU_COUNT // count)
    settings = {
        "distributed.nanny.pre-spawn-environ": dict.fromkeys(_THREADS, threads),
        "distributed.scheduler.worker-saturation": 1.0,  # a run is long: no worker holds one back
        "distributed.scheduler.worker-ttl": None,  # compiled code may keep the interpreter for long
        "distributed.admin.tick.limit": "1 hour",
    }
    before = dict(os.environ)
    try:
        with (
            _without_main(),
            dask.config.set(settings),
            LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                dashboard_address=f"127.0.0.1:{_dashboard_port()}",
                silence_logs=logging.CRITICAL,
            ) as cluster,
            Client(cluster, set_as_default=False) as client,
        ):
            client.register_plugin(Prepared(home, threads))
            yield client
    finally:
        for name in _THREADS:  # what was set for the workers stays with them
            if name not in before:
                os.environ.pop(name, None)


def _dashboard_port() -> int:
    """Port of the dashboard: the usual one, 0 for any that is free when that one is taken."""
    try:
        with socket.create_server(("127.0.0.1", DASHBOARD)):
            return DASHBOARD
    except OSError:
        return 0


@contextmanager
def _without_main() -> Iterator[None]:
    """Spare new processes the import of the main module, which they have no use for.

    A script need not guard its call then. `multiprocessing` never imports a main module of this name anew.
    """
    main = sys.modules["__main__"]
    before = main.__spec__
    main.__spec__ = ModuleSpec("vasculo.__main__", None)
    try:
        yield
    finally:
        main.__spec__ = before


@contextmanager
def remote_cluster(address: str, home: Path) -> Iterator[Client]:
    """Join a scheduler.

    Parameters
    ----------
    address : str
        As "tcp://host:8786".
    home : Path
        Folder of the sweep; the workers must see it under the same path.

    Raises
    ------
    InputError
        When nobody answers, no worker comes, or a worker cannot be used.
    """
    with _quiet(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # on small differences of versions
        try:
            client = Client(address, timeout=ANSWER, set_as_default=False)
        except (OSError, TimeoutError):
            raise InputError(f"scheduler {address} does not answer within {ANSWER:g} s") from None
        except ValueError as error:
            raise InputError(f"scheduler {address!r} is no address, as tcp://host:8786: {error}") from None
        with client:
            try:
                client.wait_for_workers(1, timeout=WORKERS)
            except TimeoutError:
                raise InputError(
                    f"scheduler {address} has no worker after {WORKERS:g} s: start some with `dask worker {address} "
                    "--nthreads 1`"
                ) from None
            hosts = [worker["host"] for worker in client.scheduler_info(n_workers=-1)["workers"].values()]
            client.register_plugin(Prepared(home, None, max(map(hosts.count, hosts))))
            try:
                yield client
            finally:
                with suppress(OSError, ValueError, TimeoutError):
                    client.unregister_worker_plugin(Prepared.name)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what dask logs about an address that does not answer to itself."""
    logger = logging.getLogger("distributed")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(level)
