"""Angiogenesis: pillars sense wall shear, contract, stretch, align and merge."""
