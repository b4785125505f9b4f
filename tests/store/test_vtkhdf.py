"""The transient grid: what is appended reads back, here and in VTK; what is dropped is gone."""

import h5py
import numpy as np
import pytest
import pyvista

from vasculo.store import vtkhdf
from vasculo.store.ragged import Ragged
from vasculo.store.vtkhdf import GridFrame, TransientGrid


def make(seed, nodes, lines, triangles):
    rng = np.random.default_rng(seed)
    cells = lines + triangles
    return GridFrame(
        points=rng.random((nodes, 2)),
        lines=rng.integers(0, nodes, (lines, 2)),
        triangles=rng.integers(0, nodes, (triangles, 3)),
        point_data={"p": rng.random((nodes, 3))},
        cell_data={"c": rng.random(cells), "tag": rng.integers(-5, 5, cells).astype(np.int32)},
        field_data={"time": rng.random(1)},
    )


FRAMES = [make(0, 9, 12, 0), make(1, 7, 3, 5), make(2, 20, 0, 11), make(3, 4, 2, 2)]


def same(one, two):
    for name in ("points", "lines", "triangles"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
    for name in ("point_data", "cell_data", "field_data"):
        a, b = getattr(one, name), getattr(two, name)
        assert a.keys() == b.keys()
        for key in a:
            np.testing.assert_array_equal(a[key], b[key])


def write(path, frames):
    with h5py.File(path, "w") as file:
        grid = TransientGrid(file.create_group("VTKHDF"))
        for number, frame in enumerate(frames):
            grid.append(float(number), frame)
    return path


def test_frames_read_back_exactly(tmp_path):
    with h5py.File(write(tmp_path / "a.vtkhdf", FRAMES)) as file:
        grid = TransientGrid(file["VTKHDF"])
        assert len(grid) == len(FRAMES)
        for number, frame in enumerate(FRAMES):
            same(grid.read(number), frame)


def test_large_frames_are_written_block_by_block(tmp_path, monkeypatch):
    monkeypatch.setattr(vtkhdf, "_BLOCK", 5)
    with h5py.File(write(tmp_path / "a.vtkhdf", FRAMES)) as file:
        grid = TransientGrid(file["VTKHDF"])
        for number, frame in enumerate(FRAMES):
            same(grid.read(number), frame)


def test_only_the_wanted_values_are_read(tmp_path):
    with h5py.File(write(tmp_path / "a.vtkhdf", FRAMES)) as file:
        frame = TransientGrid(file["VTKHDF"]).read(1, {"tag"})
    assert list(frame.cell_data) == ["tag"]
    np.testing.assert_array_equal(frame.cell_data["tag"], FRAMES[1].cell_data["tag"])
    np.testing.assert_array_equal(frame.points, FRAMES[1].points)


def test_vtk_reads_the_same_numbers(tmp_path):
    reader = pyvista.get_reader(str(write(tmp_path / "a.vtkhdf", FRAMES)))
    reader.reader.UpdateInformation()
    assert reader.reader.GetNumberOfSteps() == len(FRAMES)
    for number, frame in enumerate(FRAMES):
        reader.reader.SetStep(number)
        grid = reader.read()
        np.testing.assert_array_equal(grid.points[:, :2], frame.points)
        np.testing.assert_array_equal(grid.points[:, 2], 0.0)
        kinds = np.repeat([3, 5], [len(frame.lines), len(frame.triangles)])
        np.testing.assert_array_equal(grid.celltypes, kinds)
        joints = np.concatenate([frame.lines.ravel(), frame.triangles.ravel()])
        np.testing.assert_array_equal(grid.cell_connectivity, joints)
        np.testing.assert_array_equal(grid.cell_data["c"], frame.cell_data["c"])
        np.testing.assert_array_equal(grid.cell_data["tag"], frame.cell_data["tag"])
        np.testing.assert_array_equal(grid.point_data["p"], frame.point_data["p"])
        np.testing.assert_array_equal(grid.field_data["time"], frame.field_data["time"])


@pytest.mark.parametrize("kept", [0, 1, 2, 3])
def test_truncated_and_continued_is_as_if_never_longer(tmp_path, kept):
    path = write(tmp_path / "a.vtkhdf", FRAMES)
    with h5py.File(path, "r+") as file:
        grid = TransientGrid(file["VTKHDF"])
        grid.truncate(kept)
        assert len(grid) == kept
        grid.append(9.0, FRAMES[0])
        for number in range(kept):
            same(grid.read(number), FRAMES[number])
        same(grid.read(kept), FRAMES[0])
        assert len(file["VTKHDF/Points"]) == sum(len(f.points) for f in FRAMES[:kept]) + len(FRAMES[0].points)


def test_a_torn_frame_does_not_count_and_does_not_disturb(tmp_path):
    path = write(tmp_path / "a.vtkhdf", FRAMES[:2])
    with h5py.File(path, "r+") as file:
        grid = TransientGrid(file["VTKHDF"])
        torn = make(5, 6, 4, 4)
        torn.field_data["time"] = None  # stops the append half-way
        with pytest.raises(TypeError):
            grid.append(2.0, torn)
        assert len(grid) == 2
        same(grid.read(1), FRAMES[1])
        grid.truncate(2)
        grid.append(2.0, FRAMES[2])
        same(grid.read(2), FRAMES[2])


def test_ragged_frames(tmp_path):
    frames = [{"a": np.arange(n), "b": np.ones((2 * n, 2))} for n in (3, 0, 5)]
    with h5py.File(tmp_path / "r.h5", "w") as file:
        ragged = Ragged(file.create_group("g"))
        for frame in frames:
            ragged.append(frame)
        assert len(ragged) == 3
        for number, frame in enumerate(frames):
            for name, rows in frame.items():
                np.testing.assert_array_equal(ragged.read(number)[name], rows)
        ragged.truncate(1)
        ragged.append(frames[2])
        np.testing.assert_array_equal(ragged.read(1)["a"], frames[2]["a"])
        ragged.truncate(0)
        assert len(ragged) == 0
