"""Slow viscous flow between the pillars: cell-centred finite volumes on triangles (eqs 6-10)."""
