"""Corners of forces: the sums of samples that have them, Floquet multipliers across them, and the
bifurcations that are located by these."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.integrate
import scipy.optimize
from rotor_fmu.model.periodic import arclength, bifurcation_search
from rotor_fmu.model.periodic.arclength import ContinuationSteps, CurvePoint
from rotor_fmu.model.periodic.floquet import multipliers
from rotor_fmu.model.periodic.force_corners import SampledOrbit, crossings
from rotor_fmu.model.periodic.fourier import derivative
from rotor_fmu.model.periodic.linear_structure import CondensedMachine

import rotor_fmu as rf

from .machines import BETA, CLEARANCE, OMEGA, jeffcott, sagging

STIFFNESS = BETA * OMEGA**2  # of the contact
DELTA_C = 2e-7  # of its damping


@pytest.mark.parametrize("c", [0.0, 50.0])
@pytest.mark.parametrize("offset", [0.0, 0.2, 0.37])
def test_coefficients_of_a_force_with_corners_are_its_integrals(offset, c):
    """Of a journal that goes to and fro through its clearance, wherever a corner lies between two
    samples; with damping the wall lets go of it before the gap opens."""
    laws = CondensedMachine(jeffcott(mu=0.0, c=c).rotor).laws
    n, H, amplitude = 512, 10, 1.5 * CLEARANCE
    phase = offset * 2 * np.pi / n
    d = np.zeros((2 * H + 1, 2))
    d[1:3, 0] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    at = SampledOrbit(laws, d, np.zeros((2 * H + 1, 0)), 100.0, n, derivative(d))
    seen = at.spectrum(laws.forces(at.d, at.v, at.states, 100.0).force[:, 0], H)
    edge, full = (np.arccos((CLEARANCE + depth) / amplitude) for depth in (0.0, DELTA_C))

    def press(t):
        delta, rate = amplitude * np.cos(t) - CLEARANCE, -100.0 * amplitude * np.sin(t)
        return STIFFNESS * delta + c * min(1.0, delta / DELTA_C) * rate

    last = scipy.optimize.brentq(press, 0.0, full, xtol=1e-14) if press(full) < 0 else edge
    for k in range(H + 1):
        whole = sum(
            scipy.integrate.quad(
                lambda t, k=k: press(t) * np.exp(-1j * k * t), a, b, epsabs=1e-10, complex_func=True
            )[0]
            for a, b in [(-edge, -full), (-full, last)]
        )
        expected = -(1 / np.pi) * whole * (k % 2) * np.exp(-1j * k * phase)
        assert abs(seen[k] - expected) < 2e-7 * STIFFNESS * amplitude


def test_a_corner_lies_where_its_gap_is_zero_although_the_samples_are_few():
    """To a share of the interval well below that beside a corner at which a step looks."""
    n, orders = 96, np.arange(1, 24)

    def gap(t):
        return np.sin(np.multiply.outer(t, orders) + orders**2) @ orders**-0.7

    def gap_at(cell, share):
        return gap(2 * np.pi / n * (cell + share))[:, None]

    cell, share, _ = crossings(
        SimpleNamespace(corner_owner=np.zeros(1, int)), gap_at(np.arange(-1, n + 2), 0.0), gap_at
    )
    at = cell + share
    rates = gap(2 * np.pi / n * (at + 1e-6)) - gap(2 * np.pi / n * (at - 1e-6))
    assert len(at) > 10
    assert np.abs(gap_at(cell, share)[:, 0] / rates * 2e-6).max() < 1e-9


def test_multipliers_do_not_depend_on_the_steps_although_a_contact_opens_and_closes(doubled):
    of_doubled = CondensedMachine(sagging().rotor), doubled.branches[0].points[::4]
    assert_same_multipliers(*of_doubled)


def test_nor_where_a_damped_contact_lets_go_before_it_opens():
    found = rf.response(sagging(c=20.0), speed=(240.0, 280.0), harmonics=40)
    assert_same_multipliers(CondensedMachine(sagging(c=20.0).rotor), found.points[::2])


def assert_same_multipliers(machine, points):
    for point in points:
        few, many = (
            np.sort(np.abs(multipliers(machine, point.orbit, steps).values)) for steps in (0, 1000)
        )
        assert few == pytest.approx(many, rel=1e-6)


def test_each_located_bifurcation_has_its_multiplier(doubled):
    """A doubling's is -1, a fold's +1 as nearly as the harmonics give the fold."""
    kinds = [b.kind for b in doubled.bifurcations]
    assert set(kinds) == {"period doubling", "fold"}
    for b in doubled.bifurcations:
        if b.kind == "fold":
            assert abs(b.multiplier - 1) < 1e-3
        else:
            assert abs(b.multiplier + 1) < 2e-6


class _Circle:
    """x^2 + lambda^2 = 1."""

    tolerance, damped_beyond = 1e-12, 1.0

    def residual(self, x, value):
        return x**2 + value**2 - 1.0

    def linearized_with_parameter(self, x, value):
        return self.residual(x, value), np.array([2.0 * x]), np.array([2.0 * value])


def test_a_step_as_long_along_the_tangent_as_the_last_one_was_comes_to_its_end():
    """So that a function along the step, whose sign changes just before the end, is continuous."""
    circle = _Circle()
    start = arclength.with_tangent(circle, np.array([1.0]), 0.0, 1.0)
    trace = arclength.trace(circle, start, 1.0, -2.0, 2.0, ContinuationSteps())
    points = [point for point, _ in itertools.islice(trace, 20)]
    for a, b in itertools.pairwise(points):
        length = a.tangent @ (b.x - a.x) + a.tangent_value * (b.value - a.value)
        again = arclength.step_along(circle, a, float(length), 1.0)
        assert abs(again.value - b.value) < 1e-6 * abs(b.value - a.value)


class _Line:
    """x = 0 over lambda from 0 to 1."""

    tolerance, damped_beyond, is_autonomous = 1e-12, 1.0, False
    parameter = SimpleNamespace(scale=1.0)

    def linearized_with_parameter(self, x, value):
        return x, np.eye(1), np.zeros(1)

    def fix_phase(self, x):
        """Do nothing."""

    def split(self, x, value):
        return SimpleNamespace(parameter=value)


def _motion(multipliers_at, end):
    return SimpleNamespace(multipliers=multipliers_at(None, end), orbit=_Line().split(0, end.value))


def test_bifurcations_that_leave_the_number_of_unstable_multipliers_unchanged_are_located(
    monkeypatch,
):
    """In one step two real multipliers leave the circle at -1, while a pair enters it."""

    def multipliers_at(_, point):
        pair = (1.0 - 0.1 * (point.value - 0.5)) * np.exp([1.0j, -1.0j])
        values = np.array([-1.0 - (point.value - 0.2), -1.0 - (point.value - 0.7), *pair])
        return values[np.argsort(-np.abs(values), kind="stable")]

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    seen = bifurcation_search.bifurcations_between(_Line(), *ends, *motions)
    assert [b.kind for b in seen] == ["period doubling", "Neimark-Sacker", "period doubling"]
    assert [b.point.value for b in seen] == pytest.approx([0.2, 0.5, 0.7], abs=1e-4)


def _dips(value):
    """A pair that comes into the circle for a while."""
    return [1.0 + 0.2 * ((value - 0.8) ** 2 - 0.15**2)]


def _change_places(value):
    """A pair that comes into the circle before another one leaves it."""
    return [1.0 - 0.02 * (value - 0.3), np.exp(1.0j) * (1.0 + 0.02 * (value - 0.7))]


def _touches(value):
    """A pair that a contact throws out, which comes back."""
    return [1.0 - 0.1 * (value - 0.6) if value > 0.3 else 0.97]


@pytest.mark.parametrize(
    ("pairs", "kinds", "values"),
    [
        (_dips, ["Neimark-Sacker"] * 2, [0.65, 0.95]),
        (_change_places, ["Neimark-Sacker"] * 2, [0.3, 0.7]),
        (_touches, ["grazing", "Neimark-Sacker"], [0.3, 0.6]),
    ],
)
def test_two_bifurcations_of_which_the_second_undoes_the_first_are_located(
    monkeypatch, pairs, kinds, values
):
    """Although at both ends of the step as many multipliers of each kind are outside."""

    def multipliers_at(_, point):
        each = np.multiply.outer(pairs(point.value), np.exp([1.0j, -1.0j]))
        each[..., 1] = each[..., 0].conj()
        return each.ravel()[np.argsort(-np.abs(each.ravel()), kind="stable")]

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    has_contact = pairs is _touches
    monkeypatch.setattr(
        bifurcation_search, "_touches", lambda _, p: np.array([has_contact and p.parameter > 0.3])
    )
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    seen = bifurcation_search.bifurcations_between(_Line(), *ends, *motions)
    assert [b.kind for b in seen] == kinds
    assert [b.point.value for b in seen] == pytest.approx(values, abs=1e-4)


def test_doublings_on_both_sides_of_where_a_wall_is_touched_once_more_are_located(monkeypatch):
    """Up to there a multiplier moves as a root, into the circle, and more slowly out of it again;
    one far from the circle, which moves more, is not followed."""
    looks = []

    def multipliers_at(_, point):
        looks.append(point.value)
        beyond = point.value - 0.55
        size = 0.97 + (0.65 * np.sqrt(-beyond) if beyond < 0 else 0.5 * beyond)
        return np.array([-size, 0.2 - 0.1 * point.value])

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    monkeypatch.setattr(
        bifurcation_search, "_touches", lambda _, orbit: np.array([2 + (orbit.parameter > 0.55)])
    )
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    seen = bifurcation_search.bifurcations_between(_Line(), *ends, *motions)
    assert [b.kind for b in seen] == ["period doubling"] * 2
    places = 0.55 - (0.03 / 0.65) ** 2, 0.61
    assert [b.point.value for b in seen] == pytest.approx(places, abs=1e-4)
    looks.clear()
    motions = [SimpleNamespace(multipliers=m.multipliers[1:], orbit=m.orbit) for m in motions]
    assert bifurcation_search.bifurcations_between(_Line(), *ends, *motions) == []
    assert looks == []


@pytest.mark.parametrize(
    ("half_sum", "product", "kinds", "values"),
    [
        (  # both are outside when they meet, and one comes in again
            lambda t: 0.9 + 0.4 * t,
            lambda t: 0.9 + 0.4 * t + 0.3 * t * (1.0 - t),
            ["Neimark-Sacker", "period doubling"],
            [0.152873, 0.434259],
        ),
        (  # both are inside when they meet, and one goes out and comes in again
            lambda t: 0.79 + 0.0778 * t + 0.3 * t * (1.0 - t),
            lambda t: 0.7225 + 0.0291 * t,
            ["period doubling"] * 2,
            [0.246238, 0.964595],
        ),
    ],
)
def test_doublings_of_a_pair_that_meets_on_the_real_axis_are_located(
    monkeypatch, half_sum, product, kinds, values
):
    """Of which the ends of the step show one or none, and other small multipliers at one end."""

    def multipliers_at(_, point):
        roots = np.roots([1.0, 2.0 * half_sum(point.value), product(point.value)])
        return np.append(
            roots[np.argsort(-np.abs(roots), kind="stable")], [0.0] * (point.value > 0.5)
        )

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    monkeypatch.setattr(bifurcation_search, "_touches", lambda *_: np.array([True]))
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    seen = bifurcation_search.bifurcations_between(_Line(), *ends, *motions)
    assert [b.kind for b in seen] == kinds
    assert [b.point.value for b in seen] == pytest.approx(values, abs=1e-4)


@pytest.mark.parametrize("inside", [[0.3, 0.3], [0.9j, -0.9j]])
def test_multipliers_that_jump_past_the_circle_are_a_grazing_of_any_kind(monkeypatch, inside):
    """Such as a pair, where a contact begins: no quasi-periodic motion begins there."""
    outside = np.array([0.8 + 0.8j, 0.8 - 0.8j])

    def multipliers_at(_, point):
        return outside if point.value > 0.3 else np.array(inside)

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    (seen,) = bifurcation_search.bifurcations_between(_Line(), *ends, *motions)
    assert seen.kind == "grazing"
    assert np.isnan(seen.multiplier)
    assert seen.point.value == pytest.approx(0.3, abs=1e-8)


def test_a_bifurcation_in_a_step_hardly_longer_than_the_error_of_its_points_is_no_grazing(
    monkeypatch,
):
    """Its multiplier is as uncertain as the points, and seems to jump."""
    line, error = _Line(), 0.02
    line.tolerance = error

    def multipliers_at(_, point):
        beyond = point.value - 0.5
        return np.array([-1.0 - 0.1 * (beyond + error * np.sign(beyond))])

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    (seen,) = bifurcation_search.bifurcations_between(line, *ends, *motions)
    assert seen.kind == "period doubling"
    assert seen.point.value == pytest.approx(0.5, abs=error)


@pytest.mark.parametrize(("slope", "kinds"), [(0.0, []), (1.0, ["branch point"])])
def test_a_branch_passes_where_the_equations_are_singular_not_only_a_multiplier_by_few_harmonics(
    monkeypatch, slope, kinds
):
    """That passes 1 beside a fold."""

    def multipliers_at(_, point):
        return np.array([point.value - 0.5 + 1.0])

    line = _Line()
    line.linearized = lambda x, value: (
        x,
        np.array([[0.5 * (1.0 - slope) + slope * (value - 0.5)]]),
    )
    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    seen = bifurcation_search.bifurcations_between(line, *ends, *motions)
    assert [b.kind for b in seen] == kinds


def test_a_bifurcation_lies_in_its_step_although_newtons_method_leads_far_away(monkeypatch):
    """As beside a corner, where another branch is near."""

    def multipliers_at(_, point):
        return np.array([0.5 - point.value - 1.0])

    monkeypatch.setattr(bifurcation_search, "_multipliers", multipliers_at)
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, located: located)
    far = CurvePoint(np.full(1, 3.0), 0.5 + 1e-6, np.zeros(1), 1.0)
    monkeypatch.setattr(arclength, "correct", lambda *_: far)
    ends = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]
    motions = [_motion(multipliers_at, end) for end in ends]
    (seen,) = bifurcation_search.bifurcations_between(_Line(), *ends, *motions)
    assert seen.point.x == 0.0


@pytest.mark.slow
def test_with_more_harmonics_a_folds_multiplier_is_nearer_to_one():
    options = {"speed": (240.0, 400.0), "branches": True, "harmonics": 60}
    off = []
    for share, step in ((1e-4, 0.1), (1e-6, 0.03)):
        result = rf.response(sagging(), share=share, step=step, **options)
        off.append(max(abs(b.multiplier - 1) for b in result.bifurcations if b.kind == "fold"))
    assert off[0] < 1e-3
    assert off[1] < 3e-5


def test_a_torus_begins_where_a_pair_of_multipliers_leaves_the_circle(curve, over_friction):
    (torus,) = [b for b in over_friction.bifurcations if b.kind == "Neimark-Sacker"]
    assert abs(torus.multiplier) == pytest.approx(1.0, abs=2e-6)
    assert abs(torus.multiplier.imag) > 0.1
    (fold,) = [b for b in curve.bifurcations if b.kind == "fold"]
    assert abs(fold.multiplier - 1) < 1e-6
    (grazing,) = [b for b in curve.bifurcations if b.kind == "grazing"]
    assert np.isnan(grazing.multiplier)
