"""One call draws whatever it is given."""

from io import BytesIO

import numpy as np
import pytest
from imageio.v3 import imread

from vasculo.draw.canvas import new_figure
from vasculo.draw.show import show
from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.tissue.lattice import lattice


@pytest.fixture(scope="module")
def domain():
    block = np.array([[0.6, 0.3], [1.0, 0.3], [1.0, 0.7], [0.6, 0.7]])
    return Domain.rectangle(2.0, 1.0, [block, block + np.array([0.6, 0.0])])


@pytest.fixture(scope="module")
def mesh(domain):
    return generate_mesh(domain, edge_length=0.1)


def pixels(figure):
    data = BytesIO()
    figure.savefig(data, format="png")
    return imread(data.getvalue())[..., :3]


@pytest.mark.parametrize("kind", ["domain", "mesh", "flow"])
def test_pillars_are_where_they_belong(domain, mesh, kind):
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)})
    picture = pixels(show({"domain": domain, "mesh": mesh, "flow": flow}[kind])).astype(int)
    high, wide, _ = picture.shape
    assert wide == 640
    assert wide / high == pytest.approx(2.0, rel=0.02)
    for x, y in ((0.8, 0.5), (1.4, 0.5)):
        assert np.abs(picture[int((1 - y) * high), int(x / 2 * wide)] - (240, 201, 180)).max() <= 2
    aside = picture[int(0.1 * high) : int(0.2 * high), int(0.1 * wide) : int(0.2 * wide)].reshape(-1, 3)
    assert (np.abs(aside - (240, 201, 180)).max(axis=1) > 10).mean() > 0.9


def test_a_network_at_rest_is_seen():
    tissue = lattice(nodes=300, seed=1)
    picture = pixels(show(tissue, 2.0))
    assert 0.02 < (picture < 200).all(axis=2).mean() < 0.6
    assert pixels(show(tissue, 2.0, 1.0)).shape[:2] == (200, 400)


def test_a_run_shows_its_last_step(disk_run, tissue_run):
    flow = disk_run.flow()
    np.testing.assert_array_equal(pixels(show(disk_run)), pixels(show(flow)))
    springs = tissue_run.network()
    assert pixels(show(springs)).std() > 30
    figure = new_figure(4.0, 2.0)
    left, right = figure.subplots(1, 2)
    assert show(tissue_run, axes=left) is figure
    assert show(tissue_run.domain(), axes=right) is figure
    assert left.get_xlim() == pytest.approx(right.get_xlim())


def test_what_cannot_be_shown_is_said():
    with pytest.raises(InputError, match="dict cannot be shown: it must be a Domain, Triangulation, Flow"):
        show({})
