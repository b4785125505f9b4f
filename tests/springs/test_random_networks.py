"""The engine against its twin on networks of any shape: hubs, long springs, coincident nodes, tori, lone nodes."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.springs.box import image_offsets
from vasculo.springs.motion import damped_steps_plain
from vasculo.springs.network import SpringNetwork


def random_network(nodes, seed, *, far, around, alike):
    rng = np.random.default_rng(seed)
    points = rng.random((nodes, 2))
    points[rng.integers(0, nodes, nodes // 8)] = points[rng.integers(0, nodes, nodes // 8)]  # coincident
    first = rng.integers(0, nodes, rng.integers(0, 4 * nodes + 1))
    second = rng.integers(0, nodes, len(first)) if far else (first + rng.integers(1, 20, len(first))) % nodes
    pairs = np.unique(np.sort(np.stack([first, second], axis=1)[first != second], axis=1), axis=0)
    pairs = rng.permutation(pairs)
    turned = rng.random(len(pairs)) < 0.5
    pairs[turned] = pairs[turned][:, ::-1]
    if around:
        arms = points[pairs[:, 1]] - points[pairs[:, 0]]
        pairs = pairs[(np.abs(arms - np.round(arms)) < 0.45).all(axis=1)]
    network = SpringNetwork(
        points,
        pairs.astype(np.int32),
        rng.uniform(0.0, 0.5, len(pairs)),
        1.5 if alike else rng.uniform(0.5, 2.0, len(pairs)),
        rng.uniform(0.5, 2.0, nodes),
        rng.uniform(0.0, 2.0),
        rng.random(nodes) < 0.2,
        tether=0.1 * far,
        box=(1.0, 1.0) if around else None,
    )
    network.velocities = rng.normal(0.0, 0.05, (nodes, 2))
    return network, rng.uniform(0.05, 1.0, len(pairs))


@settings(max_examples=150, deadline=None)
@given(
    nodes=st.sampled_from([1, 2, 3, 63, 64, 65, 511, 512, 513, 1024, 1500]),
    seed=st.integers(0, 10_000),
    steps=st.integers(0, 7),
    far=st.booleans(),
    around=st.booleans(),
    alike=st.booleans(),
)
def test_engine_and_twin_agree(nodes, seed, steps, far, around, alike):
    network, limit = random_network(nodes, seed, far=far, around=around, alike=alike)
    dt = min(0.3 * network.safe_limit(), 0.1)
    state, broken = (network.points.copy(), network.velocities.copy()), np.zeros(len(limit), bool)
    shifts = np.zeros((len(limit), 2))
    if around:
        shifts = image_offsets(network.reference, network.springs[:, 0], network.springs[:, 1], network.box)
    keep = np.where(network.pinned, 0.0, 1.0 / (1.0 + network.damping * dt / network.masses))
    springy = network.springs.copy(), shifts, network.stiffness.copy(), network.rest_lengths.copy(), limit.copy()
    home = network.tether, network.reference, np.zeros_like(state[0])
    ramp = dt, 1.0, -0.01 / max(steps, 1), steps, broken
    damped_steps_plain(*state, *springy, dt / network.masses, keep, *home, *ramp)
    gone = network.advance(dt, steps, break_above=limit, rest_factor=(1.0, 0.99))
    assert np.array_equal(np.flatnonzero(broken), gone)
    np.testing.assert_allclose(network.points, state[0], rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(network.velocities, state[1], rtol=0.0, atol=1e-9)
