"""Solvers of the coupled linear system."""
