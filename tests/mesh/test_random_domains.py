"""Random domains that are hard on purpose: a valid mesh or a refusal in one line, nothing else."""

import numpy as np
import pytest
from benchmarks.random_domains import outcome
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh


@pytest.mark.slow
@settings(deadline=None, max_examples=100)
@given(seed=st.integers(0, 10**9))
def test_every_domain_is_meshed_or_refused(seed):
    # `outcome` checks the mesh by other means than the mesher's, and that a refusal is one line
    name, mesh = outcome(seed)
    assert (mesh is not None) == (name == "meshed")


@settings(deadline=None, max_examples=40)
@given(
    nodes=st.lists(
        st.tuples(st.integers(0, 4), st.integers(0, 4)).map(lambda p: (p[0] + 2.0, p[1] + 2.0)), min_size=3, max_size=8
    ),
    nudge=st.sampled_from([0.0, 1e-15, 1e-9, 1e-3]),
    turn=st.floats(0, 6.3),
)
def test_pillars_on_a_lattice_with_many_collinear_nodes(nodes, nudge, turn):
    pillar = np.array(nodes) + nudge * np.column_stack((np.sin(np.arange(len(nodes))), np.cos(np.arange(len(nodes)))))
    middle = np.array([4.0, 4.0])
    turned = (pillar - middle) @ np.array([(np.cos(turn), np.sin(turn)), (-np.sin(turn), np.cos(turn))]) + middle
    mesh, refused = None, ""
    try:
        domain = Domain.rectangle(8, 8, [turned])
        mesh = generate_mesh(domain, 0.7, max_triangles=20_000)
    except InputError as error:
        refused = str(error)
    if mesh is None:
        assert refused
        assert "\n" not in refused
    else:
        assert mesh.check().area == pytest.approx(domain.area, rel=1e-12)
        assert mesh.check().loops == 2
