"""Watchers of your own: functions that are called once a step. `disk.toml` and `tissue.toml` beside this file use them.

What they return becomes a row of `watch.csv` in the folder of the run.
"""

import numpy as np

import vasculo as vc


@vc.watcher("growth")
def stretched(step):
    """Measure the fibres of the growing tissue: how many are stretched, and how far."""
    network = step.network
    if len(network.springs) == 0:
        return None
    arms = network.points[network.springs[:, 1]] - network.points[network.springs[:, 0]]
    strains = np.hypot(*arms.T) / network.rest_lengths - 1.0
    return {"stretched": np.mean(strains > 0.0), "largest_strain": strains.max()}


@vc.watcher("remodel")
def fastest(step):
    """Find the largest speed of the blood, in mean speeds."""
    speed = np.hypot(*step.flow.velocity.T)
    return {"peak_speed": speed.max() / speed.mean()}


@vc.watcher("remodel")
def long_enough(step):
    """End the run when the pillars are half as long again as wide."""
    ratio = vc.measure.pillars(step.domain).aspect_ratio.mean()
    if ratio > 1.5:
        raise vc.StopRun(f"aspect ratio {ratio:.2f} at step {step.step}")
    return {"mean_aspect_ratio": ratio}
