"""Pictures: the right figures for a run, drawn from its record, the same bytes every time."""

import numpy as np
import pytest

from vasculo.draw.canvas import fragment, new_figure, png
from vasculo.draw.figures import draw_all, pictures
from vasculo.draw.flow import draw_speed, fastest_point, mesh_box, node_speed, speed_scale
from vasculo.draw.frames import iterations
from vasculo.draw.growth import growth_stages
from vasculo.draw.pillars import draw_shear, shear_scale
from vasculo.draw.single import draw_one
from vasculo.draw.springs import GREYS, REST, WIDTHS, draw_springs, force_scale, look, zoom
from vasculo.errors import InputError
from vasculo.store.read import Springs

PNG = b"\x89PNG\r\n"


def springs(forces):
    count = len(forces)
    points = np.array([[i / count, j] for i in range(count) for j in (0.2, 0.8)])
    pairs = np.arange(2 * count, dtype=np.int32).reshape(-1, 2)
    return Springs(points, np.zeros_like(points), pairs, np.asarray(forces, dtype=float))


def test_springs_are_wide_and_dark_by_force_and_the_weak_are_drawn_first():
    axes = new_figure(2, 2).subplots()
    forces = np.array([3.0, -1.0, 1.0, 2.0])
    draw_springs(axes, springs(forces), (-0.1, 0.0, 1.1, 1.0))
    lines = axes.collections[0]
    widths, greys = np.array(lines.get_linewidths()), lines.get_colors()[:, 0]
    assert (np.diff(widths) > 0).all()
    assert (np.diff(greys) < 0).all()
    assert widths[0] == WIDTHS[0]
    assert widths[-1] == WIDTHS[1]
    assert greys[0] == pytest.approx(GREYS[0])
    assert greys[-1] == pytest.approx(GREYS[1])
    order = [round(segment[0][0] * 4) for segment in lines.get_segments()]
    assert order == [1, 2, 3, 0]
    assert axes.get_xlim() == (-0.1, 1.1)


def test_the_scale_is_the_98th_percentile_of_the_tensions():
    forces = np.linspace(-50.0, 100.0, 1001)
    assert force_scale(springs(forces)) == pytest.approx(np.percentile(np.maximum(forces, 0), 98))
    assert force_scale(springs([])) == 0.0


def test_springs_without_force_are_grey_and_one_scale_can_be_given():
    axes = new_figure(2, 2).subplots()
    draw_springs(axes, springs(np.zeros(3)), (0.0, 0.0, 1.0, 1.0))
    draw_springs(axes, springs(np.full(3, 2.0)), (0.0, 0.0, 1.0, 1.0), scale=8.0)
    rest, pulled = (lines.get_colors()[:, 0] for lines in axes.collections)
    np.testing.assert_allclose(rest, look(REST)[1])
    np.testing.assert_allclose(pulled, look(0.25)[1])


def test_springs_at_rest_and_outside_can_be_drawn():
    axes = new_figure(2, 2).subplots()
    draw_springs(axes, springs(np.zeros(3)), (0.0, 0.0, 1.0, 1.0))
    draw_springs(axes, springs(np.zeros(3)), (5.0, 5.0, 6.0, 6.0))
    assert len(axes.collections[1].get_segments()) == 0
    assert zoom(35_000) == 1.0
    assert zoom(2_000) > 1.5


def test_a_fragment_stays_inside():
    assert fragment((0.0, 0.0, 3.0, 1.0), (2.9, 0.5), 0.5) == pytest.approx((2.5, 0.25, 3.0, 0.75))
    assert fragment((0.0, 0.0, 3.0, 1.0), (1.5, 0.0), 1.0) == pytest.approx((1.0, 0.0, 2.0, 1.0))


def test_speed_is_interpolated_between_the_nodes(disk_run):
    flow = disk_run.flow()
    axes = new_figure(3, 2).subplots()
    colours = draw_speed(axes, flow, disk_run.pillars().outlines, mesh_box(flow.mesh))
    np.testing.assert_array_equal(colours.get_array(), node_speed(flow))
    assert colours.norm.vmax == speed_scale(flow)
    x, y = fastest_point(flow)
    box = mesh_box(flow.mesh)
    assert box[0] <= x <= box[2]
    assert box[1] <= y <= box[3]


def test_the_shear_on_the_outline_is_what_the_record_holds(disk_run):
    flow = disk_run.flow()
    axes = new_figure(3, 2).subplots()
    lines = draw_shear(axes, flow, disk_run.pillars().outlines, mesh_box(flow.mesh))
    np.testing.assert_array_equal(lines.get_array(), np.abs(flow.wall_shear[flow.wall_pillar >= 0]))
    row = disk_run.frame("angiogenesis").index
    assert shear_scale(flow) == pytest.approx(2 * disk_run.metrics["mean_wall_shear"][row])


def test_figures_answer_the_paper(disk_run, tissue_run):
    assert [p.name for p in pictures(disk_run)] == [
        "fig3-flow",
        "fig4-disk",
        "wall-shear",
        "shear-shares",
        "curves-angiogenesis",
    ]
    assert [p.name for p in pictures(tissue_run)] == [
        "fig1-springs",
        "fig2-plexus",
        "extraction",
        "fig3-flow",
        "fig5-chains",
        "corridors",
        "wall-shear",
        "shear-shares",
        "curves-vasculogenesis",
        "curves-angiogenesis",
    ]


def test_stages_and_iterations(tissue_run, disk_run):
    early, torn, last = growth_stages(tissue_run)
    assert early < torn < last
    assert last == tissue_run.steps("vasculogenesis")[-1]
    assert len(tissue_run.network(torn).springs) == len(tissue_run.network(last).springs)
    assert len(tissue_run.network(early).springs) > len(tissue_run.network(torn).springs)
    assert iterations(disk_run) == [0, 1, 2]
    assert iterations(disk_run, 2) == [0, 2]


def test_all_figures_of_a_run(tissue_run):
    told = []
    files = draw_all(tissue_run, lambda *words: told.append(words))
    assert [file.stem for file in files] == [p.name for p in pictures(tissue_run)]
    assert all(file.read_bytes().startswith(PNG) for file in files)
    assert [done for done, _, _ in told] == list(range(len(files)))


def test_the_same_figure_gives_the_same_bytes(disk_run):
    draw = pictures(disk_run)[0].draw
    assert png(draw(disk_run)) == png(draw(disk_run))


@pytest.mark.parametrize("what", ["mesh", "flow", "pressure", "shear", "pillars", "chains"])
def test_one_picture_of_one_step(disk_run, what):
    (file,) = draw_one(disk_run, what, 1)
    assert file == disk_run.folder / "figures" / f"{what}-0001.png"
    assert file.read_bytes().startswith(PNG)
    assert draw_one(disk_run, what)[0].name == f"{what}-0002.png"


def test_springs_of_one_step(tissue_run):
    step = tissue_run.steps("vasculogenesis")[1]
    assert draw_one(tissue_run, "springs", step)[0].name == f"springs-{step:04d}.png"


def test_what_is_not_there_cannot_be_drawn(disk_run):
    with pytest.raises(InputError, match="no recorded step of vasculogenesis"):
        draw_one(disk_run, "springs")
    with pytest.raises(InputError, match="'colour' cannot be drawn: choose springs, mesh, flow"):
        draw_one(disk_run, "colour")
    with pytest.raises(InputError, match="no record of angiogenesis step 9, the nearest is 2"):
        draw_one(disk_run, "flow", 9)
