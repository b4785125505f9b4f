"""A record that was cut short: HDF5 refuses it, but reads what is there when it is told the length that is missing."""

from __future__ import annotations

import fcntl
import io
import struct
from typing import TYPE_CHECKING

import h5py

if TYPE_CHECKING:
    from pathlib import Path

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_HEAD, _END = 48, 40  # bytes of the superblock, version 0, up to and before the length of the file
_OFFSETS = b"\x08\x08"  # addresses and lengths of 8 bytes, at byte 13


def whole_length(path: Path) -> int:
    """Length in bytes that an HDF5 file should have by its own account; 0 where it does not say.

    Parameters
    ----------
    path : Path
        A file with a superblock of version 0, as records are written.
    """
    with path.open("rb") as file:
        head = file.read(_HEAD)
    if len(head) < _HEAD or not head.startswith(_SIGNATURE) or head[8] != 0 or head[13:15] != _OFFSETS:
        return 0
    return int(struct.unpack_from("<Q", head, _END)[0])


class ShortenedFile(io.RawIOBase):
    """A file under h5py that gives itself out as longer than it is; what is not there cannot be read.

    Parameters
    ----------
    path : Path
        File; it is only read.
    length : int
        Length to give out, bytes.

    Raises
    ------
    BlockingIOError
        When another process is writing the file.
    """

    def __init__(self, path: Path, length: int) -> None:
        self._file = path.open("rb", buffering=0)
        try:
            fcntl.flock(self._file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise
        self._length = length
        self._there = path.stat().st_size
        self._at = 0

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Read into the buffer.

        Raises
        ------
        OSError
            When not all of it is there.
        """
        if self._at + len(buffer) > self._there:
            raise OSError(f"bytes {self._at} to {self._at + len(buffer)} are missing")
        self._file.seek(self._at)
        count = self._file.readinto(buffer) or 0
        self._at += count
        return count

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place in the file."""
        self._at = offset + (0, self._at, self._length)[whence]
        return self._at

    def tell(self) -> int:
        """Say where in the file we are."""
        return self._at

    def readable(self) -> bool:
        """Say that it can be read."""
        return True

    def seekable(self) -> bool:
        """Say that it can be moved in."""
        return True

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()


def shortened(path: Path) -> str:
    """Say how much of a file is there, in words; empty when none of it is missing."""
    there, whole = path.stat().st_size, whole_length(path)
    return f"cut short: {there:,} of its {whole:,} bytes are there" if there < whole else ""


def open_to_read(path: Path) -> h5py.File:
    """Open an HDF5 file to read, also one that was cut short: reading what is missing raises OSError."""
    return h5py.File(ShortenedFile(path, whole_length(path)), "r") if shortened(path) else h5py.File(path)
