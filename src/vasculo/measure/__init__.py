"""Numbers that biologists quote, each defined in its docstring."""

from vasculo.measure.cords import Cords, cords
from vasculo.measure.hydraulics import (
    alignment,
    mean_wall_shear,
    permeability,
    permeability_tensor,
    pillar_drag,
    shear_ratio,
)
from vasculo.measure.junctions import Junctions
from vasculo.measure.network import NetworkFlow, poiseuille_network
from vasculo.measure.passages import Passages, passages
from vasculo.measure.plexus import PlexusNumbers, plexus
from vasculo.measure.shape import Chains, PillarTable, chains, mean_gap, order, pillars
from vasculo.measure.tubules import TubuleFlow, tubule_flow

__all__ = [
    "Chains",
    "Cords",
    "Junctions",
    "NetworkFlow",
    "Passages",
    "PillarTable",
    "PlexusNumbers",
    "TubuleFlow",
    "alignment",
    "chains",
    "cords",
    "mean_gap",
    "mean_wall_shear",
    "order",
    "passages",
    "permeability",
    "permeability_tensor",
    "pillar_drag",
    "pillars",
    "plexus",
    "poiseuille_network",
    "shear_ratio",
    "tubule_flow",
]
