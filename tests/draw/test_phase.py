"""Phase diagrams from arrays: what stands in which cell, on which scale, with which words."""

import numpy as np
import pytest

from vasculo.draw.canvas import png
from vasculo.draw.end_states import EndState, draw_end_states
from vasculo.draw.phase import Axis, Field, draw_cells, draw_curves_over, draw_points, is_grid, levels

X = Axis("damping", np.array([1.0, 1.0, 5.0, 5.0, 25.0, 25.0]))
Y = Axis("law", np.array(["shear", "none"] * 3))
FIELD = Field("order", np.array([0.0, 0.2, 0.4, 0.6, np.nan, 1.0]), np.array([0.1, np.nan, 0.1, 0.1, np.nan, 0.1]))


def texts(axes):
    return [text.get_text() for text in axes.texts]


def test_each_cell_has_its_mean_and_spread():
    figure = draw_cells(X, Y, [FIELD])
    axes = figure.axes[0]
    assert axes.images[0].get_array().filled(np.nan).tolist()[1][:2] == [0.2, 0.6]
    np.testing.assert_array_equal(axes.images[0].get_array().mask, [[False, False, True], [False, False, False]])
    assert texts(axes) == ["0\n± 0.1", "0.4\n± 0.1", "none", "0.2", "0.6\n± 0.1", "1\n± 0.1"]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["1", "5", "25"]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["shear", "none"]
    assert axes.images[0].get_clim() == (0.0, 1.0)
    assert len(png(figure)) > 5_000


def test_cells_are_legible_on_their_colour():
    figure = draw_cells(X, Y, [FIELD])
    axes, image = figure.axes[0], figure.axes[0].images[0]
    for text in axes.texts:
        if text.get_text() != "none":
            column, row = (round(value) for value in text.get_position())
            red, green, blue, _ = image.cmap(image.norm(image.get_array()[row, column]))
            light = 0.2126 * red**2.2 + 0.7152 * green**2.2 + 0.0722 * blue**2.2
            ink = 1.0 if text.get_color() == "white" else 0.018
            high, low = max(light, ink), min(light, ink)
            assert (high + 0.05) / (low + 0.05) > 4.0, text.get_text()


def test_a_third_setting_has_a_panel_a_value_on_one_scale():
    third = Axis("steps, none", np.array([1, 1, 1, 2, 2, 2]))
    figure = draw_cells(X, Y, [FIELD], third)
    panels = [axes for axes in figure.axes if axes.images]
    assert [axes.get_title(loc="left") for axes in panels] == ["steps 1", "steps 2"]
    assert {axes.images[0].get_clim() for axes in panels} == {(0.0, 1.0)}


def test_numbers_that_are_all_nearly_the_same_look_the_same():
    field = Field("order", np.array([1.0, 1.0 + 1e-7, 1.0]), np.full(3, np.nan))
    low, high = field.ends
    assert high - low == pytest.approx(0.01)
    assert Field("none", np.full(3, np.nan), np.full(3, np.nan)).ends == (0.0, 1.0)
    assert Field("zero", np.zeros(3), np.zeros(3)).ends == (-0.5, 0.5)


def test_a_field_through_points_is_linear_between_them():
    rng = np.random.default_rng(1)
    x, y = Axis("x", rng.uniform(0.0, 1.0, 40)), Axis("y", 10.0 ** rng.uniform(0.0, 2.0, 40), log=True)
    field = Field("z", x.values + np.log10(y.values), np.full(40, np.nan))
    figure = draw_points(x, y, [field])
    axes = figure.axes[0]
    assert axes.get_yscale() == "log"
    assert len(axes.collections) >= 2
    np.testing.assert_allclose(axes.collections[-2].get_offsets(), np.stack([x.values, y.values], axis=1))
    assert len(png(figure)) > 5_000


def test_points_on_a_line_have_no_field():
    x = Axis("x", np.arange(1.0, 6.0))
    figure = draw_points(x, x, [Field("z", x.values, np.full(5, np.nan))])
    assert len(figure.axes[0].collections) == 2  # the points, and none without a run
    png(figure)


@pytest.mark.parametrize("values", [np.array([4.0, 1.0, 2.0]), np.array(["b", "a", "c"])])
def test_a_curve_with_its_runs(values):
    x = Axis("x", values)
    runs = Axis("x", np.repeat(values, 2))
    dots = np.array([1.0, 3.0, 2.0, 4.0, 0.0, 2.0])
    field = Field("order", np.array([2.0, 3.0, 1.0]), np.full(3, 2.0**0.5))
    figure = draw_curves_over(x, [field], runs, [dots])
    axes = figure.axes[0]
    line = axes.lines[0]
    if values.dtype.kind == "f":
        assert line.get_xdata().tolist() == [1.0, 2.0, 4.0]
        assert line.get_ydata().tolist() == [3.0, 1.0, 2.0]
    else:
        assert [label.get_text() for label in axes.get_xticklabels()] == ["b", "a", "c"]
    assert len(axes.collections[0].get_offsets()) == 6


def test_levels_and_grids():
    assert levels(np.array([3.0, 1.0, 3.0])) == [1.0, 3.0]
    assert levels(np.array(["b", "a", "b"])) == ["b", "a"]
    assert is_grid(X, Y)
    assert not is_grid(Axis("x", np.arange(9.0)), Axis("y", np.arange(9.0)))


def test_ends_of_runs_lie_on_the_grid_of_the_settings():
    square = np.array([[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]])
    state = EndState("1: 5", (0.0, 0.0, 1.0, 1.0), pillars=[square])
    figure = draw_end_states(
        [state, None, state, None], Axis("x", np.array([1, 1, 2, 2])), Axis("y", np.array([1, 2, 1, 2]))
    )
    grid = np.array(figure.axes).reshape(2, 2)  # the first row is the upper one
    assert [[len(axes.collections) for axes in row] for row in grid] == [[0, 0], [1, 1]]
    assert texts(grid[0, 0]) == ["no complete run"]
    assert len(png(draw_end_states([state] * 7))) > 5_000
