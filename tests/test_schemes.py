"""Integrators against paper B's Figure 1 (an independent prototype's numbers) and laws."""

import math

import numpy as np
import pytest
from rotor_fmu.model.schemes import family as schemes
from rotor_fmu.model.schemes import spectral

from papers.integrators import classical

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
        grid = np.geomspace(0.05, 2000, 200)
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


# Paper B, (13): alpha_B, alpha_H.
EQUATION_13 = [(-0.5, 0.166667), (0, 0.414214), (0.2, 0.470691), (0.4, 0.497168), (0.5, 0.5)]


@pytest.mark.parametrize(("alpha_b", "alpha_h"), EQUATION_13)
def test_equations_8_and_12_together_give_13(alpha_b, alpha_h):
    result = schemes.energy_momentum_alpha_f(alpha_b)
    assert result == pytest.approx(alpha_h, abs=1e-6)
    scheme = schemes.generalized_alpha(result, alpha_b)
    assert schemes.energy_momentum_beta(alpha_b, result) == pytest.approx(scheme.beta, abs=1e-12)
    assert schemes.rebound(scheme) == pytest.approx(1)


def test_equation_14_is_moderate_dissipation():
    assert schemes.energy_momentum_alpha_f(0) == pytest.approx(math.sqrt(2) - 1, abs=1e-15)
    assert pytest.approx((0, math.sqrt(2) - 1, 0.5, 0.914214), abs=1e-6) == (
        schemes.MODERATE_DISSIPATION
    )


@pytest.mark.parametrize(
    ("scheme", "rebound"),
    [
        (schemes.newmark(), 3),
        (schemes.TRANSIENT_FIDELITY, 2.628),
        (schemes.hht(0.5), 0.778),
        (schemes.MODERATE_DISSIPATION, 1),
        (schemes.chung_hulbert(0.2), 1),
        (schemes.newmark(0.5, 0.5), 1),
    ],
)
def test_rebound_is_that_of_a_free_node_stopped_for_one_step(scheme, rebound):
    assert schemes.rebound(scheme) == pytest.approx(rebound, abs=5e-4)
    am, _, beta, gamma = scheme
    h, v0 = 0.1, 2.0
    a1 = -v0 / (beta * h)  # holds the displacement
    a2 = -am / (1 - am) * a1  # no force: the weighted acceleration vanishes
    v2 = v0 + h * gamma * a1 + h * ((1 - gamma) * a1 + gamma * a2)
    assert schemes.rebound(scheme) == pytest.approx(-v2 / v0)


def test_wilson_with_theta_1_is_linear_acceleration():
    for w, xi in ((0.5, 0.0), (3.0, 0.2), (math.inf, 0.0)):
        assert classical.WilsonTheta(1.0).amplification(w, xi) == pytest.approx(
            LINEAR.amplification(w, xi)
        )


def test_chung_hulbert_with_rho_0_has_houbolts_roots():
    for w in (0.2, 2.0, 20.0):
        assert spectral.principal_root(schemes.chung_hulbert(0), w) == pytest.approx(
            spectral.principal_root(HOUBOLT, w)
        )


def test_central_difference_is_newmark_with_vanishing_beta():
    for xi in (0.0, 0.2):
        assert spectral.principal_root(schemes.newmark(1e-12, 0.5), 1.1, xi) == pytest.approx(
            spectral.principal_root(CENTRAL, 1.1, xi)
        )


def test_an_oscillation_that_the_method_has_lost_has_no_period():
    assert math.isnan(spectral.period_elongation(CENTRAL, 2.1))
    assert math.isnan(spectral.numerical_damping(CENTRAL, 2.1))
    with pytest.raises(ValueError, match=r"xi = 1: must be at least 0 and below 1"):
        spectral.principal_root(AVERAGE, 0.1, 1.0)
    with pytest.raises(schemes.SchemeError, match="must be finite"):
        CENTRAL.amplification(math.inf)


def test_unconditional_stability_is_newmarks_known_condition():
    for beta in (0.2, 0.25, 0.26, 0.5):
        for gamma in (0.48, 0.5, 0.52, 0.6):
            expected = 2 * beta >= gamma >= 0.5
            assert schemes.is_unconditionally_stable(schemes.newmark(beta, gamma)) == expected


def test_unconditional_stability_is_paper_as_condition_for_second_order():
    for af in np.linspace(-0.3, 0.6, 10):
        for am in np.linspace(-0.7, 0.6, 14):
            expected = am <= af + 1e-9 and af <= 0.5 + 1e-9
            assert schemes.is_unconditionally_stable(schemes.generalized_alpha(af, am)) == expected


def test_unconditional_stability_is_an_infinite_limit_for_any_member():
    rng = np.random.default_rng(1)
    result = set()
    for _ in range(200):
        scheme = schemes.general(
            *rng.uniform(-1, 0.6, 2), rng.uniform(0.05, 1.5), rng.uniform(0.3, 1.8)
        )
        is_stable = schemes.is_unconditionally_stable(scheme)
        assert is_stable == math.isinf(spectral.stability_limit(scheme))
        result.add(is_stable)
    assert result == {True, False}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: schemes.newmark(0.0, 0.5), "beta = 0: must be above 0 in an implicit step"),
        (lambda: schemes.newmark(0.25, math.nan), "gamma = nan: must be between"),
        (lambda: schemes.hht(1.0), "alpha_f = 1: must be at least -1 and below 1"),
        (lambda: schemes.wbz(math.inf), "alpha_m = inf: must be at least -1 and below 1"),
        (lambda: schemes.generalized_alpha(-0.5, 0.5), "alpha_f - alpha_m = -1: must be above -1"),
        (lambda: schemes.chung_hulbert(1.1), "rho = 1.1: must be at least 0 and at most 1"),
        (lambda: schemes.energy_momentum_alpha_f(1.0), "alpha_m = 1: must be below 1"),
        (lambda: schemes.energy_momentum_beta(1.0, 0.0), "alpha_m = 1: must not be 1"),
        (lambda: schemes.newmark(1e300, 0.5), "beta = 1e+300: must be above 0"),
        (lambda: classical.WilsonTheta(1e200), "theta = 1e+200: must be above 0"),
        (lambda: classical.WilsonTheta(0.0), "theta = 0: must be above 0"),
    ],
)
def test_impossible_parameters_are_refused_in_one_line(make, message):
    with pytest.raises(schemes.SchemeError) as error:
        make()
    assert message in str(error.value)
    assert "\n" not in str(error.value)
