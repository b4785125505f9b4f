"""Flexible GMRES, its vectors and the block-Jacobi step, against plain linear algebra."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse

from vasculo.flow.linear.jacobi import add_step_plain, inverse_diagonal, jacobi_step
from vasculo.flow.linear.krylov import refine
from vasculo.flow.linear.vectors import BLOCK, add_multiples, norm, products
from vasculo.springs.threads import get_threads, set_threads


@given(st.integers(1, 3 * BLOCK), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_products_and_multiples_match_numpy(size, rows, seed):
    rng = np.random.default_rng(seed)
    vectors, other = rng.normal(size=(rows, size)), rng.normal(size=size)
    found = products(vectors, rows, other)
    np.testing.assert_allclose(found, vectors @ other, rtol=0, atol=1e-13 * size)
    assert norm(other) == pytest.approx(np.linalg.norm(other), rel=1e-14)
    wanted = other + found[:-1] @ vectors[:-1]
    add_multiples(vectors, found[:-1], other)
    np.testing.assert_allclose(other, wanted, rtol=0, atol=1e-13 * size**1.5)


def test_sums_do_not_depend_on_threads(monkeypatch):
    monkeypatch.setattr("vasculo.flow.linear.vectors.FEW", 1)
    vectors = np.random.default_rng(0).normal(size=(4, 7 * BLOCK + 5))
    threads, results = get_threads(), []
    try:
        for number in (1, 3):
            set_threads(number)
            other = vectors[0].copy()
            add_multiples(vectors.astype(np.float32), products(vectors, 3, other), other)
            results.append(other)
    finally:
        set_threads(threads)
    np.testing.assert_array_equal(*results)


def test_a_vector_with_nan_has_no_norm():
    assert np.isnan(norm(np.array([1.0, np.nan])))


def problem(size=60, near=0.3):
    rng = np.random.default_rng(3)
    matrix = np.eye(size) + near * rng.normal(size=(size, size)) / np.sqrt(size)
    return matrix, rng.normal(size=size)


@pytest.mark.parametrize("steps", [5, 60])
def test_it_reaches_the_residual_that_it_says(steps):
    matrix, right = problem()
    found = refine(lambda x: matrix @ x, right, lambda r: r, goal=1e-10, good=1e-10, steps=steps, most=200)
    left = np.linalg.norm(right - matrix @ found.unknowns) / np.linalg.norm(right)
    assert found.residual == pytest.approx(left, rel=1e-2)
    assert left <= 1e-10
    assert steps < found.iterations < 60 or steps == 60


def test_it_is_optimal_over_the_space():
    # Plain GMRES from the normal equations over the same Krylov space.
    matrix, right = problem(near=0.8)
    found = refine(lambda x: matrix @ x, right, lambda r: r, goal=1e-14, good=1e-14, steps=6, most=6)
    space = np.linalg.qr(np.array([np.linalg.matrix_power(matrix, k) @ right for k in range(6)]).T)[0]
    best = np.linalg.lstsq(matrix @ space, right, rcond=None)[0]
    wanted = np.linalg.norm(right - matrix @ space @ best) / np.linalg.norm(right)
    assert found.residual == pytest.approx(wanted, rel=1e-5)
    assert found.iterations == 6


def test_the_preconditioner_may_change_from_step_to_step():
    matrix, right = problem(near=0.9)
    inverse = np.linalg.inv(matrix)
    calls = []

    def precondition(rest):
        calls.append(1)
        return (inverse @ rest).astype(np.float32).astype(np.float64) if len(calls) % 2 else rest

    found = refine(lambda x: matrix @ x, right, precondition, goal=1e-13, good=1e-12, steps=10, most=40)
    assert found.residual <= 1e-12
    assert found.iterations == len(calls) <= 6


def test_a_preconditioner_that_breaks_down_leaves_no_solution():
    matrix, right = problem()
    found = refine(lambda x: matrix @ x, right, lambda r: r * np.nan, goal=1e-10, good=1e-10, steps=5, most=20)
    assert found.residual == 1.0
    assert not found.unknowns.any()


def test_the_number_of_steps_is_kept():
    matrix, right = problem(near=3.0)
    found = refine(lambda x: matrix @ x, right, lambda r: r, goal=1e-13, good=1e-12, steps=4, most=10)
    assert found.iterations <= 10
    assert found.residual > 1e-12


def test_the_jacobi_step_matches_its_plain_twin():
    rng = np.random.default_rng(1)
    blocks = rng.normal(size=(50, 3, 3)) + 4.0 * np.eye(3)
    matrix = sparse.bsr_array(
        (np.concatenate([blocks, blocks[:1]]), np.array([*range(50), 3]), np.array([*range(50), 51])),
        shape=(150, 150),
    )  # a second block in the last row
    inverse = inverse_diagonal(matrix)
    np.testing.assert_allclose(inverse @ blocks, np.broadcast_to(np.eye(3), blocks.shape), atol=1e-5)
    right, product, found = rng.normal(size=(3, 150))
    wanted = add_step_plain(inverse, 0.4, right, product, found)
    jacobi_step(inverse, 0.4, right, product, found)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13)
