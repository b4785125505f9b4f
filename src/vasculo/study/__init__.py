"""Studies: settings from a file, the stages in order, and what watches them."""
