"""Fit to a picture: the settings of vasculogenesis whose plexus looks most like it."""
