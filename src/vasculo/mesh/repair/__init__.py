"""Local repair of a mesh whose outlines have moved, and fields brought along."""
