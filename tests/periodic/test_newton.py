"""Newton's method, and what continuation shares with it."""

import numpy as np
import pytest
from rotor_fmu.model.periodic import newton
from rotor_fmu.model.quantities import QuantityError


class _Equations(newton.Equations):
    """Equations of two functions, the residual and, with the Jacobian, the linearized one."""

    def __init__(self, residual, linearized):
        self._functions = residual, linearized

    def residual(self, x, value):
        return self._functions[0](x, value)

    def linearized(self, x, value):
        return self._functions[1](x, value)


def test_a_system_that_is_singular_has_its_least_squares_solution_or_none():
    """The shortest one; of a law that is no number Newton's method then says that it fails."""
    singular = np.diag([2.0, 1.0, 0.0])
    singular[2, 1] = 1.0
    right = np.array([[2.0], [1.0], [3.0]])
    assert newton.solve_linear(singular, right) == pytest.approx(np.array([[1.0], [2.0], [0.0]]))
    assert not np.isfinite(newton.solve_linear(np.nan * singular, right)).all()


@pytest.mark.filterwarnings("error")
def test_a_residual_whose_square_no_number_holds_is_no_warning_to_the_user():
    """Such as that of an oil film far beyond its wall."""
    slope = np.diag([1e200, 1.0])
    steep = _Equations(lambda x, _: slope @ (x - 1.0), lambda x, _: (slope @ (x - 1.0), slope))
    assert newton.solve(steep, np.zeros(2), 0.0) == pytest.approx(1.0)


def test_newtons_method_gives_up_at_a_corner_that_is_a_minimum_of_the_residual():
    """Where every correction fails, instead of trying as many as it has."""

    class _Corner(newton.Equations):
        linearizations = 0

        def residual(self, x, value):
            return 1.0 + np.abs(x)

        def linearized(self, x, value):
            self.linearizations += 1
            return self.residual(x, value), np.diag(np.where(x < 0.0, -1.0, 1.0))

    corner = _Corner()
    with pytest.raises(newton.NotConverged):
        newton.solve(corner, np.array([0.3]), 0.0)
    assert corner.linearizations < 20


def test_newtons_method_gives_up_in_a_steep_bent_valley_along_which_the_residual_hardly_falls():
    """Every correction does decrease it, by a hundredth; of a flatter valley it finds the end."""
    places = []

    def valley(steepness):
        def residual(x, _):
            return np.array([1.0 - x[0], steepness * (x[1] - x[0] ** 2)])

        def linearized(x, value):
            places.append(x[0])
            slope = np.array([[-1.0, 0.0], [-2.0 * steepness * x[0], steepness]])
            return residual(x, value), slope

        return _Equations(residual, linearized)

    begin = np.array([-1.0, 1.0])
    with pytest.raises(newton.NotConverged):
        newton.solve(valley(100.0), begin, 0.0)
    assert len(places) < 20
    assert (np.diff(places) > 0.0).all()
    assert newton.solve(valley(1.0), begin, 0.0) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("most", "corners", "side"),
    [(2, {}, 1), (2, {True}, -1), (1, {}, -1), (1, {False}, -1), (2, {True, False}, -1)],
)
def test_a_derivative_by_a_parameter_is_downwards_where_upwards_is_none(most, corners, side):
    """Or a corner, which it goes over where there is nothing else: of v^2 at 1."""

    def squared(v):
        if v > most:
            raise QuantityError("too large")
        return np.array([v * v])

    by = newton.by_parameter(squared, 1.0, np.ones(1), 1.0, 1e-3, lambda v: (v > 1) in corners)
    assert by == pytest.approx([2.0 + 1e-3 * side], rel=1e-9)
