"""Transient unstructured grids in the VTKHDF layout: append a frame, read a frame, drop the last frames.

The layout is the public one of VTKHDF 2 (type UnstructuredGrid with a Steps group). Every frame has its own points and
cells; ParaView and pyvista read it as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from numpy.typing import NDArray

    Arrays = dict[str, NDArray[Any]]

LINE, TRIANGLE = 3, 5  # VTK cell types
_CHUNK = 8192  # rows; larger chunks pack better, smaller ones waste less on small studies
_SINGLES = 64  # rows in a chunk of what has one row a frame
_BLOCK = 32 * _CHUNK  # rows written at once; HDF5 copies what does not lie in memory as it does in the file
_GEOMETRY = ("Points", "Types", "Connectivity", "Offsets")


@dataclass(frozen=True)
class GridFrame:
    """One frame of the grid.

    Attributes
    ----------
    points : (n, 2) float64
        Positions, model length.
    lines : (l, 2) int64
        Line cells; they come before the triangles.
    triangles : (t, 3) int64
        Triangle cells.
    point_data, cell_data, field_data : dict of str to array
        Values a point, a cell (lines first) and a frame.
    """

    points: NDArray[np.float64]
    lines: NDArray[np.int64]
    triangles: NDArray[np.int64]
    point_data: Arrays
    cell_data: Arrays
    field_data: Arrays


def growing(group: h5py.Group, name: str, like: NDArray[Any], chunk: int = _CHUNK) -> h5py.Dataset:
    """Create an empty data set that grows by rows of the shape and type of `like`, packed without loss.

    What begins with a single row has one a frame: it is not packed, so that it is not moved when it grows, and stands
    near the start of the file, where it outlives a copy that is broken off.
    """
    shape = like.shape[1:]
    single = len(like) == 1
    packing = {} if single else {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    rows = _SINGLES if single else max(1, chunk // max(1, int(np.prod(shape))))
    return group.create_dataset(
        name, shape=(0, *shape), maxshape=(None, *shape), dtype=like.dtype, chunks=(rows, *shape), **packing
    )


def extend(group: h5py.Group, name: str, rows: NDArray[Any], chunk: int = _CHUNK) -> int:
    """Append `rows` to the data set `name`, made on first use; return the number of rows before."""
    data = group[name] if name in group else growing(group, name, rows, chunk)
    start = int(data.shape[0])
    data.resize(start + len(rows), axis=0)
    for first in range(0, len(rows), _BLOCK):
        data[start + first : start + min(first + _BLOCK, len(rows))] = rows[first : first + _BLOCK]
    return start


class TransientGrid:
    """A growing VTKHDF group.

    Parameters
    ----------
    group : h5py.Group
        The group `VTKHDF`; empty to begin with.
    """

    def __init__(self, group: h5py.Group) -> None:
        self.group = group
        if "Steps" not in group:
            group.attrs["Version"] = np.array([2, 2], dtype=np.int64)
            group.attrs.create("Type", np.bytes_("UnstructuredGrid"))
            steps = group.create_group("Steps")
            steps.attrs["NSteps"] = np.int64(0)
            for kind in ("Point", "Cell", "Field"):
                group.create_group(f"{kind}Data")
                steps.create_group(f"{kind}DataOffsets")
            steps.create_group("FieldDataSizes")
        self.steps = group["Steps"]

    def __len__(self) -> int:
        return int(self.steps.attrs["NSteps"])

    def append(self, value: float, frame: GridFrame) -> None:
        """Append a frame under the time value `value`; `NSteps` is raised last, so a torn frame is never counted."""
        lines, triangles = len(frame.lines), len(frame.triangles)
        connectivity = np.concatenate([frame.lines.ravel(), frame.triangles.ravel()]).astype(np.int64)
        offsets = np.concatenate([2 * np.arange(lines + 1), 2 * lines + 3 * np.arange(1, triangles + 1)])
        points = np.zeros((len(frame.points), 3))
        points[:, :2] = frame.points
        types = np.repeat(np.array([LINE, TRIANGLE], dtype=np.uint8), [lines, triangles])
        starts = {
            "PointOffsets": extend(self.group, "Points", points),
            "CellOffsets": extend(self.group, "Types", types),
            "ConnectivityIdOffsets": extend(self.group, "Connectivity", connectivity),
        }
        extend(self.group, "Offsets", offsets.astype(np.int64))
        parts = extend(self.group, "NumberOfPoints", np.array([len(points)]))
        extend(self.group, "NumberOfCells", np.array([len(types)]))
        extend(self.group, "NumberOfConnectivityIds", np.array([len(connectivity)]))
        for kind, data in (("Point", frame.point_data), ("Cell", frame.cell_data), ("Field", frame.field_data)):
            for name, values in data.items():
                start = extend(self.group[f"{kind}Data"], name, values)
                extend(self.steps[f"{kind}DataOffsets"], name, np.array([start]))
                if kind == "Field":
                    extend(self.steps["FieldDataSizes"], name, np.array([[1, len(values)]]))
        extend(self.steps, "PartOffsets", np.array([parts]))
        extend(self.steps, "NumberOfParts", np.array([1]))
        extend(self.steps, "PointOffsets", np.array([starts["PointOffsets"]]))
        extend(self.steps, "CellOffsets", np.array([[starts["CellOffsets"]]]))
        extend(self.steps, "ConnectivityIdOffsets", np.array([[starts["ConnectivityIdOffsets"]]]))
        extend(self.steps, "Values", np.array([float(value)]))
        self.steps.attrs.modify("NSteps", np.int64(len(self) + 1))

    def read(self, index: int, cell_data: Container[str] | None = None) -> GridFrame:
        """Read frame `index`, counted from 0; of the cell data only the arrays named, or all."""
        group, steps = self.group, self.steps
        part = int(steps["PartOffsets"][index])
        n, cells = int(group["NumberOfPoints"][part]), int(group["NumberOfCells"][part])
        ids = int(group["NumberOfConnectivityIds"][part])
        start = int(steps["PointOffsets"][index])
        first = int(steps["CellOffsets"][index, 0])
        joint = int(steps["ConnectivityIdOffsets"][index, 0])
        connectivity = group["Connectivity"][joint : joint + ids]
        lines = int(np.count_nonzero(group["Types"][first : first + cells] == LINE))
        return GridFrame(
            points=group["Points"][start : start + n, :2],
            lines=connectivity[: 2 * lines].reshape(-1, 2),
            triangles=connectivity[2 * lines :].reshape(-1, 3),
            point_data=self._rows("Point", index, n),
            cell_data=self._rows("Cell", index, cells, cell_data),
            field_data={
                name: group["FieldData"][name][int(at[index]) :][: int(steps["FieldDataSizes"][name][index, 1])]
                for name, at in steps["FieldDataOffsets"].items()
            },
        )

    def _rows(self, kind: str, index: int, count: int, wanted: Container[str] | None = None) -> Arrays:
        offsets: Mapping[str, h5py.Dataset] = self.steps[f"{kind}DataOffsets"]
        rows: Arrays = {}
        for name, at in offsets.items():
            if wanted is None or name in wanted:
                start = int(at[index])
                rows[name] = self.group[f"{kind}Data"][name][start : start + count]
        return rows

    def truncate(self, frames: int) -> None:
        """Keep the first `frames` frames only; torn rows behind the last counted frame go too."""
        steps, group = self.steps, self.group
        frames = min(frames, len(self))
        steps.attrs.modify("NSteps", np.int64(frames))
        if frames == 0:
            _empty(group)
            return
        parts = group["NumberOfPoints"][:frames]
        cells, ids = group["NumberOfCells"][:frames], group["NumberOfConnectivityIds"][:frames]
        ends = {
            "Points": int(parts.sum()),
            "Types": int(cells.sum()),
            "Connectivity": int(ids.sum()),
            "Offsets": int(cells.sum()) + frames,
        }
        for name in _GEOMETRY:
            group[name].resize(ends[name], axis=0)
        for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
            group[name].resize(frames, axis=0)
        for name, data in group["PointData"].items():
            _shorten(data, steps["PointDataOffsets"][name], frames, parts)
        for name, data in group["CellData"].items():
            _shorten(data, steps["CellDataOffsets"][name], frames, cells)
        for name, data in group["FieldData"].items():
            sizes = steps["FieldDataSizes"][name]
            _shorten(data, steps["FieldDataOffsets"][name], frames, sizes[:frames, 1])
            sizes.resize(frames, axis=0)
        for name in ("PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "Values"):
            steps[name].resize(frames, axis=0)


def _empty(group: h5py.Group) -> None:
    """Cut every data set below `group` to no rows."""
    for item in group.values():
        if isinstance(item, h5py.Dataset):
            item.resize(0, axis=0)
        else:
            _empty(item)


def _shorten(data: h5py.Dataset, offsets: h5py.Dataset, frames: int, sizes: NDArray[np.int64]) -> None:
    """Cut a data set behind frame `frames`, and its offsets with it."""
    data.resize(int(offsets[frames - 1] + sizes[frames - 1]), axis=0)
    offsets.resize(frames, axis=0)
