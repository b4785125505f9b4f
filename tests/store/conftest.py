"""Small fabricated steps of both stages, and a record made of them."""

from types import SimpleNamespace

import numpy as np
import pytest

from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.events import Event
from vasculo.pillars.state import RemodelState
from vasculo.store.record import Record
from vasculo.tissue.lattice import lattice

STUDY = '[study]\ntitle = "fabricated"\nseed = 3\n'


def circle(x, y, radius, nodes=20):
    angle = 2 * np.pi * np.arange(nodes) / nodes
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def state_of(step, outlines, lineage):
    """A state that fits the outlines; odd steps have an elastic matrix and filaments that remember."""
    points = np.concatenate(outlines)
    members = [pillar for group in lineage for pillar in group]
    matrix = np.arange(8.0).reshape(4, 2) / (1 + step) if step % 2 else np.zeros((0, 2))
    return RemodelState(
        step=step,
        time=0.1 * step,
        length_unit=1.0 / 3.0,
        shear_unit=2.5,
        shear_ratio=float("inf") if step == 0 else 3.0,
        points=points,
        reference=points * 1.01 if step % 2 else points,
        starts=np.cumsum([0, *(len(outline) for outline in outlines)]).astype(np.int32),
        rest_areas=np.linspace(1.0, 2.0, len(outlines)),
        members=np.array(members, dtype=np.int32),
        member_starts=np.cumsum([0, *(len(group) for group in lineage)]).astype(np.int32),
        touching=np.array([step == 2, False]),
        merges_total=step,
        next_pillar=3,
        quiet_steps=step // 2,
        mesh_points=np.zeros((0, 2)),
        matrix_points=matrix,
        matrix_reference=matrix + 1.0,
        matrix_springs=np.array([[0, 1], [1, 2]], dtype=np.int32)[: len(matrix)],
        matrix_triangles=np.array([[0, 1, 2]], dtype=np.int32)[: len(matrix)],
        matrix_pinned=np.array([True, False, False, True])[: len(matrix)],
    )


def events_of(step):
    """No event at the start, then a merger in each step and another event in some."""
    if step == 0:
        return ()
    merger = Event(step, 0.1 * step, "merge", (1.0, 0.5 * step), ((0,), (2,)), 10.0 * step)
    return (merger, Event(step, 0.1 * step, "border", (0.0, 1.0), ((0, 2),))) if step == 2 else (merger,)


def flow_step(step):
    """Pillars that drift, a real mesh, and fields that are plain functions of the place."""
    domain = Domain.rectangle(4.0, 2.0, [circle(1.0 + 0.02 * step, 1.0, 0.4), circle(2.8, 1.1, 0.3, 16)])
    mesh = generate_mesh(domain, 0.4, 0.2)
    walls = (mesh.boundary_tags >= 0) | (mesh.boundary_tags == -1 - mesh.side_names.index("top"))
    edges = mesh.boundary_edges[walls][::-1]  # the solver need not keep the order of the mesh
    middle = mesh.points[edges].mean(axis=1)
    tags = mesh.boundary_tags[walls][::-1]
    points = mesh.points
    flow = SimpleNamespace(
        velocity=mesh.centroids * 0.5 + step,
        pressure=np.sin(mesh.centroids[:, 0]),
        wall_edges=edges,
        wall_pillar=np.maximum(tags, -1).astype(np.int32),
        wall_shear=np.cos(middle[:, 1]),
        node_velocity=lambda: points * 2.0,
    )
    lineage = ((0, 2), (1,))
    return SimpleNamespace(
        step=step,
        is_last=step == 3,
        time=0.1 * step,
        domain=domain,
        mesh=mesh,
        flow=flow,
        activation=[np.linspace(-1, 1, len(p)) for p in domain.pillars],
        node_shear=[np.full(len(p), 0.5 + step) for p in domain.pillars],
        lineage=lineage,
        events=events_of(step),
        state=state_of(step, domain.pillars, lineage),
    )


def tissue_frame(step):
    network = lattice(60, 1)
    springs = network.springs[: len(network.springs) - 5 * step]
    forces = np.linspace(-0.1, 1.0, len(springs))
    return network.points + 0.001 * step, network.velocities + step, springs, forces


def fill(record, growth=3, remodelling=4):
    for step in range(growth):
        record.add_springs({"step": 10 * step, "time": 2.0 * step, "springs": 100 - step}, *tissue_frame(step))
    for number in range(remodelling):
        step = flow_step(number)
        if number == 0:
            record.set_domain(step.domain)
        record.add_flow({"step": number, "time": step.time, "pillars": 2, "permeability": 0.1 / 3}, step, step.events)


@pytest.fixture
def fab():
    """The makers of fabricated data, for tests that need more than the fixtures."""
    return SimpleNamespace(STUDY=STUDY, circle=circle, flow_step=flow_step, tissue_frame=tissue_frame, fill=fill)


@pytest.fixture
def folder(tmp_path):
    """A folder with a complete record of three frames of the tissue and four of the flow."""
    record = Record.create(tmp_path / "run.vtkhdf", STUDY, "0")
    fill(record)
    record.set_facts("stages", [{"name": "angiogenesis", "seconds": 1.5}])
    record.finish()
    record.close()
    return tmp_path


@pytest.fixture
def steps():
    """The four fabricated steps of the flow."""
    return [flow_step(number) for number in range(4)]
