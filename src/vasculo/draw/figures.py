"""The figures of a run that answer those of the paper, by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vasculo.draw.canvas import WIDTH, save
from vasculo.draw.chains import draw_lineage
from vasculo.draw.curves import draw_curves
from vasculo.draw.frames import draw_frames
from vasculo.draw.growth import draw_extraction, draw_mesh_stages, draw_plexus
from vasculo.draw.rose import draw_mergers
from vasculo.draw.shares import draw_shares
from vasculo.draw.single import picture
from vasculo.draw.start_end import draw_flow, draw_wall_shear
from vasculo.store.read import FIGURES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from vasculo.store.read import Run


@dataclass(frozen=True)
class Picture:
    """A figure of a run.

    Attributes
    ----------
    name : str
        Stem of its file.
    title : str
        Headline in the report.
    caption : str
        What it shows.
    draw : callable
        Makes it from the run, and if given from a width in inches.
    """

    name: str
    title: str
    caption: str
    draw: Callable[..., Figure]


def pictures(run: Run) -> list[Picture]:
    """List the figures that a run has data for, in the order of the paper."""
    found: list[Picture] = []
    remodelled = run.steps("angiogenesis")
    if run.steps("vasculogenesis"):
        found += [_MESH, _PLEXUS]
        if remodelled:
            found.append(_EXTRACTION)
    if remodelled:
        alone = len(run.pillars(remodelled[0]).outlines) == 1
        hanging = run.settings.get("angiogenesis", {}).get("cells") == "hanging"
        found += [_FLOW, _HANGING if hanging else _DISK if alone else _CHAINS]
        if not alone:
            found.append(_CORRIDORS)
        if any(event.kind == "merge" for event in run.events):
            found += [_LINEAGE, _MERGERS]
        found += [_SHEAR, _SHARES]
    if run.steps("vasculogenesis"):
        found.append(_GROWTH)
    if remodelled:
        found.append(_CURVES)
    return found


def draw_all(
    run: Run,
    tell: Callable[[float, float, str], object] | None = None,
    *,
    width: float = WIDTH,
    dpi: int | None = None,
    formats: Sequence[str] = ("png",),
) -> list[Path]:
    """Draw every figure of a run into its folder `figures`; return the files.

    Parameters
    ----------
    run : Run
        An opened run.
    tell : callable, optional
        Called before each figure with the number done, the number in all and its title.
    width : float
        Width of each figure, inches.
    dpi : int, optional
        Dots per inch; by default those that suit the figure.
    formats : sequence of {"png", "svg", "pdf"}
        Kinds of files.
    """
    files = []
    wanted = pictures(run)
    for number, wanted_one in enumerate(wanted):
        if tell is not None:
            tell(number, len(wanted), wanted_one.title)
        figure = wanted_one.draw(run, width)
        files += [save(figure, run.folder / FIGURES / f"{wanted_one.name}.{kind}", dpi) for kind in formats]
    return files


_MESH = Picture(
    "fig1-springs",
    "The mesh tears (Fig 1)",
    "Three stages of the traction-driven remodelling, whole and a fragment of each. Width and grey of a spring "
    "follow its force, clipped at the 98th percentile.",
    draw_mesh_stages,
)
_PLEXUS = Picture(
    "fig2-plexus",
    "The plexus (Fig 2)",
    "The tissue after vasculogenesis: cords of stretched fibres around voids, in which the pillars will stand.",
    draw_plexus,
)
_EXTRACTION = Picture(
    "extraction",
    "From voids to pillars",
    "Outlines of the pillars (filled) in the voids of the spring mesh; the cords between them become tubules.",
    draw_extraction,
)
_FLOW = Picture(
    "fig3-flow",
    "Flow and mesh (Fig 3)",
    "Left: speed with linear interpolation between the nodes, before any remodelling. Right: the mesh it was computed "
    "on.",
    draw_flow,
)
_DISK = Picture(
    "fig4-disk",
    "A disk in the flow (Fig 4)",
    "Deformation of the disk by its shear-activated interior, one scale of speed for all panels. As much flow passes "
    "between each two white lines.",
    draw_frames,
)
_CHAINS = Picture(
    "fig5-chains",
    "Pillars over the iterations (Fig 5)",
    "Pillars and speed at different iterations, one scale of speed for all panels: dark where the blood rests, bright "
    "where it is fast.",
    draw_frames,
)
_HANGING = Picture(
    "hanging",
    "The control: pillars without interior",
    "Pillars that hang freely in the matrix, moved by the wall traction alone: they shift, but "
    "neither align nor merge.",
    draw_frames,
)
_CORRIDORS = Picture(
    "corridors",
    "The lanes that carry the flow",
    "The last step on a linear scale of speed. As much flow passes between each two white lines, so they crowd in the "
    "corridors. Pillars are filled by the number of original pillars that merged into them.",
    lambda run, width=WIDTH: picture(run, "chains", width=width),
)
_LINEAGE = Picture(
    "lineage",
    "Which pillars became which chain",
    "The first and the last step; the largest chains and the pillars they came from have one colour and letter each.",
    draw_lineage,
)
_MERGERS = Picture(
    "mergers",
    "Mergers",
    "Directions between the centroids of pillars that merged (left; a direction has no sense, so the rose is "
    "symmetric), and when they did (right).",
    draw_mergers,
)
_SHARES = Picture(
    "shear-shares",
    "How the shear is spread",
    "Share of the membrane length by its wall shear over the mean of all membranes (left), and by its activation, "
    "which compares the shear with the mean of the own pillar (right), at the start (line) and at the end (filled). "
    "Spread: the standard deviation over the length.",
    draw_shares,
)
_SHEAR = Picture(
    "wall-shear",
    "Wall shear on the pillars",
    "What the pillars feel, at the start and at the end, on one scale: darker and wider where it is larger.",
    draw_wall_shear,
)
_GROWTH = Picture(
    "curves-vasculogenesis",
    "Vasculogenesis in numbers",
    "Living springs, share of the tissue in voids, and number of voids over the model time.",
    lambda run, width=WIDTH: draw_curves(run, "vasculogenesis", width),
)
_CURVES = Picture(
    "curves-angiogenesis",
    "Angiogenesis in numbers",
    "Pillars, alignment, shape and flow over the geometry steps.",
    lambda run, width=WIDTH: draw_curves(run, "angiogenesis", width),
)
