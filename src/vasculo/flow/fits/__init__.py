"""Fits at the faces: which values a face sees, and how its gradient, mean and pressure follow from them."""
