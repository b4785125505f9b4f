"""Outlines, domains and distances between outlines."""
