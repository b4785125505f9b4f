"""The analysis that is kept from flow to flow: the same bits, no factor left behind, never for another pattern."""

import copy
import ctypes
import gc
import pickle

import numpy as np
import pytest
from tests.flow.meshes import cylinder_in_square

from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure, Slip, Velocity
from vasculo.flow.linear import pardiso
from vasculo.flow.linear.kept import KeptAnalysis
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation

pytestmark = pytest.mark.skipif(pardiso.library() is None, reason="the extra `fast` is not installed")
DRIVEN = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()}
FIELDS = ("velocity", "pressure", "wall_shear", "face_flux", "edge_force")


def bent(mesh, share=0.02):
    """The same triangles, sheared a little."""
    x, y = mesh.points.T
    points = np.column_stack((x + share * np.sin(3.0 * y), y + share * np.sin(2.0 * x)))
    return Triangulation(
        points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names, mesh.neighbours
    )


def library_bytes():
    """Bytes that the library has taken and not given back."""
    found = pardiso.library().MKL_Mem_Stat
    found.restype = ctypes.c_int64
    return found(ctypes.byref(ctypes.c_int32(0)))


@pytest.fixture(scope="module")
def meshes():
    mesh = cylinder_in_square(0.2, 48)
    return mesh, bent(mesh), bent(mesh, 0.05)


@pytest.mark.parametrize("solver", ["direct", "compact"])
def test_the_same_bits_as_without(meshes, solver):
    kept = KeptAnalysis()
    assert kept.bytes == 0
    for k, mesh in enumerate(meshes):
        one = solve_stokes(mesh, DRIVEN, solver=solver, kept=kept)
        other = solve_stokes(mesh, DRIVEN, solver=solver)
        assert one.report["analysis"] == ("kept" if k else "anew")
        assert other.report["analysis"] == "anew"
        assert (one.report["analysis_seconds"] == 0.0) == (k > 0)
        assert one.iterations == other.iterations
        assert one.report["factor_bytes"] == other.report["factor_bytes"]
        for name in FIELDS:
            assert np.array_equal(getattr(one, name), getattr(other, name)), name
        assert kept.bytes > 100 * len(mesh.triangles)


def test_other_patterns_and_solvers_are_analysed_anew(meshes):
    kept, mesh = KeptAnalysis(), meshes[0]

    def how(mesh, conditions=DRIVEN, **more):
        return solve_stokes(mesh, conditions, kept=kept, **more).report["analysis"]

    assert [how(mesh), how(mesh)] == ["anew", "kept"]
    assert [how(cylinder_in_square(0.2, 40)), how(mesh)] == ["anew", "anew"]
    assert [how(mesh, solver="compact"), how(mesh, solver="compact")] == ["anew", "kept"]
    assert [how(mesh, solver="splu"), how(mesh, solver="splu")] == ["anew", "anew"]
    assert how(mesh, {}) == "none"  # nothing drives it
    driven = {"left": Velocity(1.0), "right": Pressure(0.0)}
    changed = solve_stokes(mesh, driven, kept=kept)
    assert np.array_equal(changed.velocity, solve_stokes(mesh, driven).velocity)


def test_no_factor_is_left_and_the_analysis_goes_with_its_owner(meshes):
    solve_stokes(meshes[0], DRIVEN)
    start = library_bytes()
    kept = KeptAnalysis()
    factors = int(solve_stokes(meshes[0], DRIVEN, solver="direct", kept=kept).report["factor_bytes"])
    held = library_bytes() - start
    assert 0.6 * kept.bytes < held < min(1.2 * kept.bytes, kept.bytes + 0.5 * factors)
    for mesh in meshes:
        solve_stokes(mesh, DRIVEN, solver="direct", kept=kept)
        assert library_bytes() - start == held
    del kept
    gc.collect()
    assert library_bytes() <= start


def test_too_little_memory_is_refused_with_a_kept_analysis_too(meshes):
    kept = KeptAnalysis()
    solve_stokes(meshes[0], DRIVEN, solver="direct", kept=kept)
    room = 3300 * len(meshes[0].triangles)
    with pytest.raises(InputError, match="GB of memory"):
        solve_stokes(meshes[0], DRIVEN, solver="direct", memory=room, kept=kept)
    assert kept.bytes == 0
    assert solve_stokes(meshes[0], DRIVEN, solver="direct", kept=kept).report["analysis"] == "anew"


def test_copies_are_empty(meshes):
    kept = KeptAnalysis()
    solve_stokes(meshes[0], DRIVEN, solver="direct", kept=kept)
    for other in (copy.copy(kept), copy.deepcopy(kept), pickle.loads(pickle.dumps(kept))):  # noqa: S301
        assert other.bytes == 0
        assert kept.bytes > 0
