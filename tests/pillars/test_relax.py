from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import Delaunay
from tests.pillars.shapes import disk

from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.pillars import coarse
from vasculo.pillars.cell import filaments, side_lengths, stack
from vasculo.pillars.matrix import lay_matrix
from vasculo.pillars.relax import Network, relax
from vasculo.pillars.relax_plain import forces_plain, relax_plain
from vasculo.springs.threads import get_threads, set_threads


def cells_in_a_matrix(strain=0.08, traction=0.0, area_stiffness=300.0, bending=5.0):
    """Two cells in a Delaunay matrix whose border is pinned; activation as around a disk in a stream along x."""
    outlines = [disk(24, 1.0, 2.0, 2.0), disk(30, 1.2, 4.6, 2.2, 1.1, 0.4)]
    points, starts = stack(outlines)
    x, y = np.meshgrid(np.linspace(0, 7, 15), np.linspace(0, 4, 9))
    grid = np.column_stack((x.ravel(), y.ravel()))
    grid = grid[np.min(np.linalg.norm(grid[:, None] - points, axis=2), axis=1) > 0.25]
    inside = (np.linalg.norm(grid - (2, 2), axis=1) < 1) | (np.linalg.norm(grid - (4.6, 2.2), axis=1) < 1.05)
    grid = grid[~inside]
    everything = np.concatenate((points, grid))
    edges = np.concatenate([Delaunay(everything).simplices[:, [i, (i + 1) % 3]] for i in range(3)])
    springs = np.unique(np.sort(edges, axis=1), axis=0).astype(np.int32)
    pinned = (everything[:, 0] % 7 == 0) | (everything[:, 1] % 4 == 0)
    direction = np.concatenate([o - o.mean(axis=0) for o in outlines])
    activation = np.pi / 2 * np.abs(np.sin(np.arctan2(direction[:, 1], direction[:, 0]))) - 1
    return everything, Network(
        starts=starts,
        filaments=filaments(points, points, starts, activation, strain, 10.0, 3.5),
        membrane_rest=side_lengths(points, starts),
        membrane_ratio=1.0,
        springs=springs,
        spring_rest=np.linalg.norm(everything[springs[:, 1]] - everything[springs[:, 0]], axis=1),
        rest_areas=np.array(
            [np.pi * (n / (2 * np.pi)) * np.sin(2 * np.pi / n) * r**2 for n, r in ((24, 1.0), (30, 1.2))]
        ),
        area_stiffness=area_stiffness,
        bending=bending,
        loads=np.tile((traction, 0.0), (len(points), 1)),
        pinned=pinned,
    )


def many_cells(across, up, traction=0.0):
    """A block of cells in a matrix that `lay_matrix` makes, with activation along x and y in turns."""
    centres = [(3.0 * i + 2.0, 3.0 * j + 2.0) for i in range(across) for j in range(up)]
    domain = Domain.rectangle(3.0 * across + 1.0, 3.0 * up + 1.0, [disk(20, 1.0, *place) for place in centres])
    points, _ = stack(domain.pillars)
    direction = points - np.repeat(centres, 20, axis=0)
    turn = np.repeat(np.arange(len(centres)) % 2 * 0.5 * np.pi, 20)
    activation = np.pi / 2 * np.abs(np.sin(np.arctan2(direction[:, 1], direction[:, 0]) + turn)) - 1
    return in_a_matrix(domain, activation, traction)


def in_a_matrix(domain, activation, traction=0.0):
    """Cells of a domain in the matrix that `lay_matrix` makes."""
    matrix = lay_matrix(domain, 0.6)
    points, starts = stack(domain.pillars)
    return matrix.points, Network(
        starts=starts,
        filaments=filaments(points, points, starts, activation, 0.08, 10.0, 3.5),
        membrane_rest=side_lengths(points, starts),
        membrane_ratio=1.0,
        springs=matrix.springs,
        spring_rest=matrix.rest_lengths,
        rest_areas=domain.pillar_areas,
        area_stiffness=300.0,
        bending=10.0,
        loads=np.tile((traction, 0.0), (len(points), 1)),
        pinned=matrix.pinned,
    )


@pytest.fixture
def any_threads():
    before = get_threads()
    yield set_threads
    set_threads(before)


def test_a_grid_of_hats_gives_the_same_with_any_number_of_threads_and_as_its_twin(any_threads, monkeypatch):
    points, network = many_cells(9, 7, traction=0.01)
    monkeypatch.setattr("vasculo.pillars.relax.WORTH", 1)  # so few cells would have one thread
    results = []
    for threads in (1, 2):
        any_threads(threads)
        results.append(relax(points, network, 2e-3))
    plain = relax_plain(points, network, 2e-3)
    np.testing.assert_array_equal(results[0].points, results[1].points)
    np.testing.assert_allclose(results[0].points, plain.points, atol=1e-11)
    assert results[0].sweeps == plain.sweeps


def test_sweeps_hardly_grow_with_the_number_of_pillars():
    few, many = (relax(*many_cells(*size), 2e-3).sweeps for size in ((4, 4), (20, 20)))
    assert many < 1.6 * few


def test_the_equilibrium_does_not_depend_on_the_grid(monkeypatch):
    points, network = many_cells(9, 7)
    whole = relax(points, network, 1e-9)
    monkeypatch.setattr(coarse, "PILLARS_ACROSS", 100.0)
    alone = relax(points, network, 1e-9)
    assert whole.sweeps < alone.sweeps
    np.testing.assert_allclose(whole.points, alone.points, atol=1e-7)
    assert whole.residual < 1e-7


def test_a_chain_across_the_grid_stays_in_the_band_and_stable():
    pillars = [disk(20, 1.0, 3.0 * i + 2.0, 3.0 * j + 2.0) for i in range(14) for j in range(9) if j != 4]
    bar = np.array([(1.0, 13.0), (42.0, 13.0), (42.0, 15.0), (1.0, 15.0)])
    domain = Domain.rectangle(43.0, 28.0, [*pillars, resample(bar, 0.5)])
    points, network = in_a_matrix(domain, np.sin(stack(domain.pillars)[0][:, 0]))
    result = relax(points, network, 1e-8)
    assert result.converged
    assert np.abs(forces_plain(result.points, network)[~network.pinned]).max() < 1e-6


def test_kernel_matches_plain_twin():
    points, network = cells_in_a_matrix(traction=0.01)
    fast, plain = relax(points, network, 2e-3), relax_plain(points, network, 2e-3)
    assert fast.converged
    assert fast.sweeps == plain.sweeps
    np.testing.assert_allclose(fast.points, plain.points, atol=1e-12)
    assert fast.residual == pytest.approx(plain.residual, rel=1e-9)


def test_result_is_an_equilibrium():
    points, network = cells_in_a_matrix()
    loose, tight = relax(points, network, 2e-3), relax(points, network, 1e-9)
    assert tight.residual < 1e-8
    free = ~network.pinned
    assert np.abs(forces_plain(tight.points, network)[free]).max() < 1e-7
    move = np.abs(tight.points - points).max()
    assert move > 0.05
    assert np.abs(loose.points - tight.points).max() < 0.03 * move


def test_without_activation_nothing_moves():
    points, network = cells_in_a_matrix(strain=0.0, bending=0.0)
    relaxed = relax(points, replace(network, rest_areas=network.rest_areas), 2e-3)
    assert relaxed.converged
    assert np.abs(relaxed.points - points).max() < 1e-12


def test_pinned_nodes_stay_and_input_is_not_changed():
    points, network = cells_in_a_matrix(traction=0.05)
    before = points.copy()
    relaxed = relax(points, network, 2e-3)
    np.testing.assert_array_equal(points, before)
    np.testing.assert_array_equal(relaxed.points[network.pinned], points[network.pinned])
    assert (relaxed.points - points)[:54, 0].mean() > 0.01


def test_internal_forces_have_no_resultant():
    points, network = cells_in_a_matrix()
    moved = points + 0.02 * np.sin(7.0 * points[:, ::-1])
    force = forces_plain(moved, network)
    assert np.abs(force.sum(axis=0)).max() < 1e-11
    assert abs((moved[:, 0] * force[:, 1] - moved[:, 1] * force[:, 0]).sum()) < 1e-10


def energy(points, network):
    n = len(network.loads)
    total = 0.0
    for k, (a, b) in enumerate(zip(network.starts, network.starts[1:], strict=False)):
        p = points[a:b]
        q = np.roll(p, -1, axis=0)
        area = 0.5 * np.sum(p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1])
        total += 0.5 * network.area_stiffness * (network.rest_areas[k] - area) ** 2 / network.rest_areas[k]
        total += 0.5 * network.bending * np.sum((np.roll(p, 1, axis=0) - 2 * p + q) ** 2)
    assert n == network.starts[-1]
    return total


def test_pressure_and_bending_are_gradients_of_their_energies():
    points, network = cells_in_a_matrix()
    moved = points + 0.02 * np.sin(7.0 * points[:, ::-1])
    bare = replace(network, area_stiffness=0.0, bending=0.0)
    force = forces_plain(moved, network) - forces_plain(moved, bare)
    for node in (0, 11, 23, 24, 40, 53):
        for axis in (0, 1):
            step = np.zeros_like(points)
            step[node, axis] = 1e-5
            slope = (energy(moved + step, network) - energy(moved - step, network)) / 2e-5
            assert force[node, axis] == pytest.approx(-slope, rel=1e-6, abs=1e-6)


def test_contraction_along_y_stretches_along_x_at_constant_area():
    points, network = cells_in_a_matrix()
    relaxed = relax(points, network, 2e-3).points[:24]
    width, height = np.ptp(relaxed, axis=0)
    assert width > 2.05
    assert height < 1.95
    q = np.roll(relaxed, -1, axis=0)
    area = 0.5 * np.sum(relaxed[:, 0] * q[:, 1] - q[:, 0] * relaxed[:, 1])
    assert area == pytest.approx(network.rest_areas[0], rel=0.01)


def test_numbers_that_are_not_finite_stop_at_once():
    points, network = cells_in_a_matrix(traction=np.inf)
    relaxed = relax(points, network, 2e-3)
    assert not relaxed.converged
    assert relaxed.sweeps == 1
    assert not np.isfinite(relaxed.points).all()


def test_too_few_sweeps_are_not_called_converged():
    points, network = cells_in_a_matrix()
    assert not relax(points, network, 2e-3, max_sweeps=20).converged
