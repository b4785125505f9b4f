"""Ctrl-C that waits for a safe place: compiled code and file libraries do not bear an exception in their midst."""

from __future__ import annotations

import signal
import threading
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from types import FrameType, TracebackType


class Patience:
    """Inside the block the first Ctrl-C is only noted; calling the object at a safe place raises KeyboardInterrupt.

    A second Ctrl-C acts at once. Outside the main thread, and where Ctrl-C is ignored, nothing is changed.
    """

    def __init__(self) -> None:
        self.asked = False
        self._installed = False

    def __enter__(self) -> Self:
        main = threading.current_thread() is threading.main_thread()
        if main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._note)
            self._installed = True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._installed:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def __call__(self, *_: object) -> None:
        """Raise KeyboardInterrupt when Ctrl-C was pressed; takes any arguments, so that it can be a watcher.

        Raises
        ------
        KeyboardInterrupt
            When Ctrl-C was pressed since the block began.
        """
        if self.asked:
            raise KeyboardInterrupt

    def _note(self, signum: int, frame: FrameType | None) -> None:
        if self.asked:
            signal.default_int_handler(signum, frame)
        self.asked = True
