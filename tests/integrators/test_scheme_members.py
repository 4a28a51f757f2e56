"""Members of the family of integrators: identities, when they are stable, what is refused."""

import math

import pytest

from papers.integrators import classical, spectral
from papers.integrators import members as schemes

from .test_schemes import CENTRAL, HOUBOLT, LINEAR

# Paper B, (13): alpha_B, alpha_H.
EQUATION_13 = [(-0.5, 0.166667), (0, 0.414214), (0.2, 0.470691), (0.4, 0.497168), (0.5, 0.5)]


@pytest.mark.parametrize(("alpha_b", "alpha_h"), EQUATION_13)
def test_equations_8_and_12_together_give_13(alpha_b, alpha_h):
    """By (8), of the family, an impact keeps energy and momentum where (12) holds as well."""
    scheme = schemes.generalized_alpha(alpha_h, alpha_b)
    assert schemes.rebound(scheme) == pytest.approx(1, abs=1e-5)


def test_equation_14_is_moderate_dissipation():
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


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: schemes.newmark(0.0, 0.5), "beta = 0: must be above 0 in an implicit step"),
        (lambda: schemes.newmark(0.25, math.nan), "gamma = nan: must be between"),
        (lambda: schemes.hht(1.0), "alpha_f = 1: must be at least -1 and below 1"),
        (lambda: schemes.wbz(math.inf), "alpha_m = inf: must be at least -1 and below 1"),
        (lambda: schemes.generalized_alpha(-0.5, 0.5), "alpha_f - alpha_m = -1: must be above -1"),
        (lambda: schemes.chung_hulbert(1.1), "rho = 1.1: must be at least 0 and at most 1"),
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
