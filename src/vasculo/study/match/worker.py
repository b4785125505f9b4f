"""A worker process of the fit: one thread, deaf to Ctrl-C, gone with the process that started it."""

from __future__ import annotations

import os
import signal
from multiprocessing import parent_process
from threading import Thread

from vasculo.springs.threads import set_threads


def begin_worker() -> None:
    """Begin a worker: it keeps to one thread, leaves Ctrl-C to its parent and ends when that ends, even by a kill."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    set_threads(1)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
