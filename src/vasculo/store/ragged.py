"""Arrays of a different length every frame, end to end in one data set each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.store.vtkhdf import extend

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    import h5py
    from numpy.typing import NDArray


_CHUNK = 512  # values; few frames share a chunk, so that few are lost where a file is damaged


class Ragged:
    """Named arrays a frame in an HDF5 group; `ends/<name>` holds the row behind the last of each frame.

    Parameters
    ----------
    group : h5py.Group
        Empty to begin with. All frames must hold the same names.
    """

    def __init__(self, group: h5py.Group) -> None:
        self.group = group
        self.ends = group.require_group("ends")

    def __len__(self) -> int:
        return min((len(data) for data in self.ends.values()), default=0)

    def append(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Append one frame."""
        for name, rows in arrays.items():
            start = extend(self.group, name, np.asarray(rows), _CHUNK)
            extend(self.ends, name, np.array([start + len(rows)]))

    def read(self, index: int, wanted: Container[str] | None = None) -> dict[str, NDArray[Any]]:
        """Read frame `index`, counted from 0; only the arrays named, or all."""
        return {
            name: self.group[name][int(ends[index - 1]) if index else 0 : int(ends[index])]
            for name, ends in self.ends.items()
            if wanted is None or name in wanted
        }

    def truncate(self, frames: int) -> None:
        """Keep the first `frames` frames only."""
        for name, ends in self.ends.items():
            kept = min(frames, len(ends))
            self.group[name].resize(int(ends[kept - 1]) if kept else 0, axis=0)
            ends.resize(kept, axis=0)
