"""Ctrl-C and SIGTERM that wait for a safe place: compiled code and file libraries bear no exception in their midst."""

from __future__ import annotations

import os
import signal
import threading
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from types import FrameType, TracebackType


_USUAL: dict[int, Any] = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
"""What the signals do when nobody has changed that."""


class Patience:
    """Inside the block the first Ctrl-C or SIGTERM is only noted; the object raises KeyboardInterrupt when called.

    It is called at safe places. A second one acts at once. Outside the main thread, and where a signal is ignored or
    taken, nothing is changed.
    """

    def __init__(self) -> None:
        self.asked = False
        self._installed: list[int] = []

    def __enter__(self) -> Self:
        main = threading.current_thread() is threading.main_thread()
        self._installed = [number for number, usual in _USUAL.items() if main and signal.getsignal(number) is usual]
        for number in self._installed:
            signal.signal(number, self._note)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number in self._installed:
            signal.signal(number, _USUAL[number])

    def __call__(self, *_: object) -> None:
        """Raise KeyboardInterrupt when Ctrl-C was pressed; takes any arguments, so that it can be a watcher.

        Raises
        ------
        KeyboardInterrupt
            When Ctrl-C was pressed, or the process told to end, since the block began.
        """
        if self.asked:
            raise KeyboardInterrupt

    def _note(self, signum: int, frame: FrameType | None) -> None:
        if self.asked and signum == signal.SIGINT:
            signal.default_int_handler(signum, frame)
        if self.asked:
            signal.signal(signum, _USUAL[signum])
            os.kill(os.getpid(), signum)
        self.asked = True
