"""Delaunay triangulations: insertion, walls, flips."""
