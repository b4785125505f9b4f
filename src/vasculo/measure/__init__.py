"""Numbers that biologists quote, each defined in its docstring."""

from vasculo.measure.cords import Cords, cords
from vasculo.measure.hydraulics import alignment, mean_wall_shear, permeability, pillar_drag, shear_ratio
from vasculo.measure.passages import Passages, passages
from vasculo.measure.plexus import PlexusNumbers, plexus
from vasculo.measure.shape import Chains, PillarTable, chains, mean_gap, order, pillars

__all__ = [
    "Chains",
    "Cords",
    "Passages",
    "PillarTable",
    "PlexusNumbers",
    "alignment",
    "chains",
    "cords",
    "mean_gap",
    "mean_wall_shear",
    "order",
    "passages",
    "permeability",
    "pillar_drag",
    "pillars",
    "plexus",
    "shear_ratio",
]
