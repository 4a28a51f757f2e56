"""Bifurcations in one step of a curve whose multipliers are given."""

from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.periodic import arclength, bifurcation_search, newton
from rotor_fmu.model.periodic.arclength import CurvePoint


class _Line:
    """x = 0 over lambda from 0 to 1."""

    tolerance, damped_beyond, scale, is_autonomous = 1e-12, 1.0, 1.0, False
    solve_linear = staticmethod(newton.solve_linear)

    def linearized_with_parameter(self, x, value):
        return x, np.eye(1), np.zeros(1)

    def fix_phase(self, x):
        """Do nothing."""

    def split(self, x, value):
        return SimpleNamespace(parameter=value)


ENDS = [CurvePoint(np.zeros(1), value, np.zeros(1), 1.0) for value in (0.0, 1.0)]


class _Turn(_Line):
    """lambda = 1 - x^2, with a fold at 0, where another branch passes at x = 0.3."""

    def linearized_with_parameter(self, x, value):
        return 1.0 - x**2 - value, np.array([-2.0 * x]), -np.ones(1)

    def linearized(self, x, value):
        return 1.0 - x**2 - value, np.array([-2.0 * x * (0.3 - x)])


class _Fork(_Turn):
    """The same curve, of motions x and -x, which begin at lambda = 1 on the branch x = 0."""

    def linearized_with_parameter(self, x, value):
        return x * (1.0 - x**2 - value), np.array([1.0 - 3.0 * x**2 - value]), -x

    def linearized(self, x, value):
        return self.linearized_with_parameter(x, value)[:2]


def _on_turn(x):
    """Return the point of this curve at x."""
    tangent = np.array([1.0, -2.0 * x]) / np.hypot(1.0, 2.0 * x)
    return CurvePoint(np.array([x]), 1.0 - x**2, tangent[:1], tangent[1])


class _Bend(_Line):
    """lambda = 0 up to x = 0, and x beyond."""

    def linearized_with_parameter(self, x, value):
        return value - np.maximum(x, 0.0), np.array([-1.0 * (x > 0.0)]), np.ones(1)


@pytest.fixture
def located(monkeypatch):
    """Bifurcations of a line, in one step from 0 to 1, along which it has these multipliers and
    touches its walls so often."""
    monkeypatch.setattr(bifurcation_search, "_bifurcation", lambda _, found: found)

    def search(multipliers_at, touches=lambda _: 0, line=None, ends=ENDS):
        monkeypatch.setattr(bifurcation_search, "_multipliers", lambda _, p: multipliers_at(p))
        monkeypatch.setattr(
            bifurcation_search, "_touches", lambda _, orbit: np.array([touches(orbit.parameter)])
        )
        line = line or _Line()
        motions = [
            SimpleNamespace(multipliers=multipliers_at(end), orbit=line.split(0, end.value))
            for end in ends
        ]
        return bifurcation_search.bifurcations_between(line, *ends, *motions)

    return search


def test_bifurcations_that_leave_the_number_of_unstable_multipliers_unchanged_are_located(
    located,
):
    """In one step two real multipliers leave the circle at -1, while a pair enters it."""

    def multipliers_at(point):
        pair = (1.0 - 0.1 * (point.value - 0.5)) * np.exp([1.0j, -1.0j])
        values = np.array([-1.0 - (point.value - 0.2), -1.0 - (point.value - 0.7), *pair])
        return values[np.argsort(-np.abs(values), kind="stable")]

    seen = located(multipliers_at)
    assert [b.kind for b in seen] == ["period doubling", "Neimark-Sacker", "period doubling"]
    assert [b.point.value for b in seen] == pytest.approx([0.2, 0.5, 0.7], abs=1e-4)


def _dips(value):
    """A pair that comes into the circle for a while."""
    return [1.0 + 0.2 * ((value - 0.8) ** 2 - 0.15**2)]


def _change_places(value):
    """A pair that comes into the circle before another one leaves it."""
    return [1.0 - 0.02 * (value - 0.3), np.exp(1.0j) * (1.0 + 0.02 * (value - 0.7))]


def _thrown_out(value):
    """A pair that a contact throws out, which comes back."""
    return [1.0 - 0.1 * (value - 0.6) if value > 0.3 else 0.97]


def _thrown_far(value):
    """One that it throws out from far within, where it is at the end as well."""
    return [1.0 - 0.3 * (value - 0.6) if value > 0.3 else 0.88]


@pytest.mark.parametrize(
    ("pairs", "kinds", "values"),
    [
        (_dips, ["Neimark-Sacker"] * 2, [0.65, 0.95]),
        (_change_places, ["Neimark-Sacker"] * 2, [0.3, 0.7]),
        (_thrown_out, ["grazing", "Neimark-Sacker"], [0.3, 0.6]),
        (_thrown_far, ["grazing", "Neimark-Sacker"], [0.3, 0.6]),
    ],
)
def test_two_bifurcations_of_which_the_second_undoes_the_first_are_located(
    located, pairs, kinds, values
):
    """Although at both ends of the step as many multipliers of each kind are outside."""

    def multipliers_at(point):
        each = np.multiply.outer(pairs(point.value), np.exp([1.0j, -1.0j]))
        each[..., 1] = each[..., 0].conj()
        return each.ravel()[np.argsort(-np.abs(each.ravel()), kind="stable")]

    has_contact = pairs in (_thrown_out, _thrown_far)
    seen = located(multipliers_at, lambda value: has_contact and value > 0.3)
    assert [b.kind for b in seen] == kinds
    assert [b.point.value for b in seen] == pytest.approx(values, abs=1e-4)


def test_doublings_on_both_sides_of_where_a_wall_is_touched_once_more_are_located(located):
    """Up to there a multiplier moves as a root, into the circle, and more slowly out of it again;
    one far from the circle, which moves more, is not followed."""

    def multipliers_at(point):
        beyond = point.value - 0.55
        size = 0.97 + (0.65 * np.sqrt(-beyond) if beyond < 0 else 0.5 * beyond)
        return np.array([-size, *far(point)])

    looks = []

    def far(point):
        looks.append(point.value)
        return np.array([0.2 - 0.1 * point.value])

    def touches(value):
        return 2 + (value > 0.55)

    seen = located(multipliers_at, touches)
    assert [b.kind for b in seen] == ["period doubling"] * 2
    places = 0.55 - (0.03 / 0.65) ** 2, 0.61
    assert [b.point.value for b in seen] == pytest.approx(places, abs=1e-4)
    looks.clear()
    assert located(far, touches) == []
    assert looks == [0.0, 1.0]  # the ends of the step


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
    located, half_sum, product, kinds, values
):
    """Of which the ends of the step show one or none, and other small multipliers at one end."""

    def multipliers_at(point):
        roots = np.roots([1.0, 2.0 * half_sum(point.value), product(point.value)])
        return np.append(
            roots[np.argsort(-np.abs(roots), kind="stable")], [0.0] * (point.value > 0.5)
        )

    seen = located(multipliers_at, lambda _: 1)
    assert [b.kind for b in seen] == kinds
    assert [b.point.value for b in seen] == pytest.approx(values, abs=1e-4)


def test_a_fold_does_not_hide_a_branch_point_in_its_step(located):
    """One multiplier goes out of the circle at the fold, and another one comes in at 1."""

    def multipliers_at(point):
        return np.sort([1.0 + 0.2 * point.x[0], 1.3 - point.x[0]])[::-1]

    seen = located(multipliers_at, line=_Turn(), ends=[_on_turn(-0.2), _on_turn(0.5)])
    assert [b.kind for b in seen] == ["fold", "branch point"]
    assert [b.point.x[0] for b in seen] == pytest.approx([0.0, 0.3], abs=1e-4)


def test_a_fold_is_located_although_both_ends_of_its_step_have_one_value(located):
    ends = [_on_turn(-0.2), _on_turn(0.2)]
    (seen,) = located(lambda point: np.array([1.0 + 0.2 * point.x[0]]), line=_Turn(), ends=ends)
    assert seen.kind == "fold"
    assert seen.point.x[0] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("end", [0.2, 0.5])
def test_where_motions_that_break_a_symmetry_meet_is_a_branch_point_no_fold(located, end):
    """They are stable on both sides, and the machine does not jump."""
    ends = [_on_turn(-0.2), _on_turn(end)]
    (seen,) = located(lambda point: np.exp(-(point.x**2)), line=_Fork(), ends=ends)
    assert (seen.kind, seen.multiplier) == ("branch point", pytest.approx(1.0, abs=1e-6))
    assert seen.point.value == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("inside", [[0.3, 0.3], [0.9j, -0.9j]])
def test_multipliers_that_jump_past_the_circle_are_a_grazing_of_any_kind(located, inside):
    """Such as a pair, where a contact begins: no quasi-periodic motion begins there."""
    outside = np.array([0.8 + 0.8j, 0.8 - 0.8j])

    def multipliers_at(point):
        return outside if point.value > 0.3 else np.array(inside)

    (seen,) = located(multipliers_at)
    assert seen.kind == "grazing"
    assert np.isnan(seen.multiplier)
    assert seen.point.value == pytest.approx(0.3, abs=1e-8)


def test_a_bifurcation_in_a_step_hardly_longer_than_the_error_of_its_points_is_no_grazing(
    located,
):
    """Its multiplier is as uncertain as the points, and seems to jump."""
    line, error = _Line(), 0.02
    line.tolerance = error

    def multipliers_at(point):
        beyond = point.value - 0.5
        return np.array([-1.0 - 0.1 * (beyond + error * np.sign(beyond))])

    (seen,) = located(multipliers_at, line=line)
    assert seen.kind == "period doubling"
    assert seen.point.value == pytest.approx(0.5, abs=error)


@pytest.mark.parametrize(("slope", "kinds"), [(0.0, []), (1.0, ["branch point"])])
def test_a_branch_passes_where_the_equations_are_singular_not_only_a_multiplier_by_few_harmonics(
    located, slope, kinds
):
    """That passes 1 beside a fold."""

    def multipliers_at(point):
        return np.array([point.value - 0.5 + 1.0])

    line = _Line()
    line.linearized = lambda x, value: (
        x,
        np.array([[0.5 * (1.0 - slope) + slope * (value - 0.5)]]),
    )
    seen = located(multipliers_at, line=line)
    assert [b.kind for b in seen] == kinds


def test_a_bifurcation_lies_in_its_step_although_newtons_method_leads_far_away(
    located, monkeypatch
):
    """As beside a corner, where another branch is near."""

    def multipliers_at(point):
        return np.array([0.5 - point.value - 1.0])

    far = CurvePoint(np.full(1, 3.0), 0.5 + 1e-6, np.zeros(1), 1.0)
    monkeypatch.setattr(arclength, "correct", lambda *_: far)
    (seen,) = located(multipliers_at)
    assert seen.point.x == 0.0


def test_a_branch_point_is_located_although_newtons_method_finds_no_point_beside_it(
    located, monkeypatch
):
    """Where the bordered Jacobian is singular to rounding."""
    correct, at = arclength.correct, 0.4321

    def fails_beside_it(equations, x, value, plane):
        if abs(value - at) < 1e-4:
            raise newton.NotConverged
        return correct(equations, x, value, plane)

    line = _Line()
    line.linearized = lambda x, value: (x, np.array([[value - at]]))
    monkeypatch.setattr(arclength, "correct", fails_beside_it)
    (seen,) = located(lambda point: np.array([1.0 + point.value - at]), line=line)
    assert seen.kind == "branch point"
    assert abs(seen.multiplier - 1.0) < 2e-6


def test_both_multipliers_of_a_pair_are_located_with_the_points_of_one(located, monkeypatch):
    """Whatever rounding makes of the size of the other one."""
    correct, computed = arclength.correct, []

    def counted(*arguments):
        computed.append(arguments)
        return correct(*arguments)

    monkeypatch.setattr(arclength, "correct", counted)

    def multipliers_at(point, *turns):
        size = np.exp(0.1 * (point.value - 0.3) + 0.05 * (point.value - 0.3) ** 2)
        return size * np.array([*turns, 0.1])

    (alone,) = located(lambda point: multipliers_at(point, -1.0))
    of_one = len(computed)
    computed.clear()
    pair = np.exp(1.0j), (1.0 - 1e-15) * np.exp(-1.0j)
    (torus,) = located(lambda point: multipliers_at(point, *pair))
    assert (alone.kind, torus.kind) == ("period doubling", "Neimark-Sacker")
    assert torus.point.value == pytest.approx(0.3, abs=2e-5)
    assert len(computed) == of_one < 10


@pytest.mark.parametrize("rounding", [1e-14, -1e-14])
def test_a_curve_does_not_turn_where_the_parameter_begins_to_change(located, rounding):
    """As of a whirl at a threshold, of any size up to a wall: its tangent has any small sign."""
    half = np.sqrt(0.5)
    still = CurvePoint(np.array([-1.0]), 0.0, np.ones(1), rounding)
    ends = [still, CurvePoint(np.ones(1), 1.0, np.array([half]), half)]
    steady = np.array([0.5])
    assert located(lambda _: steady, line=_Bend(), ends=ends) == []
