"""A file under HDF5 that keeps the library sound when the disk fails, and writes that no signal cuts in half.

HDF5 cannot close a file whose last writes failed; it crashes instead. So the first failed write is noted, and from then
on nothing more is written: what lies on the disk stays as the last flush left it, and the library closes in peace.
"""

from __future__ import annotations

import fcntl
import io
import os
import signal
from contextlib import contextmanager
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
        self._file = path.open("xb+" if mode == "x" else "rb+", buffering=0)
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise InputError(f"{path} is being written by another run: wait for its end") from None

    def check(self) -> None:
        """Raise the write error that happened since the file was opened, if one did."""
        if self.failure is not None:
            code = self.failure.errno or 0
            raise OSError(code, os.strerror(code), str(self.path))

    def write(self, data: memoryview) -> int:  # type: ignore[override]
        """Write all of the data, or note why that failed."""
        left = memoryview(data).cast("B")
        size = len(left)
        while len(left) and self.failure is None:
            try:
                left = left[self._file.write(left) :]
            except OSError as error:
                self.failure = error
        return size

    def truncate(self, size: int | None = None) -> int:
        """Cut or lengthen the file, or note why that failed."""
        if self.failure is None:
            try:
                return self._file.truncate(size)
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
        """Close the file and give up the lock."""
        self._file.close()
        super().close()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back until the block is done, so that it cannot cut a write in half."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
