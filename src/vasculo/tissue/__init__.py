"""Vasculogenesis: the initial tissue, its growth and rupture, and the plexus they leave."""
