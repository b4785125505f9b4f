"""A picture becomes a study: its outlines are taken, and study, outlines and overlay are written."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.mesh.predict import predicted_triangles
from vasculo.mesh.size import GRADING, size_field
from vasculo.mesh.walls import walls_of
from vasculo.pillars.parameters import Angiogenesis
from vasculo.plexus.image import domain_from_image
from vasculo.plexus.image_levels import cropped
from vasculo.store.table import write_whole
from vasculo.study.outlines import outlines_text
from vasculo.study.picture_file import read_picture
from vasculo.study.picture_options import check_pixel_size
from vasculo.study.sections import FORMAT
from vasculo.study.settings import toml_value

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.plexus.image import ImageExtraction, Pictured


@dataclass(frozen=True)
class Written:
    """What became of a picture.

    Attributes
    ----------
    study, outlines : Path
        Files of the study.
    overlay : Path, optional
        The picture with the outlines over it; None when matplotlib is missing.
    rows : tuple of (str, str)
        What was found, and how much of it.
    notes : tuple of str
        What should be looked at.
    """

    study: Path
    outlines: Path
    overlay: Path | None
    rows: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


def study_of_picture(
    path: Path,
    parameters: ImageExtraction,
    out: Path | None = None,
    *,
    page: int = 1,
    pixel_size: float | None = None,
    replace: bool = False,
) -> Written:
    """Read a picture and write the study that remodels its network.

    Parameters
    ----------
    path : Path
        The picture.
    parameters : ImageExtraction
        How its outlines are taken.
    out : Path, optional
        Study file to write (its name ends in .toml), or the folder for it; the folder in which we are by default.
    page : int
        Page of a file with several, from 1 on.
    pixel_size : float, optional
        Size of a pixel, micrometres.
    replace : bool
        Write over files that are there.

    Returns
    -------
    Written

    Raises
    ------
    InputError
        When the picture cannot be used, the pixel size is not positive, or files are there already.
    """
    check_pixel_size(pixel_size)
    study = _target(path, out)
    outlines, overlay = study.with_suffix(".outlines.json"), study.with_suffix(".overlay.png")
    for file in (study, outlines, overlay):
        if file.exists() and not replace:
            raise InputError(f"{file} exists already: name another file with --out, or give --replace")
    picture, pages = read_picture(path, page)
    found = domain_from_image(picture, parameters)
    if not study.parent.is_dir():
        study.parent.mkdir(parents=True)
    write_whole(outlines, outlines_text(found.domain))
    write_whole(study, _study_text(path.name, page, outlines.name, parameters, found, pixel_size))
    drawn: Path | None = overlay
    notes = found.report.notes
    try:
        from vasculo.draw.overlay import draw_overlay  # noqa: PLC0415  # needs matplotlib
    except InputError as error:
        drawn, notes = None, (*notes, f"no overlay: {error}")
    else:
        draw_overlay(cropped(picture, parameters.crop), found, pixel_size, overlay)
    where = () if pages == 1 else (("page", f"{page} of {pages}"),)
    return Written(study, outlines, drawn, (*where, *_rows(found, pixel_size)), notes)


def flow_triangles(domain: Domain) -> float:
    """Predict the triangles of the flow mesh in the first step of the remodelling with its default parameters."""
    keys, unit = Angiogenesis(), domain.mean_radius
    walls = walls_of(domain)
    field = size_field(walls, keys.flow_spacing * unit, keys.membrane_spacing * unit, keys.flow_across, GRADING)
    return predicted_triangles(walls, field, domain.area)[0]


def _target(path: Path, out: Path | None) -> Path:
    """Study file to write."""
    if out is None:
        return Path(f"{path.stem}.toml")
    if out.suffix == ".toml":
        return out
    if out.is_file() or (out.suffix and not out.is_dir()):
        raise InputError(f"{out} is no name of a study: it ends in .toml, or is a folder")
    return out / f"{path.stem}.toml"


def _study_text(
    picture: str,
    page: int,
    outlines: str,
    parameters: ImageExtraction,
    found: Pictured,
    pixel_size: float | None,
) -> str:
    """Write the study, with how its outlines were taken as a comment."""
    taken = {name: value for name, value in asdict(parameters).items() if value is not None}
    lines = [
        f"# Outlines of {picture}, page {page}; a model length is a pixel, the flow runs along x. Taken with:",
        *(f"# {name} = {value}" for name, value in taken.items()),
        "",
        "[study]",
        f"format = {FORMAT}",
        f"title = {toml_value(f'The network of {picture}')}",
        "",
        "[domain]",
        'kind = "outlines"',
        f"file = {toml_value(outlines)}",
    ]
    if "wall" in found.domain.sides:  # tissue, at which the blood sticks
        lines += ["", "[angiogenesis]", 'walls = "no-slip"']
    if pixel_size is not None:
        lines += ["", "[units]", f"length = {pixel_size!r}  # micrometres in a pixel"]
    return "\n".join(lines) + "\n"


def _rows(found: Pictured, pixel_size: float | None) -> tuple[tuple[str, str], ...]:
    """Lines of the table."""
    report = found.report

    def length(value: float) -> str:
        micrometres = "" if pixel_size is None else f" ({value * pixel_size:.3g} um)"
        return f"{value:.3g} px{micrometres}"

    size = f"{report.width} x {report.height} px"
    if pixel_size is not None:
        size += f" ({report.width * pixel_size:.4g} x {report.height * pixel_size:.4g} um)"
    dropped = f"{report.small} small, {report.vanished} lost when passages were widened"
    narrowest = "none between pillars" if np.isinf(report.narrowest_gap) else length(report.narrowest_gap)
    return (
        ("picture", size),
        ("threshold", "local mean" if np.isnan(report.threshold) else f"{report.threshold:.4g}"),
        ("vessel fraction", f"{report.vessel_fraction:.3f}"),
        ("vessel parts left out", f"{report.lost_parts}, {report.lost_area} px2"),
        ("islands", str(report.islands)),
        ("dropped", dropped),
        ("wall", str(report.walls)),
        ("pillars", f"{report.pillars}, {report.cut} of them cut by the picture's border"),
        ("mean radius", length(report.mean_radius)),
        ("fluid fraction", f"{report.fluid_fraction:.3f}"),
        ("narrowest passage", f"{narrowest}; {report.widened} widened to {length(report.narrowest)}"),
        ("predicted triangles", f"{flow_triangles(found.domain):.2g}"),
    )
