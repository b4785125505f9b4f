"""The picture of the passages: lines where the passages are, as wide as the flow, coloured by the error."""

from dataclasses import replace

import numpy as np
import pytest
from imageio.v3 import imread

from vasculo.draw.canvas import new_figure, save
from vasculo.draw.network import CLIP, THINNEST, WIDEST, draw_network, middle_lines, network_figure, relative_error
from vasculo.flow.boundary import Pressure
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.measure.network import poiseuille_network
from vasculo.measure.tubules import tubule_flow
from vasculo.mesh.generate import generate_mesh


@pytest.fixture(scope="module")
def channels():
    """Two channels beside a plate that stands off the middle."""
    plate = np.array([(2, 0.8), (8, 0.8), (8, 1.2), (2, 1.2)], dtype=float)
    domain = Domain.rectangle(10.0, 3.0, [plate])
    flow = solve_stokes(generate_mesh(domain, 0.3), {"left": Pressure(1.0), "right": Pressure(0.0)})
    return domain, tubule_flow(domain, flow), poiseuille_network(domain)


def test_lines_run_along_the_middles(channels):
    _, resolved, _ = channels
    pieces, row = middle_lines(resolved)
    for number in np.flatnonzero(resolved.between_walls):
        low, high = sorted(resolved.facing[number][:, 1])
        ends = pieces[row == number]
        along = (ends[..., 0] > 3.0) & (ends[..., 0] < 7.0)
        assert along.any()
        np.testing.assert_allclose(ends[along][:, 1], 0.5 * (low + high), atol=1e-9)


def test_widths_follow_the_flow_and_colours_the_error(channels):
    domain, resolved, network = channels
    figure = new_figure(4.0, 2.0)
    lines = draw_network(figure.subplots(), domain.pillars, resolved, network, domain.bounds)
    _, row = middle_lines(resolved)
    widths = np.asarray(lines.get_linewidths())
    strongest = np.nanargmax(np.abs(resolved.flux))
    assert widths.max() == pytest.approx(WIDEST)
    np.testing.assert_allclose(widths[row == strongest], WIDEST)
    assert widths.min() >= THINNEST
    np.testing.assert_array_equal(lines.get_array().filled(np.nan), relative_error(network, resolved)[row])
    assert lines.get_clim() == (-CLIP, CLIP)
    none = relative_error(resolved, replace(resolved, flux=np.zeros_like(resolved.flux)))
    assert np.isnan(none).all()


def test_the_figure(channels, tmp_path):
    domain, resolved, network = channels
    figure = network_figure(domain, resolved, network, "here")
    assert figure.axes[0].get_title(loc="left").startswith("here · 2 passages · mean error ")
    picture = imread(save(figure, tmp_path / "network.png"))
    assert len(np.unique(picture.reshape(-1, picture.shape[2]), axis=0)) > 50
