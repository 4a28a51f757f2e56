"""Band storage, product, factorization and solution against numpy's dense arithmetic; interpreted,
which takes less time than a compiler and has the same bits (test_code.py)."""

import numpy as np
import pytest
from rotor_fmu.model.kernels import band
from rotor_fmu.model.kernels.kernel import interpreted

EPS = np.finfo(float).eps
SIZES = [(1, 0), (2, 1), (4, 3), (16, 3), (30, 1), (25, 7), (12, 11), (40, 0)]
KINDS = [float, complex]


def random_vector(rng, shape, kind):
    real = rng.standard_normal(shape)
    return real + 1j * rng.standard_normal(shape) if kind is complex else real


def random_matrix(rng, n, half_bandwidth, kind):
    """Symmetric, with a positive definite real part, as the matrices of the integration are."""
    dense = random_vector(rng, (n, n), kind)
    dense = np.tril(np.triu(dense + dense.T, -half_bandwidth), half_bandwidth)
    return dense + np.diag(np.abs(dense).sum(axis=1) + rng.uniform(0.1, 1.0, n))


@pytest.fixture(params=[(size, kind, seed) for size in SIZES for kind in KINDS for seed in (0, 1)])
def case(request):
    (n, half_bandwidth), kind, seed = request.param
    rng = np.random.default_rng(seed)
    return rng, random_matrix(rng, n, half_bandwidth, kind), half_bandwidth, kind


def test_band_storage_keeps_the_matrix(case):
    _, dense, half_bandwidth, _ = case
    packed = band.to_band(dense, half_bandwidth)
    assert packed.shape == (len(dense), half_bandwidth + 1)
    np.testing.assert_array_equal(band.to_dense(packed), dense)


def test_product_is_that_of_the_dense_matrix():
    rng = np.random.default_rng(7)
    for n, half_bandwidth in SIZES:
        dense = random_matrix(rng, n, half_bandwidth, float)
        x, before = random_vector(rng, n, complex), random_vector(rng, n, complex)
        y = before.copy()
        interpreted(band.add_product)(band.to_band(dense, half_bandwidth), x, y)
        expected = before + dense @ x
        terms = np.abs(before) + np.abs(dense) @ np.abs(x)
        assert np.all(np.abs(y - expected) <= 8 * n * EPS * terms)


def test_factors_multiply_to_the_matrix(case):
    _, dense, half_bandwidth, _ = case
    n = len(dense)
    factors = band.to_band(dense, half_bandwidth)
    interpreted(band.factorize)(factors)
    L = np.tril(band.to_dense(factors), -1) + np.eye(n)
    D = np.diag(1 / factors[:, 0])
    # Higham, sec. 9.3; complex numbers round a few times more
    assert np.all(
        np.abs(L @ D @ L.T - dense) <= 8 * n * EPS * (np.abs(L) @ np.abs(D) @ np.abs(L.T))
    )


def test_solution_is_that_of_the_dense_matrix(case):
    rng, dense, half_bandwidth, kind = case
    right = random_vector(rng, len(dense), kind)
    factors = band.to_band(dense, half_bandwidth)
    interpreted(band.factorize)(factors)
    x = right.copy()
    interpreted(band.solve)(factors, x)
    expected = np.linalg.solve(dense, right)
    rounding = 8 * len(dense) * EPS * np.linalg.cond(dense, np.inf)
    assert np.abs(x - expected).max() <= rounding * np.abs(expected).max()


def test_form_is_that_of_the_dense_matrix():
    rng = np.random.default_rng(4)
    for n, half_bandwidth in SIZES:
        dense = random_matrix(rng, n, half_bandwidth, float)
        x, y = random_vector(rng, n, complex), random_vector(rng, n, complex)
        expected = x.conj() @ dense @ y
        assert interpreted(band.form)(band.to_band(dense, half_bandwidth), x, y) == pytest.approx(
            expected
        )


def test_square_is_the_form_of_a_vector_with_itself():
    rng = np.random.default_rng(6)
    for n, half_bandwidth in SIZES:
        dense = random_matrix(rng, n, half_bandwidth, float)
        x = random_vector(rng, n, complex)
        squared = interpreted(band.square)(band.to_band(dense, half_bandwidth), x)
        assert squared == pytest.approx((x.conj() @ dense @ x).real)


@pytest.mark.parametrize("first", [0, 1, 5, 8])
def test_leading_zeros_of_the_right_hand_side_can_be_skipped(first):
    rng = np.random.default_rng(5)
    factors = band.to_band(random_matrix(rng, 9, 3, complex), 3)
    interpreted(band.factorize)(factors)
    x = random_vector(rng, 9, complex)
    x[:first] = 0
    whole = x.copy()
    interpreted(band.solve)(factors, whole)
    interpreted(band.solve)(factors, x, first)
    np.testing.assert_array_equal(x, whole)


def test_real_factors_solve_for_complex_right_hand_sides():
    rng = np.random.default_rng(3)
    dense = random_matrix(rng, 9, 3, float)
    right = random_vector(rng, 9, complex)
    factors = band.to_band(dense, 3)
    interpreted(band.factorize)(factors)
    x = right.copy()
    interpreted(band.solve)(factors, x)
    # of a definite matrix the factors are no larger than it
    assert np.abs(dense @ x - right).max() <= 8 * 9 * EPS * (np.abs(dense) @ np.abs(x)).max()
