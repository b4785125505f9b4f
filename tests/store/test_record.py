"""The record: what a run wrote is what `open_run` reads, also behind an interruption."""

import h5py
import numpy as np
import pytest
import pyvista

from vasculo.errors import InputError
from vasculo.store.frames import BOUNDARY, FLUID, SPRING, edge_rows
from vasculo.store.read import open_run
from vasculo.store.record import Record


def test_everything_reads_back(folder, steps, fab):
    run = open_run(folder)
    assert run.complete
    assert run.settings == {"study": {"title": "fabricated", "seed": 3}}
    assert [(f.stage, f.step) for f in run.frames] == [("vasculogenesis", 10 * k) for k in range(3)] + [
        ("angiogenesis", k) for k in range(4)
    ]
    assert run.steps() == [0, 1, 2, 3]
    assert run.facts("stages")[0]["name"] == "angiogenesis"
    assert run.facts("nothing") == {}
    for step in range(3):
        points, velocities, springs, forces = fab.tissue_frame(step)
        state = run.network(10 * step)
        np.testing.assert_array_equal(state.points, points)
        np.testing.assert_array_equal(state.velocities, velocities)
        np.testing.assert_array_equal(state.springs, springs)
        np.testing.assert_array_equal(state.forces, forces)
    for number, step in enumerate(steps):
        flow = run.flow(number)
        np.testing.assert_array_equal(flow.mesh.points, step.mesh.points)
        np.testing.assert_array_equal(flow.mesh.triangles, step.mesh.triangles)
        np.testing.assert_array_equal(flow.mesh.boundary_tags, step.mesh.boundary_tags)
        assert flow.mesh.side_names == step.mesh.side_names
        np.testing.assert_array_equal(flow.velocity, step.flow.velocity)
        np.testing.assert_array_equal(flow.pressure, step.flow.pressure)
        np.testing.assert_array_equal(flow.node_velocity(), step.flow.node_velocity())
        order = np.lexsort(flow.wall_edges.T), np.lexsort(step.flow.wall_edges.T)
        np.testing.assert_array_equal(flow.wall_edges[order[0]], step.flow.wall_edges[order[1]])
        np.testing.assert_array_equal(flow.wall_shear[order[0]], step.flow.wall_shear[order[1]])
        np.testing.assert_array_equal(flow.wall_pillar[order[0]], step.flow.wall_pillar[order[1]])
        pillars = run.pillars(number)
        assert pillars.lineage == step.lineage
        for mine, theirs in zip(pillars.outlines, step.domain.pillars, strict=True):
            np.testing.assert_array_equal(mine, theirs)
        for mine, theirs in zip(pillars.activation, step.activation, strict=True):
            np.testing.assert_array_equal(mine, theirs)
        assert list(pillars.merge_angles) == [event.angle for event in step.events if event.kind == "merge"]
        assert run.domain(number).sides == step.domain.sides
    assert run.metrics["permeability"][3] == 0.1 / 3
    assert np.isnan(run.metrics["permeability"][0])


def test_pyvista_opens_it_as_it_is(folder, steps):
    reader = pyvista.get_reader(str(folder / "run.vtkhdf"))
    grid = pyvista.read(str(folder / "run.vtkhdf"))
    assert set(grid.cell_data) == {"kind", "force", "velocity", "pressure", "wall_shear", "tag"}
    assert "node_velocity" in grid.point_data
    assert (grid.cell_data["kind"] == SPRING).all()
    reader.reader.SetStep(5)
    grid = reader.read()
    kind, step = grid.cell_data["kind"], steps[2]
    assert (kind == FLUID).sum() == len(step.mesh.triangles)
    assert (kind == BOUNDARY).sum() == len(step.mesh.boundary_edges)
    np.testing.assert_array_equal(grid.cell_data["pressure"][kind == FLUID], step.flow.pressure)
    assert np.isnan(grid.cell_data["pressure"][kind == BOUNDARY]).all()
    fluid = grid.extract_cells(kind == FLUID).compute_cell_sizes(length=False, volume=False)
    assert fluid.cell_data["Area"].sum() == pytest.approx(step.domain.area, rel=1e-12)


def test_a_continued_record_equals_one_in_one_go(folder, tmp_path, fab):
    path = tmp_path / "other.vtkhdf"
    record = Record.create(path, fab.STUDY, "0")
    fab.fill(record, remodelling=2)
    record.close()
    record = Record.reopen(path, 4)  # the second step of the flow is done again
    for number in (1, 2, 3):
        step = fab.flow_step(number)
        row = {"step": number, "time": step.time, "pillars": 2, "permeability": 0.1 / 3}
        record.add_flow(row, step, step.events)
    record.set_facts("stages", [{"name": "angiogenesis", "seconds": 1.5}])
    record.finish()
    record.close()
    with h5py.File(path) as one, h5py.File(folder / "run.vtkhdf") as two:
        names = []
        two.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        for name in names:
            a, b = one[name][()], two[name][()]
            if isinstance(a, np.ndarray):
                np.testing.assert_array_equal(a, b, err_msg=name)
            else:
                assert a == b


def test_the_box_of_a_periodic_tissue(folder):
    assert open_run(folder).network().box is None  # as in every record without such a fact
    for facts, box in (({"box": [1.0, 2.5]}, (1.0, 2.5)), ({"box": None}, None), ({}, None)):
        record = Record.amend(folder / "run.vtkhdf")
        record.set_facts("tissue", facts)
        record.close()
        run = open_run(folder)
        assert run.network(10).box == run.period == box


def test_an_unfinished_record_does_not_look_whole(tmp_path, fab):
    record = Record.create(tmp_path / "run.vtkhdf", fab.STUDY, "0")
    fab.fill(record, remodelling=1)
    record.close()
    assert not open_run(tmp_path).complete


def test_a_record_in_use_is_left_alone(folder):
    record = Record.reopen(folder / "run.vtkhdf", 2)
    with pytest.raises(InputError, match="is being written"):
        open_run(folder)
    with pytest.raises(InputError, match="is being written"):
        Record.reopen(folder / "run.vtkhdf", 2)
    record.close()


def test_too_few_frames(folder):
    with pytest.raises(InputError, match="holds 7 frames, the checkpoint expects 8"):
        Record.reopen(folder / "run.vtkhdf", 8)


def test_no_run(tmp_path):
    with pytest.raises(InputError, match=r"holds no run: there is no run\.vtkhdf"):
        open_run(tmp_path)
    with pytest.raises(InputError, match="holds no run"):
        open_run(tmp_path / "nowhere")


def test_foreign_and_damaged_files(folder):
    path = folder / "run.vtkhdf"
    path.write_bytes(b"not HDF5 at all")
    with pytest.raises(InputError, match="no readable record") as caught:
        open_run(folder)
    assert "\n" not in str(caught.value)
    path.unlink()
    with h5py.File(path, "w") as file:
        file["x"] = 1
    with pytest.raises(InputError, match="no readable record"):
        open_run(folder)
    with h5py.File(path, "w") as file:
        file.create_group("run").attrs.update({"format": 99, "version": "9"})
        file.create_group("VTKHDF")
    with pytest.raises(InputError, match="record format 99"):
        open_run(folder)


def test_steps_that_are_not_there(folder, tmp_path, fab):
    run = open_run(folder)
    assert run.frame("angiogenesis", 100).step == 3
    record = Record.create(tmp_path / "none.vtkhdf", fab.STUDY, "0")
    record.close()
    empty = open_run(tmp_path / "none.vtkhdf")
    with pytest.raises(InputError, match="no recorded step of angiogenesis"):
        empty.flow()
    with pytest.raises(InputError, match="no domain"):
        empty.domain()


def test_edges_that_the_mesh_does_not_have():
    edges = np.array([[0, 1], [2, 1]], dtype=np.int32)
    assert list(edge_rows(edges, np.array([[1, 2]], dtype=np.int32), 5)) == [1]
    assert len(edge_rows(edges, np.empty((0, 2), dtype=np.int32), 5)) == 0
    with pytest.raises(InputError, match="1 wall edges are no boundary edges"):
        edge_rows(edges, np.array([[0, 2], [0, 1]], dtype=np.int32), 5)
