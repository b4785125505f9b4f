"""A fit in words: how near it came, what stays off, what the target says about the settings."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from vasculo.study.match.result import Matched, Range

MEANINGS: Mapping[str, str] = MappingProxyType(
    {
        "whole": "islands inside the window",
        "cut": "pieces of islands that its edge cuts",
        "islands": "expected islands in the window",
        "spacing": "root of the area an island, in the unit of each pattern",
        "vessel_fraction": "area of the vessels over that of the window",
        "vessel_length": "length of middle lines an area, times the spacing",
        "area_variation": "standard deviation of the island areas over their mean",
        "roundness": "4 pi area / perimeter squared, mean",
        "solidity": "area over that of the convex hull, mean",
        "elongation": "aspect ratio, mean",
        "order": "of the long axes: 0 none, 1 all parallel",
        "regularity": "distance of nearest centroids: 1 random, 2.15 hexagons",
        "neighbours": "islands that an island shares vessels with",
        "width": "of the vessels, over the spacing",
        "width_variation": "standard deviation over the mean",
        "segment": "length of a vessel between junctions, over the spacing",
        "segment_variation": "standard deviation over the mean",
        "junctions": "junctions an island",
        "degree": "vessels at a junction, mean",
        "three_way": "share of junctions of three",
    }
    | {
        f"area_{share}": f"{share} % of the islands are not above this, over the mean area"
        for share in (10, 25, 50, 75, 90)
    }
)
"""What each number of a morphometry is, in a line."""


def setting_words(found: Range) -> str:
    """Say what is known of one setting."""
    if found.identified:
        return f"{found.low:g} to {found.high:g}"
    return f"{found.low:g} to {found.high:g}: not identified"


def sentences(found: Matched) -> list[str]:
    """Say how the fit went."""
    single, usual, floor = found.single, found.default, found.floor
    default = f"one of the defaults {usual[0]:.2f} ± {usual[1]:.2f}" if found.defaults else "the defaults give none"
    first = (
        f"A plexus of these settings is {single[0]:.2f} ± {single[1]:.2f} from the picture, {default}. Two "
        f"plexuses of these settings, with the islands of the picture, are {floor[0]:.2f} ± {floor[1]:.2f} apart: the "
        "noise floor."
    )
    told = [first]
    if single[0] <= floor[0] + 2.0 * floor[1]:
        told.append("By its distance the picture could be one more plexus of these settings.")
    elif found.off:
        differences = found.distance.differences
        worst = ", ".join(f"{name.replace('_', ' ')} ({differences[name]:+.1f})" for name in found.off)
        told.append(
            f"The model does not reach the picture. These stay off: {worst}, in units of what chance makes of windows "
            "with eighty islands."
        )
    else:
        told.append("The model comes near the picture without reaching it; no single number is far off.")
    lost = [each.name for each in found.ranges if not each.identified]
    if lost:
        told.append(f"The picture does not tell {', '.join(lost)}: values over most of the range do as well.")
    told.append(
        f"{len(found.evaluations)} evaluations; {found.ended}. The ranges are those of the {found.near} that came as "
        "near as the best, within two standard errors over seeds; not all values outside were tried."
    )
    return told
