"""Corners of forces: the sums of samples that have them, Floquet multipliers across them, and the
bifurcations that are located by these."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.integrate
import scipy.optimize
from rotor_fmu.model.periodic import arclength
from rotor_fmu.model.periodic.arclength import ContinuationEquations, ContinuationSteps
from rotor_fmu.model.periodic.floquet import multipliers
from rotor_fmu.model.periodic.force_corners import SampledOrbit, crossings
from rotor_fmu.model.periodic.fourier import basis
from rotor_fmu.model.periodic.harmonic_count import transferred
from rotor_fmu.model.periodic.linear_structure import CondensedMachine
from rotor_fmu.model.periodic.newton import NotConverged, solve

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
    at = SampledOrbit(laws, d, np.zeros((2 * H + 1, 0)), 100.0, n)
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


@pytest.mark.parametrize("c", [0.0, 50.0])
@pytest.mark.parametrize("turned", [1.0, 1.5])
def test_an_orbit_sampled_as_another_one_is_as_if_sampled_anew(turned, c):
    """Faster along the same way, on which a damped wall lets go elsewhere, or along another."""
    laws = CondensedMachine(jeffcott(mu=0.0, c=c).rotor).laws
    n, H = 512, 3
    d, states = np.zeros((2 * H + 1, 2)), np.zeros((2 * H + 1, 0))
    d[1, 0] = 1.5 * CLEARANCE
    before = SampledOrbit(laws, d, states, 100.0, n)
    for way, omega in ((turned * d, 100.0), (turned * d, 200.0)):
        again, anew = before.at(laws, way, states, omega), SampledOrbit(laws, way, states, omega, n)
        assert len(anew.owner) > 1
        for one, other in ((again.d, anew.d), (again.v, anew.v), (again.owner, anew.owner)):
            assert np.array_equal(one, other)
        values = np.ones((len(anew.d), 1))
        assert np.array_equal(again.spectrum(values, H), anew.spectrum(values, H))


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


@pytest.mark.parametrize("phase", np.linspace(0.0, 0.06, 5))
def test_a_damped_contact_lets_go_where_it_does_to_rounding(phase):
    """Else steps that end there may begin on the wrong side of it."""
    laws, c, omega = CondensedMachine(jeffcott(mu=0.0, c=50.0).rotor).laws, 50.0, 100.0
    d = np.zeros((3, 2))
    d[1:, 0] = 1.5 * CLEARANCE * np.array([np.cos(phase), np.sin(phase)])

    def gaps(times):
        value, slope = basis(1, times)
        return laws.corner_gaps(value @ d, omega * slope @ d)

    h = 2 * np.pi / 512
    cell, share, _ = crossings(laws, gaps(h * np.arange(-1, 514)), lambda c, x: gaps(h * (c + x)))

    def pushes(angle):
        moved = 1.5 * CLEARANCE * np.exp(1j * angle)
        return moved.real - CLEARANCE - c * omega * moved.imag / STIFFNESS

    expected = scipy.optimize.brentq(pushes, 0.0, 1.5, xtol=1e-16) + phase
    for turned in (expected, expected + np.pi):
        assert np.abs(h * (cell + share) - turned).min() < 1e-13


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


class _Circle(ContinuationEquations):
    """x^2 + lambda^2 = 1."""

    tolerance, damped_beyond, scale, difference = 1e-12, 1.0, 1.0, 1e-7
    is_central = True

    def linearized(self, x, value):
        return x**2 + value**2 - 1.0, np.array([2.0 * x])

    def seen(self, x, value, direction):
        return x, direction[:-1]


def test_a_step_as_long_along_the_tangent_as_the_last_one_was_comes_to_its_end():
    """So that a function along the step, whose sign changes just before the end, is continuous."""
    circle = _Circle()
    start = arclength.with_tangent(circle, np.array([1.0]), 0.0, 1.0)
    trace = arclength.trace(circle, start, -2.0, 2.0, ContinuationSteps())
    points = [point for point, _ in itertools.islice(trace, 20)]
    for a, b in itertools.pairwise(points):
        length = a.tangent @ (b.x - a.x) + a.tangent_value * (b.value - a.value)
        again = arclength.step_along(circle, a, float(length))
        assert abs(again.value - b.value) < 1e-6 * abs(b.value - a.value)


class _Bend(ContinuationEquations):
    """lambda = x - A tanh((x - 1) / w), an S-bend about (1, 1) where A > w."""

    scale, difference, is_central = 1.0, 1e-7, True

    def __init__(self, w, ratio):
        self.w, self.A = w, ratio * w

    def linearized(self, x, value):
        bend = np.tanh((x - 1.0) / self.w)
        slope = 1.0 - self.A / self.w * (1.0 - bend**2)
        return x - self.A * bend - value, np.array([slope])


@pytest.mark.parametrize(("w", "ratio"), [(0.02, 1.5), (0.005, 1.5), (0.005, 3.0), (0.1, 0.5)])
def test_a_step_is_shortened_where_it_would_pass_over_an_s_bend(w, ratio):
    """Down to a twentieth of it; a bend without folds of that size takes few steps."""
    bend = _Bend(w, ratio)
    start = arclength.with_tangent(bend, solve(bend, np.zeros(1), 0.0), 0.0, 1.0)
    trace = arclength.trace(bend, start, 0.0, 2.0, ContinuationSteps(longest=0.1))
    points = [point for point, _ in trace]
    ahead = [point.tangent_value > 0 for point in points]
    assert np.count_nonzero(np.diff(ahead)) == (2 if ratio > 1 else 0)
    assert len(points) < 70
    assert points[-1].value == 2.0


def test_the_step_to_the_end_of_the_range_passes_over_no_s_bend():
    """The range ends just behind one."""
    bend = _Bend(0.02, 1.5)
    start = arclength.with_tangent(bend, solve(bend, np.zeros(1), 0.0), 0.0, 1.0)
    trace = arclength.trace(bend, start, 0.0, 1.01, ContinuationSteps(longest=0.1))
    points = [point for point, _ in trace]
    assert np.count_nonzero(np.diff([point.tangent_value > 0 for point in points])) == 2
    assert points[-1].value == 1.01


class _Parabola(ContinuationEquations):
    """lambda = 1 - (x - at)^2, with a fold at x = at."""

    scale, difference, is_central = 1.0, 1e-7, True

    def __init__(self, at):
        self.at = at

    def linearized(self, x, value):
        return 1.0 - (x - self.at) ** 2 - value, np.array([-2.0 * (x - self.at)])


def test_a_point_just_before_a_fold_is_before_it_by_other_equations_too():
    """By which the fold lies a little earlier: what is nearest to the point is past it."""
    point = arclength.with_tangent(_Parabola(0.0), np.array([-1e-3]), 1.0 - 1e-6, 1.0)
    earlier = _Parabola(-3e-3)
    nearest = arclength.correct(earlier, point.x, point.value, point.direction)
    assert nearest.tangent_value < 0 < point.tangent_value
    moved = transferred(earlier, point.x, point, point.direction)
    assert moved.tangent_value > 0
    assert moved.x[0] < earlier.at
    assert moved.value == pytest.approx(1.0 - (moved.x[0] - earlier.at) ** 2, abs=1e-12)
    with pytest.raises(NotConverged):
        transferred(_Parabola(-0.05), point.x, point, point.direction)


@pytest.mark.slow
def test_with_more_harmonics_a_folds_multiplier_is_nearer_to_one():
    options = {"speed": (240.0, 400.0), "branches": True, "harmonics": 60}
    off = []
    for share, step in ((1e-4, 0.1), (1e-6, 0.03)):
        result = rf.response(sagging(), share=share, step=step, **options)
        off.append(max(abs(b.multiplier - 1) for b in result.bifurcations if b.kind == "fold"))
    assert off[0] < 1e-3
    assert off[1] < 3e-5


def test_bifurcations_are_those_of_the_motion_with_enough_harmonics():
    """Also in a step that ends with twice as many as it began with: by those few a torus ends in it
    and the period doubles. Own integration and shooting have a pair of multipliers of 1.11 there,
    which jumps into the circle where the wall is touched once more, at 76.142 rad/s."""
    own = {"kyy": 1.5 * OMEGA**2, "cxx": 2.0, "cyy": 2.0}
    shares = (1, 0.01), (2, 0.98), (3, 0.01)  # of `bearings`
    springs = {f"linear_bearing[{i}].{n}": share * own[n] for i, share in shares for n in own}
    rotor = sagging(k=10 * OMEGA**2, mu=0.05, e=0.5)
    found = rf.response(rotor, speed=(75.0, 77.0), parameters=springs, share=0.01)
    assert found.points[0].orbit.H < found.points[-1].orbit.H
    kinds = [b.kind for b in found.bifurcations]
    assert kinds == ["Neimark-Sacker", "grazing", "period doubling"]
    assert found.bifurcations[1].value == pytest.approx(76.142, abs=0.02)


def test_a_torus_begins_where_a_pair_of_multipliers_leaves_the_circle(curve, over_friction):
    (torus,) = [b for b in over_friction.bifurcations if b.kind == "Neimark-Sacker"]
    assert abs(torus.multiplier) == pytest.approx(1.0, abs=2e-6)
    assert abs(torus.multiplier.imag) > 0.1
    (fold,) = [b for b in curve.bifurcations if b.kind == "fold"]
    assert abs(fold.multiplier - 1) < 1e-6
    (grazing,) = [b for b in curve.bifurcations if b.kind == "grazing"]
    assert np.isnan(grazing.multiplier)


class _Corner(ContinuationEquations):
    """lambda = 2 |x|, and so many more unknowns that are 0."""

    tolerance, damped_beyond, scale = 1e-12, 1.0, 1.0

    def __init__(self, more):
        self.more = more

    def residual(self, x, value):
        return np.append(value - 2.0 * abs(x[0]), x[1:])

    def linearized(self, x, value):
        return self.residual(x, value), np.diag([-2.0 * np.sign(x[0]), *np.ones(self.more)])

    def linearized_with_parameter(self, x, value):
        return *self.linearized(x, value), np.append(1.0, np.zeros(self.more))

    def seen(self, x, value, direction):
        return x[:0], x[:0]


def test_a_curve_doubles_back_in_a_corner_with_other_unknowns_at_each_point():
    corners = [_Corner(0), _Corner(1)]
    point = arclength.with_tangent(corners[0], np.array([1.0]), 2.0, -1.0)
    trace = arclength.trace(corners[0], point, -1.0, 3.0, ContinuationSteps())
    point, values = next(trace)[0], []
    for i in range(1, 1000):
        x, tangent = (np.append(each[0], np.zeros(i % 2)) for each in (point.x, point.tangent))
        point = point._replace(x=x, tangent=tangent, curvature=np.zeros(0))
        values.append((point.x[0], point.value))
        try:
            point, _ = trace.send((corners[i % 2], point))
        except StopIteration:
            break
    assert values[-1] == pytest.approx((-1.5, 3.0))


def test_beside_a_corner_a_tangent_that_is_wrong_does_not_lead_back():
    """As one is that a difference across the corner gave; how far from the way to its point it lies
    is known."""
    line, turn = _Corner(0), 0.1
    point = arclength.with_tangent(line, np.array([1.0]), 2.0, -1.0)
    x, value = point.direction
    tangent = np.array([x * np.cos(turn) - value * np.sin(turn)])
    wrong = point._replace(tangent=tangent, tangent_value=x * np.sin(turn) + value * np.cos(turn))
    bend = 1.0 - point.cosine(wrong)
    ahead = arclength._beyond_corner(line, wrong, bend, ContinuationSteps())
    assert ahead.value < point.value


class _SampledTouch(ContinuationEquations):
    """x[0] follows lambda, but for a touch that is seen at one sample after another; what it does
    to x[1] is no part of the motion."""

    scale, difference = 1.0, 1e-7

    def linearized(self, x, value):
        touch = np.floor(200 * value)
        return x - [value + 1e-4 * touch, 1e-3 * touch], np.eye(2)

    def of_motion(self, way):
        return way[[0, 2]]


def test_a_touch_that_moves_from_sample_to_sample_does_not_shorten_the_steps():
    equations, steps = _SampledTouch(), ContinuationSteps(initial=0.05, longest=0.1)
    start = arclength.with_tangent(equations, np.zeros(2), 0.0, 1.0)
    points = [p for p, _ in arclength.trace(equations, start, 0.0, 1.0, steps)]
    assert points[-1].value == 1.0
    assert len(points) < 60
