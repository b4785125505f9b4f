"""Draw the gallery of degenerate cases: each hand-made network, and the pillars that come out of the extraction.

Run with `python benchmarks/degenerate_gallery.py [folder]`; writes degenerate_springs.png and degenerate_voids.png, by
default beside the other pictures of the documentation.
"""

from __future__ import annotations

import sys
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from degenerate_cases import COLUMNS, ROWS, SPRINGS, VOIDS, lattice_of_squares
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR, PILLAR_EDGE, new_figure, save
from vasculo.errors import InputError
from vasculo.plexus.extract import extract
from vasculo.plexus.parameters import Extraction

if TYPE_CHECKING:
    from degenerate_cases import Case
    from matplotlib.axes import Axes

FOLDER = Path(__file__).parents[1] / "docs" / "images"
ACROSS, LETTERS = 3, 43
TORN = "#8d95a1"
WIDTH, MARGIN, ABOVE, BELOW = 2.5, 0.09, 0.24, 0.40  # of a panel; its margins at the sides, above and below, in inches


def draw(axes: Axes, case: Case, letter: str) -> None:
    """Draw one case: torn springs dashed, living ones solid, moved nodes as dots, pillars filled, the rule below."""
    network = case.network()
    _, _, edges = lattice_of_squares()
    living = {tuple(spring) for spring in network.springs.tolist()}
    torn = np.array([edge for edge in edges.tolist() if tuple(edge) not in living], dtype=int).reshape(-1, 2)
    try:
        pillars = extract(network, Extraction(lumen_width=0.75)).domain.pillars
    except InputError:
        pillars = []
    for pillar in pillars:
        axes.add_patch(Polygon(pillar, facecolor=PILLAR, edgecolor="none", alpha=0.75, zorder=1))
        axes.add_patch(Polygon(pillar, fill=False, edgecolor=PILLAR_EDGE, linewidth=1.3, zorder=4))
        axes.plot(*pillar.T, "o", color=PILLAR_EDGE, markersize=2.4, zorder=4)
    dashed = LineCollection(
        list(network.points[torn]), colors=TORN, linewidths=0.5, linestyles=(0, (2.5, 2.0)), zorder=2
    )
    axes.add_collection(dashed)
    axes.add_collection(LineCollection(list(network.points[network.springs]), colors=INK, linewidths=0.8, zorder=3))
    if case.moved:
        x, y = np.array(list(case.moved.values())).T
        axes.plot(x, y, "o", color=ACCENT, markersize=3.6, zorder=5)
    axes.set_xlim(-0.15, COLUMNS + 0.15)
    axes.set_ylim(-0.15, ROWS + 0.15)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title(f"{letter}   {case.name}", fontsize=8, color=INK, loc="left", pad=3, fontweight="bold")
    axes.text(-0.1, -0.4, fill(case.rule, LETTERS), fontsize=7, color=MUTED, va="top", linespacing=1.25)


def main() -> None:
    """Draw both pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    number = 0
    for name, cases in (("springs", SPRINGS), ("voids", VOIDS)):
        rows = -(-len(cases) // ACROSS)
        wide = WIDTH - 2.0 * MARGIN
        high = wide * (ROWS + 0.3) / (COLUMNS + 0.3)
        size = ACROSS * WIDTH, rows * (ABOVE + high + BELOW)
        figure = new_figure(*size)
        figure.set_layout_engine("none")
        for index, case in enumerate(cases):
            row, column = divmod(index, ACROSS)
            left, bottom = column * WIDTH + MARGIN, (rows - 1 - row) * (ABOVE + high + BELOW) + BELOW
            axes = figure.add_axes((left / size[0], bottom / size[1], wide / size[0], high / size[1]))
            draw(axes, case, chr(ord("a") + number))
            number += 1
        print(save(figure, folder / f"degenerate_{name}.png"))


if __name__ == "__main__":
    main()
