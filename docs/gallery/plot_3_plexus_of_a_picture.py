"""
A plexus from your picture
==========================

A micrograph, or a mask drawn over one, becomes a flow domain: the islands between the vessels are
the pillars. The picture here comes with the repository, and its licence beside it; put the path of
yours in its place.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import vasculo as vc
from vasculo.draw.show import show

file = Path("../../examples/images/capillaries.png")
picture = np.asarray(Image.open(file).convert("L"))[:, :260]
found = vc.domain_from_image(picture, vc.ImageExtraction(vessels="dark"))

# %%
# Left the picture with the outlines that were found, right the domain. Which grey is a vessel is
# decided by Otsu's threshold; ``vc.ImageExtraction`` has a parameter for every such choice.

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained")
left.imshow(picture, cmap="gray")
for pillar in found.domain.pillars:
    outline = found.in_picture(np.vstack([pillar, pillar[:1]]))
    left.plot(*outline.T, color="#e08a4f", linewidth=1)
left.set_axis_off()
show(found.domain, axes=right)
plt.show()

# %%
# The domain is one like any other. Lengths are pixels.

table = vc.measure.pillars(found.domain)
print(f"{len(found.domain.pillars)} pillars, mean area {table.area.mean():.0f} pixels")
found.domain
