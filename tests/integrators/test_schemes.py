"""Integrators against paper B's Figure 1 (an independent prototype's numbers) and laws."""

import math

import numpy as np
import pytest

from papers.integrators import classical, spectral
from papers.integrators import members as schemes

TURN = 2 * math.pi
CENTRAL = classical.CentralDifference()
LINEAR = schemes.newmark(1 / 6)
AVERAGE = schemes.newmark()
HOUBOLT = classical.Houbolt()
WILSON = classical.WilsonTheta(1.4)
EVERY = {
    "central difference": CENTRAL,
    "linear acceleration": LINEAR,
    "average acceleration": AVERAGE,
    "newmark 1/2 1/2": schemes.newmark(0.5, 0.5),
    "newmark 0.3 0.52": schemes.newmark(0.3, 0.52),
    "houbolt": HOUBOLT,
    "wilson 1.4": WILSON,
    "wilson 1.2": classical.WilsonTheta(1.2),
    "transient fidelity": schemes.TRANSIENT_FIDELITY,
    "moderate dissipation": schemes.MODERATE_DISSIPATION,
    "hht 1/2": schemes.hht(0.5),
    "hht -0.05": schemes.hht(-0.05),
    "wbz 0.08": schemes.wbz(0.08),
    "wbz -0.3": schemes.wbz(-0.3),
    "generalized-alpha 0.1 0.08": schemes.generalized_alpha(0.1, 0.08),
    "chung-hulbert 0.2": schemes.chung_hulbert(0.2),
    "inconsistent": schemes.general(0.3, -0.2, 0.9, 1.05),
}
SECOND_ORDER = [name for name in EVERY if name not in ("newmark 0.3 0.52", "inconsistent")]
each = pytest.mark.parametrize("method", EVERY.values(), ids=EVERY)


@pytest.mark.parametrize(
    ("method", "dt_over_t"),
    [
        (CENTRAL, 1 / math.pi),
        (LINEAR, math.sqrt(3) / math.pi),
        (AVERAGE, math.inf),
        (HOUBOLT, math.inf),
        (WILSON, math.inf),
        (schemes.TRANSIENT_FIDELITY, math.inf),
        (schemes.MODERATE_DISSIPATION, math.inf),
        (schemes.hht(0.5), math.inf),
        (schemes.hht(1 / 3), math.inf),
        (schemes.wbz(0.08), 0.0),
        # Hughes 1987: w = sqrt(2 / (gamma - 2 beta)) for gamma > 2 beta, undamped
        (schemes.newmark(0.25, 0.52), math.sqrt(2 / 0.02) / TURN),
    ],
)
def test_stability_ends_where_paper_b_and_hughes_say(method, dt_over_t):
    assert spectral.stability_limit(method) / TURN == pytest.approx(dt_over_t, abs=1e-9)


@each
def test_no_oscillation_grows_below_the_stability_limit_and_some_grow_above(method):
    for xi in (0.0, 0.03):
        limit = spectral.stability_limit(method, xi)
        beside = (0.98 * limit, 1.02 * limit) if 0 < limit < 1000 else ()
        grid = np.sort([*np.geomspace(0.05, 2000, 50), *beside])
        rho = np.array([spectral.spectral_radius(method, w, xi) for w in grid])
        assert np.all(rho[grid < limit] < 1 + 1e-7)
        if limit < 1000:
            assert rho[grid > limit].max() > 1 + 1e-4
        assert [spectral.is_stable(method, w, xi) for w in grid] == list(grid < limit)


# Paper B, Figure 1: rho at dt/T = 0.1, 0.3, 1, 10.
FIGURE_1 = [
    (CENTRAL, (1, 1, 37.452, 3945.8)),
    (LINEAR, (1, 1, 2.8586, 3.7222)),
    (AVERAGE, (1, 1, 1, 1)),
    (HOUBOLT, (0.969708, 0.727880, 0.339226, 0.065884)),
    (WILSON, (0.991758, 0.872175, 0.612547, 0.771394)),
    (schemes.hht(0.05), (0.999282, 0.980780, 0.923864, 0.904992)),
    (schemes.hht(math.sqrt(2) - 1), (0.997818, 0.945869, 0.754390, 0.684066)),
    (schemes.hht(0.5), (0.99806, 0.95026, 0.76847, 0.99183)),
    (schemes.hht(1 / 3), (0.99773, 0.94430, 0.74853, 0.55111)),
]


@pytest.mark.parametrize(("method", "expected"), FIGURE_1)
def test_spectral_radius_is_that_of_figure_1(method, expected):
    rho = [spectral.spectral_radius(method, TURN * ratio) for ratio in (0.1, 0.3, 1.0, 10.0)]
    # two of the tabled numbers are given to five digits only
    assert rho == pytest.approx(expected, abs=1e-5, rel=1.5e-5 if max(expected) > 1 else 0)


@pytest.mark.parametrize(
    ("method", "rho"),
    [
        (CENTRAL, math.inf),
        (LINEAR, 2 + math.sqrt(3)),
        (AVERAGE, 1),
        (HOUBOLT, 0),
        (schemes.hht(0.05), 0.95 / 1.05),
        (schemes.hht(math.sqrt(2) - 1), 1 / math.sqrt(2)),
        (schemes.hht(0.5), 1),
        (schemes.hht(1 / 3), 0.5),
        (schemes.wbz(0.08), 1.08 / 0.92),
        (schemes.generalized_alpha(0.1, 0.08), 0.98 / 1.02),
        (schemes.chung_hulbert(0.2), 0.2),
    ],
)
def test_spectral_radius_at_infinity(method, rho):
    assert method.rho_infinity == pytest.approx(rho, abs=1e-8)


def test_wilsons_radius_at_infinity_is_the_tabled_one():
    assert WILSON.rho_infinity == pytest.approx(0.778442, abs=1e-6)


@pytest.mark.parametrize(("af", "am"), [(0.1, 0.08), (0.5, 0.0), (0.0, -0.3), (1 / 6, -0.5)])
def test_second_order_members_have_a_double_root_at_infinity(af, am):
    d = af - am
    roots = schemes.roots_at_infinity(schemes.generalized_alpha(af, am))
    assert roots == pytest.approx([(d - 1) / (d + 1)] * 2 + [-af / (1 - af)], abs=1e-8)


@pytest.mark.parametrize("name", [n for n, m in EVERY.items() if isinstance(m, schemes.Scheme)])
def test_roots_at_infinity_are_those_of_the_amplification_matrix_there(name):
    scheme = EVERY[name]
    # by their polynomial, because multiple eigenvalues are ill-conditioned
    expected = np.poly(schemes.amplification(scheme, math.inf))
    assert np.poly(schemes.roots_at_infinity(scheme)) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("method", "dt_over_t", "rho"),
    [
        (WILSON, 2.289, 0.54108),
        (schemes.MODERATE_DISSIPATION, 5.97, 0.58914),
        (schemes.hht(0.5), 2.120, 0.67929),
    ],
)
def test_spectral_radius_has_its_kink_where_figure_1_has_it(method, dt_over_t, rho):
    w, least = spectral.least_spectral_radius(method)
    assert w / TURN == pytest.approx(dt_over_t, abs=0.001)
    assert least == pytest.approx(rho, abs=1e-5)


def test_a_radius_that_falls_for_ever_is_least_at_infinity_and_one_that_never_falls_nowhere():
    assert spectral.least_spectral_radius(schemes.hht(0.05)) == (
        math.inf,
        pytest.approx(0.95 / 1.05),
    )
    assert spectral.least_spectral_radius(CENTRAL) == (0.0, 1.0)


# Paper A's parameters on its 29.4 Hz mode: step [s], numerical damping ratio, period elongation.
MODE_29 = [
    (schemes.generalized_alpha(0.1, 0.08), 0.004, 5.6536e-4, 0.04589),
    (schemes.generalized_alpha(0.1, 0.08), 0.02, 9.8053e-3, 0.7305),
    (schemes.generalized_alpha(0.15, 0.1), 0.004, 1.18444e-3, 0.04832),
    (schemes.hht(0.1), 0.004, 3.2221e-3, 0.05380),
    (schemes.newmark(), 0.004, 0.0, 0.04395),
]


@pytest.mark.parametrize(("scheme", "h", "damping", "elongation"), MODE_29)
def test_what_paper_as_parameters_do_to_its_first_mode(scheme, h, damping, elongation):
    w = TURN * 29.4 * h
    assert spectral.numerical_damping(scheme, w) == pytest.approx(damping, rel=2e-5, abs=1e-12)
    assert spectral.period_elongation(scheme, w) == pytest.approx(elongation, abs=6e-6, rel=6e-5)


def test_paper_as_wbz_feeds_the_oscillation_and_chung_hulbert_damps_it_least():
    w = TURN * 29.4 * 0.004
    assert spectral.numerical_damping(schemes.wbz(0.08), w) < 0
    chosen = schemes.generalized_alpha(0.1, 0.08)
    best = schemes.chung_hulbert(chosen.rho_infinity)
    assert (best.alpha_m, best.alpha_f) == pytest.approx((0.47, 0.49))
    ratio = spectral.numerical_damping(chosen, w) / spectral.numerical_damping(best, w)
    assert ratio == pytest.approx(380, abs=5)


@pytest.mark.parametrize(("af", "am"), [(0.1, 0.08), (0.4, 0.0), (0.0, -0.3), (0.2, -0.4), (0, 0)])
def test_small_steps_follow_the_series_for_damping_and_elongation(af, am):
    d, w = af - am, 0.02
    scheme = schemes.generalized_alpha(af, am)
    damping = d * (1 - am - af) ** 2 / 8 * w**3
    elongation = w**2 * (1 / 12 + d * (1 - am - af) / 4 - d**2 / 8)
    assert spectral.numerical_damping(scheme, w) == pytest.approx(damping, rel=2e-3, abs=1e-13)
    assert spectral.period_elongation(scheme, w) == pytest.approx(elongation, rel=2e-3)


@each
@pytest.mark.parametrize("xi", [0.0, 0.02, 0.3])
def test_small_steps_decay_and_turn_as_the_exact_oscillation_does(method, xi):
    w = 1e-4
    exact = complex(-xi, math.sqrt(1 - xi**2))
    assert spectral.principal_root(method, w, xi) / w == pytest.approx(exact, abs=0.1 * w)
    rest = xi / math.sqrt(1 - xi**2)
    assert spectral.damping_ratio(method, w, xi) == pytest.approx(rest, abs=0.4 * w)


@each
def test_amplification_matrix_has_the_eigenvalues_of_the_characteristic_polynomial(method):
    inertia, damping, stiffness = (np.array(p, dtype=float) for p in method.characteristic())
    for w, xi in ((0.3, 0.0), (0.9, 0.2), (5.0, 0.0), (40.0, 0.7)):
        x = np.linalg.eigvals(method.amplification(w, xi)) - 1
        powers = x[:, None] ** np.arange(4)
        terms = [
            powers[:, : len(part)] * part * factor
            for part, factor in ((inertia, 1), (damping, 2 * xi * w), (stiffness, w**2))
        ]
        scale = sum(np.abs(term).sum(axis=1) for term in terms)
        residual = np.abs(sum(term.sum(axis=1) for term in terms))
        assert np.all(residual < 1e-9 * scale)


def test_determinants_of_the_amplification_matrices():
    am, af, beta, gamma = scheme = schemes.general(0.3, -0.2, 0.7, 0.8)
    for w in (0.1, 1.0, 30.0):
        new = (1 - am) + (1 - af) * beta * w**2
        old = am + af * (0.5 - gamma + beta) * w**2
        assert np.linalg.det(scheme.amplification(w)) == pytest.approx(-old / new)
        # central differences keep areas; Houbolt's roots shrink as 1 / (2 + w^2)
        assert np.linalg.det(CENTRAL.amplification(w)) == pytest.approx(1)
        assert np.linalg.det(HOUBOLT.amplification(w)) == pytest.approx(1 / (2 + w**2))


def _time_loop(method, w, steps, xi=0.0):
    """State (q, h v, h^2 a) after some steps from q = 1, v = 0 with the right acceleration."""
    state = np.array([1.0, 0.0, -(w**2)])
    for _ in range(steps):
        state = method.amplification(w, xi) @ state
    return state


def test_undamped_average_acceleration_keeps_the_energy():
    for w in (0.1, 1.3, 20.0):
        q, hv, _ = _time_loop(AVERAGE, w, 1000)
        assert hv**2 + (w * q) ** 2 == pytest.approx(w**2, rel=1e-11)


@pytest.mark.parametrize("name", SECOND_ORDER)
def test_order_of_accuracy_is_two(name):
    for xi in (0.0, 0.05, 0.4):
        assert spectral.order_of_accuracy(EVERY[name], xi) == pytest.approx(2.0, abs=0.02)


@pytest.mark.parametrize("beta", [0.25, 0.26, 0.3])
def test_order_of_newmark_with_gamma_of_0_52_is_one(beta):
    assert spectral.order_of_accuracy(schemes.newmark(beta, 0.52)) == pytest.approx(1.01, abs=0.02)


@pytest.mark.parametrize(
    ("name", "order"),
    [("moderate dissipation", 2), ("generalized-alpha 0.1 0.08", 2), ("newmark 0.3 0.52", 1)],
)
def test_a_marched_free_vibration_converges_with_the_same_order(name, order):
    xi, t = 0.1, 5.0
    rate = complex(-xi, math.sqrt(1 - xi**2))
    exact = ((1 - 1j * xi / rate.imag) * np.exp(rate * t)).real
    errors = [abs(_time_loop(EVERY[name], t / n, n, xi)[0] - exact) for n in (1000, 2000)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.06)


def test_physical_damping_makes_paper_as_wbz_stable_for_short_steps_only():
    limit = spectral.stability_limit(schemes.wbz(0.08), 0.01)
    assert 0 < limit < math.inf
    assert spectral.spectral_radius(schemes.wbz(0.08), 0.99 * limit, 0.01) < 1
    assert spectral.spectral_radius(schemes.wbz(0.08), 1.01 * limit, 0.01) > 1


def test_an_oscillation_that_the_method_has_lost_has_no_period():
    assert math.isnan(spectral.period_elongation(CENTRAL, 2.1))
    assert math.isnan(spectral.numerical_damping(CENTRAL, 2.1))
    with pytest.raises(ValueError, match=r"xi = 1: must be at least 0 and below 1"):
        spectral.principal_root(AVERAGE, 0.1, 1.0)
    with pytest.raises(schemes.SchemeError, match="must be finite"):
        CENTRAL.amplification(math.inf)
