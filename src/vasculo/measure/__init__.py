"""Numbers that biologists quote, each defined in its docstring."""

from vasculo.measure.alignment import AngleSummary, LocalAngles, alignment, local_angles
from vasculo.measure.chains import Chains, chains
from vasculo.measure.cords import Cords, cords
from vasculo.measure.corridors import Corridors, corridors
from vasculo.measure.distance import Distance, distance
from vasculo.measure.distribution import Distribution
from vasculo.measure.hydraulics import (
    flow_direction,
    permeability,
    permeability_tensor,
    pillar_drag,
    resistance,
)
from vasculo.measure.junctions import Junctions
from vasculo.measure.middle_lines import MiddleLines, middle_lines
from vasculo.measure.morphometry import Morphometry, morphometry
from vasculo.measure.network import NetworkFlow, poiseuille_network
from vasculo.measure.passages import Passages, passages
from vasculo.measure.plexus import PlexusNumbers, plexus
from vasculo.measure.shape import PillarTable, mean_gap, order, pillars
from vasculo.measure.shear import ShearDistribution, mean_wall_shear, shear_distribution, shear_ratio
from vasculo.measure.tubules import TubuleFlow, tubule_flow

__all__ = [
    "AngleSummary",
    "Chains",
    "Cords",
    "Corridors",
    "Distance",
    "Distribution",
    "Junctions",
    "LocalAngles",
    "MiddleLines",
    "Morphometry",
    "NetworkFlow",
    "Passages",
    "PillarTable",
    "PlexusNumbers",
    "ShearDistribution",
    "TubuleFlow",
    "alignment",
    "chains",
    "cords",
    "corridors",
    "distance",
    "flow_direction",
    "local_angles",
    "mean_gap",
    "mean_wall_shear",
    "middle_lines",
    "morphometry",
    "order",
    "passages",
    "permeability",
    "permeability_tensor",
    "pillar_drag",
    "pillars",
    "plexus",
    "poiseuille_network",
    "resistance",
    "shear_distribution",
    "shear_ratio",
    "tubule_flow",
]
