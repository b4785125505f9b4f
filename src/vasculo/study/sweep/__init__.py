"""Sweeps: many runs of one study under varied settings, on the processors of a machine or at a scheduler."""
