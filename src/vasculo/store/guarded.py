"""A file under HDF5 that keeps the library sound when the disk fails, and writes that no signal cuts in half.

HDF5 cannot close a file whose last writes failed; it crashes instead. So the first failed write is noted, and from then
on nothing more is written, and the library closes in peace. It also writes over what is there long before it is done:
so those bytes are kept until the flush is over, and put back when a write failed. They are kept in a file too, so that
a process that is killed in the midst leaves a record that the next one can put in order.
"""

from __future__ import annotations

import fcntl
import io
import os
import signal
import struct
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


_PIECE = struct.Struct("<qq")  # where bytes were written over, and how many

Pieces = list[tuple[int, bytes]]


def undo_path(path: Path) -> Path:
    """File beside a guarded one that holds what was written over since its last flush."""
    return path.with_name(f".{path.name}.undo")


def mend(path: Path) -> None:
    """Bring a file whose writer was killed back to its last flush; one that was cut short since then is left as it is.

    Raises
    ------
    InputError
        When another process is writing the file.
    """
    if undo_path(path).exists() and not _is_cut(path):
        GuardedFile(path, "r+").close()


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
        self._journal: io.FileIO | None = None  # made once the file is ours
        self._undo: Pieces = []  # what was written over since the last flush: where, and what it was
        self._file = path.open("xb+" if mode == "x" else "rb+", buffering=0)
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise InputError(f"{path} is being written by another run: wait for its end") from None
        if mode != "x" and (left := _left_behind(undo_path(path))) is not None:
            _put_back(self._file.fileno(), *left)
        self._size = os.fstat(self._file.fileno()).st_size  # at the last flush
        self._journal = undo_path(path).open("wb", buffering=0)

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
            if self._journal is not None and not self._journal.closed:
                undo_path(self.path).unlink(missing_ok=True)
                self._journal.close()
        finally:
            self._file.close()
            super().close()

    def _keep(self, start: int, end: int) -> None:
        """Note the bytes from `start` to `end`, as far as the last flush had them, before they are lost."""
        end = min(end, self._size)
        if start < end:
            data = os.pread(self._file.fileno(), end - start, start)
            head = b"" if self._undo else _PIECE.pack(self._size, 0)
            if self._journal is not None:
                self._journal.write(head + _PIECE.pack(start, len(data)) + data)
            self._undo.append((start, data))

    def _settle(self) -> None:
        """Forget what was written over; after a failed write put it back, the latest first."""
        if self._file.closed:
            return
        number = self._file.fileno()
        if self.failure is None:
            self._size = os.fstat(number).st_size
        else:
            with suppress(OSError):  # the first error is the one to tell
                _put_back(number, self._size, self._undo)
        if self._undo and self._journal is not None:
            self._journal.seek(0)
            self._journal.truncate()
        self._undo.clear()


def _put_back(number: int, size: int, pieces: Pieces) -> None:
    """Bring an open file back to an earlier size and content, the latest piece first."""
    os.ftruncate(number, size)
    for start, data in reversed(pieces):
        os.pwrite(number, data, start)


def _left_behind(path: Path) -> tuple[int, Pieces] | None:
    """Read what a killed process left: the size of the last flush, and the whole pieces; None when it left nothing."""
    content = path.read_bytes() if path.exists() else b""
    if len(content) < 2 * _PIECE.size:
        return None
    size, _ = _PIECE.unpack_from(content)
    pieces, at = [], _PIECE.size
    while at + _PIECE.size <= len(content):
        start, count = _PIECE.unpack_from(content, at)
        at += _PIECE.size
        if at + count > len(content):  # killed before these bytes were written over
            break
        pieces.append((start, content[at : at + count]))
        at += count
    return size, pieces


def _is_cut(path: Path) -> bool:
    """Whether bytes of the last flush are neither in the file nor among those that a killed process left."""
    left, there = _left_behind(undo_path(path)), path.stat().st_size
    if left is None:
        return False
    size, pieces = left
    return there < size and not any(start <= there and start + len(data) >= size for start, data in pieces)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C and SIGTERM back until the block is done, so that they cannot cut a write in half."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
