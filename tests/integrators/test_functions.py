"""Our own sine, cosine, angle and roots against mpmath, in units of the last place."""

import cmath
import math
import random

import mpmath
import pytest
from rotor_fmu.model.kernels import functions
from rotor_fmu.model.kernels.kernel import interpreted

# interpreted, which is bit for bit the compiled (test_code.py)
angle, direction, modulus = map(
    interpreted, (functions.angle, functions.direction, functions.modulus)
)
exponential, logarithm = interpreted(functions.exponential), interpreted(functions.logarithm)
power = interpreted(functions.power)
cube_root, fifth_root = interpreted(functions.cube_root), interpreted(functions.fifth_root)

TRIALS = 2000


@pytest.fixture(autouse=True)
def _many_digits():
    with mpmath.workdps(60):
        yield


@pytest.fixture
def random_numbers():
    return random.Random(1)


def ulps(value, exact):
    """Distance of a number from the exact one."""
    return float(abs(mpmath.mpf(value) - exact) / mpmath.mpf(math.ulp(float(exact))))


def worst(pairs):
    return max(ulps(value, exact) for value, exact in pairs)


@pytest.mark.parametrize("size", [1e-8, 1.0, 10.0, 1e5, 1e8, 1e11])
def test_sine_and_cosine_are_right_below_one_ulp(random_numbers, size):
    for _ in range(TRIALS):
        theta = random_numbers.uniform(-size, size)
        z = direction(theta)
        assert ulps(z.real, mpmath.cos(theta)) < 0.85, theta
        assert ulps(z.imag, mpmath.sin(theta)) < 0.85, theta


def test_sine_and_cosine_are_right_next_to_their_zeros(random_numbers):
    """Where all leading digits of the angle cancel."""
    for _ in range(TRIALS):
        theta = random_numbers.randrange(1, 10**7) * math.pi / 2
        z = direction(theta)
        assert worst([(z.real, mpmath.cos(theta)), (z.imag, mpmath.sin(theta))]) < 0.85, theta


def test_what_is_no_angle_has_no_direction():
    for theta in (math.inf, -math.inf, math.nan):
        assert cmath.isnan(direction(theta))


def test_the_angle_is_right_below_one_ulp_in_all_quadrants(random_numbers):
    for _ in range(TRIALS):
        size = 10.0 ** random_numbers.uniform(-9, 3)
        z = complex(random_numbers.uniform(-size, size), random_numbers.uniform(-1, 1))
        assert ulps(angle(z), mpmath.atan2(z.imag, z.real)) < 0.6, z


@pytest.mark.parametrize("z", [1, -1, 1j, -1j, 1 + 1j, -1 - 1j, 0])
def test_the_angle_is_exact_on_the_axes_and_diagonals(z):
    assert angle(complex(z)) == cmath.phase(complex(z))


def test_the_modulus_is_right_below_one_and_a_half_ulp(random_numbers):
    """The square root of rounded squares."""
    for _ in range(TRIALS):
        z = complex(random_numbers.gauss(0, 1), random_numbers.gauss(0, 1e-3))
        exact = mpmath.sqrt(mpmath.mpf(z.real) ** 2 + mpmath.mpf(z.imag) ** 2)
        assert ulps(modulus(z), exact) < 1.5, z


@pytest.mark.parametrize(("root", "n"), [(cube_root, 3), (fifth_root, 5)])
def test_roots_are_right_below_one_ulp(random_numbers, root, n):
    for _ in range(TRIALS):
        x = 10.0 ** random_numbers.uniform(-300, 300)
        assert ulps(root(x), mpmath.root(mpmath.mpf(x), n)) < 1.0, x


def test_roots_of_nothing_and_of_infinity():
    assert [cube_root(0.0), fifth_root(math.inf)] == [0.0, math.inf]
    assert math.isnan(cube_root(math.nan))


def test_the_exponential_is_right_within_two_ulp(random_numbers):
    for _ in range(TRIALS):
        x = random_numbers.uniform(-690, 690)
        assert ulps(exponential(x), mpmath.exp(x)) < 2.0, x
    assert [exponential(-1e9), exponential(1e9)] == [0.0, math.inf]


def test_the_logarithm_is_right_within_four_ulp_of_the_larger_of_it_and_one(random_numbers):
    for _ in range(TRIALS):
        x = 10.0 ** random_numbers.uniform(-300, 300)
        exact = mpmath.log(x)
        assert abs(logarithm(x) - exact) < 4 * math.ulp(max(1.0, abs(float(exact)))), x
    assert logarithm(1.0) == 0.0


def test_powers_are_right_to_rounding_times_the_logarithm(random_numbers):
    for _ in range(TRIALS):
        x, y = 10.0 ** random_numbers.uniform(-12, 3), random_numbers.uniform(0, 4)
        exact = mpmath.power(x, y)
        bound = 4 * (1 + abs(y * math.log(x)))
        assert ulps(power(x, y), exact) < bound, (x, y)
    assert [power(3.0, 0.0), power(3.0, 1.0), power(0.0, 0.7)] == [1.0, 3.0, 0.0]
    assert power(2.0, 0.5) == math.sqrt(2.0)
