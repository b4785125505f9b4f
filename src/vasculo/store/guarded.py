"""A file under HDF5 that keeps the library sound when the disk fails, and writes that no signal cuts in half.

HDF5 cannot close a file whose last writes failed; it crashes instead. So the first failed write is noted, and from then
on nothing more is written, and the library closes in peace. It also writes over what is there long before it is done:
so those bytes are kept until the flush is over, and put back when a write failed.
"""

from __future__ import annotations

import fcntl
import io
import os
import signal
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


class GuardedFile(io.RawIOBase):
    """A file for h5py, locked against other writers.

    Parameters
    ----------
    path : Path
        File.
    mode : str
        "x" for a new file, "r+" for one that is there.

    Attributes
    ----------
    failure : OSError or None
        The first write that failed.

    Raises
    ------
    InputError
        When another process is writing the file.
    """

    def __init__(self, path: Path, mode: str) -> None:
        self.path = path
        self.failure: OSError | None = None
        self._undo: list[tuple[int, bytes]] = []  # what was written over since the last flush: where, and what it was
        self._file = path.open("xb+" if mode == "x" else "rb+", buffering=0)
        self._size = os.fstat(self._file.fileno()).st_size  # at the last flush
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise InputError(f"{path} is being written by another run: wait for its end") from None

    def check(self) -> None:
        """Take what was written as good; or bring the last flush back and raise the write error, if there was one."""
        self._settle()
        if self.failure is not None:
            code = self.failure.errno or 0
            raise OSError(code, os.strerror(code), str(self.path))

    def write(self, data: memoryview) -> int:  # type: ignore[override]
        """Write all of the data, or note why that failed."""
        left = memoryview(data).cast("B")
        size = len(left)
        if self.failure is None:
            try:
                at = self._file.tell()
                self._keep(at, at + size)
                while len(left):
                    left = left[self._file.write(left) :]
            except OSError as error:
                self.failure = error
        return size

    def truncate(self, size: int | None = None) -> int:
        """Cut or lengthen the file, or note why that failed."""
        if self.failure is None:
            try:
                end = self._file.tell() if size is None else size
                self._keep(end, self._size)
                return self._file.truncate(end)
            except OSError as error:
                self.failure = error
        return size or 0

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Read into the buffer; what lies behind the end reads as zeros once a write has failed."""
        count = self._file.readinto(buffer) or 0
        if self.failure is not None and count < len(buffer):
            buffer[count:] = bytes(len(buffer) - count)
            return len(buffer)
        return count

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place in the file."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Say where in the file we are."""
        return self._file.tell()

    def readable(self) -> bool:
        """Say that it can be read."""
        return True

    def writable(self) -> bool:
        """Say that it can be written."""
        return True

    def seekable(self) -> bool:
        """Say that it can be moved in."""
        return True

    def close(self) -> None:
        """Close the file, as the last flush left it when a write failed, and give up the lock."""
        try:
            self._settle()
        finally:
            self._file.close()
            super().close()

    def _keep(self, start: int, end: int) -> None:
        """Note the bytes from `start` to `end`, as far as the last flush had them, before they are lost."""
        end = min(end, self._size)
        if start < end:
            self._undo.append((start, os.pread(self._file.fileno(), end - start, start)))

    def _settle(self) -> None:
        """Forget what was written over; after a failed write put it back, the latest first."""
        if self._file.closed:
            return
        number = self._file.fileno()
        if self.failure is None:
            self._size = os.fstat(number).st_size
        else:
            with suppress(OSError):  # the first error is the one to tell
                os.ftruncate(number, self._size)
                for start, data in reversed(self._undo):
                    os.pwrite(number, data, start)
        self._undo.clear()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back until the block is done, so that it cannot cut a write in half."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
