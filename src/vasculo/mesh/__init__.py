"""Triangulations of a domain: size, placement, Delaunay, truss relaxation."""
