"""From the broken network to the flow domain: voids, outlines, passages."""
