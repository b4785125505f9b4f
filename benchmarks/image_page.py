"""Pictures of docs/images-in.md: the examples, their outlines and their flow meshes; and the numbers of its table."""

from __future__ import annotations

import argparse
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from vasculo.draw.canvas import fragment, new_figure, save
from vasculo.draw.flow import draw_mesh, mesh_box
from vasculo.draw.overlay import draw_overlay
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.parameters import Angiogenesis
from vasculo.plexus.image import ImageExtraction, Pictured, domain_from_image
from vasculo.study.picture import flow_triangles
from vasculo.study.picture_file import read_picture

if TYPE_CHECKING:
    from vasculo.mesh.triangulation import Triangulation

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "examples" / "images"
CASES = {
    "capillaries": ("capillaries.png", ImageExtraction(vessels="dark")),
    "bifurcation_open": ("bifurcation.tif", ImageExtraction(vessels="dark", inlet="top")),
    "bifurcation_closed": ("bifurcation.tif", ImageExtraction(vessels="dark", inlet="top", border="closed")),
}


def flow_mesh(found: Pictured, across: int) -> Triangulation:
    """Mesh of the first step of the remodelling, with so many triangles across every passage."""
    keys, unit = Angiogenesis(), found.domain.mean_radius
    return generate_mesh(found.domain, keys.flow_spacing * unit, keys.membrane_spacing * unit, across=across)


def main() -> None:
    """Extract, mesh, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    out = parser.parse_args().out
    meshes: dict[str, tuple[Triangulation, Pictured]] = {}
    for name, (file, wanted) in CASES.items():
        picture = read_picture(IMAGES / file)[0]
        domain_from_image(picture, wanted)
        clock = perf_counter()
        found = domain_from_image(picture, wanted)
        seconds = perf_counter() - clock
        draw_overlay(picture, found, None, out / f"image_{name}.png")
        print(name, found.report)
        for across in (2, 3):
            mesh = flow_mesh(found, across)
            print(f"  {across} across: {len(mesh.triangles)} triangles, lowest quality {mesh.quality().min():.2f}")
        print(f"  predicted for 2 across: {flow_triangles(found.domain):.0f}; {seconds:.2f} s for the outlines")
        meshes[name] = mesh, found
    figure = new_figure(11.0, 3.9, resolution=110)
    for axes, (name, (mesh, found)) in zip(figure.subplots(1, 3), meshes.items(), strict=True):
        box = mesh_box(mesh)
        shown = fragment(box, (0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])), 0.4) if name == "capillaries" else box
        draw_mesh(axes, mesh, found.domain.pillars, shown, f"{name.replace('_', ', border ')} · {len(mesh.triangles)}")
    save(figure, out / "image_mesh.png")


if __name__ == "__main__":
    main()
