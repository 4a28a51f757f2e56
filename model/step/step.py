"""One implicit step of a machine.

The linear part is eliminated exactly, down to the relative displacements at the interfaces: the
band matrix of the step is factorized anew whenever step length or speed have changed (in less than
a microsecond), and what remains is the small problem of `interface_problem`.
"""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import add_product, factorize, solve
from ..kernels.functions import copy, modulus, scaled
from ..kernels.jit import jit
from ..parts.housing import masses
from ..parts.law import Weights
from .bows import add_bows
from .excitation import add_applied, circulation, free_fall_acceleration
from .interface_problem import solve_interfaces
from .laws import first_invalid_law, kinematics, law_force, law_rates, relative, side_of, sides
from .linear_step import balance, balance_back, correct, predict, weights
from .step_status import DONE, FILM_INVALID, NOT_CONVERGED, NOT_FINITE


class Motion(NamedTuple):
    """State at one instant: rows of the shaft's dofs, then the housings, then ground, which stays
    at rest, each complex of shape (n + housings + 1,): displacement q [m], velocity v [m/s]; a: the
    accelerations carried by generalized-alpha, v_dot: those of the equation of motion [m/s2]; jerk
    [m/s3] (of the Li-Zeng-Wiberg indicator); force: of the interfaces on their nodes [N].
    internal_state: states of the laws, with the carried rates and those of the laws."""

    q: Annotated[np.ndarray, complex, "size"]
    v: Annotated[np.ndarray, complex, "size"]
    a: Annotated[np.ndarray, complex, "size"]
    v_dot: Annotated[np.ndarray, complex, "size"]
    jerk: Annotated[np.ndarray, complex, "size"]
    force: Annotated[np.ndarray, complex, "interfaces"]
    internal_state: Annotated[np.ndarray, float, "internal_states"]
    internal_rate_carried: Annotated[np.ndarray, float, "internal_states"]
    internal_rate: Annotated[np.ndarray, float, "internal_states"]


class Workspace(NamedTuple):
    """Work arrays of a step. Only the factorized matrix outlives the step; it is valid for `key` =
    (h, omega, alpha, mass and damping factors of the fit)."""

    key: Annotated[np.ndarray, float, "5"]
    factors: Annotated[np.ndarray, complex, "n", "width"]
    columns: Annotated[np.ndarray, complex, "interfaces", "n"]
    scratch: Annotated[np.ndarray, complex, "n"]
    housing: Annotated[np.ndarray, float, "housings", "2"]
    stores: Annotated[np.ndarray, float, "all_stores"]
    powers: Annotated[np.ndarray, float, "flows"]
    losses: Annotated[np.ndarray, float, "most_losses"]


@jit
def by_axis(x_factor, y_factor, z):
    """Multiply the x and the y part of z by different factors."""
    return complex(x_factor * z.real, y_factor * z.imag)


@jit
def add_internal(structure, spin, factor, damping, q, v, scratch, out):
    """Add factor (damping (C - i Omega G) v + (K - i kappa K_shaft - i/2 Omega' G) q) to out."""
    n = len(out)
    if damping != 0.0:
        for i in range(n):
            scratch[i] = scaled(factor * damping, v[i])
        add_product(structure.C, scratch, out)
    for i in range(n):
        scratch[i] = scaled(factor, q[i])
    add_product(structure.K, scratch, out)
    for i in range(n):
        turned = scaled(damping * spin.omega, v[i]) + scaled(0.5 * spin.alpha, q[i])
        scratch[i] = complex(factor * turned.imag, -factor * turned.real)
    add_product(structure.G, scratch, out)
    kappa = factor * circulation(structure, spin.omega)
    if kappa != 0.0:
        for i in range(n):
            scratch[i] = complex(kappa * q[i].imag, -kappa * q[i].real)
        add_product(structure.K_shaft, scratch, out)


@jit
def housing_forces(housing, g, q, v):
    """Return the force of springs, dampers and weight on a housing [N]; g: see
    `free_fall_acceleration` [m/s2]."""
    spring = by_axis(housing.kx, housing.ky, q)
    damper = by_axis(housing.cx, housing.cy, v)
    return spring + damper - by_axis(*masses(housing), g)


@jit
def accelerate(structure, spin, damping, loads, motion, work):
    """Fill motion.force and motion.v_dot from the equation of motion at this instant; damping:
    factor of a `fitting`."""
    n = structure.M.shape[0]
    f = motion.v_dot[:n]
    f[:] = 0.0
    add_applied(structure, spin, loads, f)
    add_bows(structure, spin, 0.0, motion, f)
    add_internal(structure, spin, -1.0, damping, motion.q, motion.v, work.scratch, f)
    g = free_fall_acceleration(structure, loads)
    for j in range(len(structure.housings)):
        q, v = motion.q[n + j], damping * motion.v[n + j]
        motion.v_dot[n + j] = -housing_forces(structure.housings[j], g, q, v)
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        moving = kinematics(interface, spin, motion.q, motion.v)
        force = law_force(
            structure.laws, interface, moving, motion.internal_state[interface.internal_state :]
        )
        motion.force[j] = force
        motion.v_dot[interface.dof] += force
        motion.v_dot[interface.end] -= force
    _fill_rates(structure, spin, motion)
    for j in range(len(structure.housings)):
        m_x, m_y = masses(structure.housings[j])
        motion.v_dot[n + j] = by_axis(1.0 / m_x, 1.0 / m_y, motion.v_dot[n + j])
    motion.v_dot[n + len(structure.housings)] = 0.0
    solve(structure.M_factors, f)


@jit
def _fill_rates(structure, spin, motion):
    """Fill motion.internal_rate from the laws."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.states > 0:
            law_rates(
                structure.laws,
                interface,
                kinematics(interface, spin, motion.q, motion.v),
                motion.internal_state[interface.internal_state :],
                motion.internal_rate[interface.internal_state :],
            )


@jit
def _factor_step_matrix(structure, scheme, fit, spin, h, work, problem):
    """Factorize the step matrix of the accelerations and condense it to the interfaces."""
    share = 1.0 - scheme.alpha_f
    m_factor, c_factor, k_factor = weights(scheme, h)
    m_factor *= fit.mass
    c_factor *= fit.damping
    gyroscopic = -(c_factor * spin.omega + 0.5 * k_factor * spin.alpha)
    circulatory = -k_factor * circulation(structure, spin.omega)
    n, width = structure.M.shape
    factors = work.factors
    for i in range(n):
        for d in range(width):
            factors[i, d] = complex(
                m_factor * structure.M[i, d]
                + c_factor * structure.C[i, d]
                + k_factor * structure.K[i, d],
                gyroscopic * structure.G[i, d] + circulatory * structure.K_shaft[i, d],
            )
    factorize(factors)
    for j in range(len(structure.housings)):
        housing = structure.housings[j]
        m_x, m_y = masses(housing)
        x = m_factor * m_x + c_factor * housing.cx + k_factor * housing.kx
        y = m_factor * m_y + c_factor * housing.cy + k_factor * housing.ky
        work.housing[j, 0], work.housing[j, 1] = share / x, share / y
    interfaces = structure.interfaces
    m = len(interfaces)
    flexibility = problem.flexibility
    for j in range(m):
        column = work.columns[j]
        column[:] = 0.0
        if interfaces[j].dof < n:
            column[interfaces[j].dof] = share
            solve(factors, column, interfaces[j].dof)
        for i in range(m):
            response = column[interfaces[i].dof] if interfaces[i].dof < n else 0.0j
            flexibility[2 * i, 2 * j] = response.real
            flexibility[2 * i, 2 * j + 1] = -response.imag
            flexibility[2 * i + 1, 2 * j] = response.imag
            flexibility[2 * i + 1, 2 * j + 1] = response.real
            for place, sign in sides(interfaces[j]):
                side = sign * side_of(interfaces[i], place)
                if side != 0.0 and n <= place < n + len(structure.housings):
                    flexibility[2 * i, 2 * j] += side * work.housing[place - n, 0]
                    flexibility[2 * i + 1, 2 * j + 1] += side * work.housing[place - n, 1]
    work.key[0] = h
    work.key[1] = spin.omega
    work.key[2] = spin.alpha
    work.key[3] = fit.mass
    work.key[4] = fit.damping


@jit
def _free_response(structure, scheme, fit, spin, h, loads, old, new, work):
    """Fill in the predictions of q and v, and the accelerations without the interfaces."""
    am, af = fit.mass * scheme.alpha_m, scheme.alpha_f
    share = 1.0 - af
    n = structure.M.shape[0]
    predict(scheme, h, old.q, old.v, old.a, new.q, new.v)
    free, scratch = new.a[:n], work.scratch
    free[:] = 0.0
    scratch[:] = 0.0
    add_applied(structure, spin, loads, free)
    add_bows(structure, spin, h, old, free)
    for i in range(n):
        free[i] = scaled(share, free[i])
        scratch[i] = scaled(af, old.v_dot[i]) - scaled(am, old.a[i])
    add_product(structure.M, scratch, free)
    add_internal(structure, spin, -share, fit.damping, new.q, new.v, scratch, free)
    solve(work.factors, free)
    g = free_fall_acceleration(structure, loads)
    for j in range(len(structure.housings)):
        housing = structure.housings[j]
        at = n + j
        v = fit.damping * new.v[at]
        force = housing_forces(housing, g, new.q[at], v)
        m_x, m_y = masses(housing)
        force += by_axis(m_x / share, m_y / share, am * old.a[at] - af * old.v_dot[at])
        new.a[at] = -by_axis(work.housing[j, 0], work.housing[j, 1], force)
    new.a[n + len(structure.housings)] = 0.0


@jit
def _predict_contacts(problem, interfaces, old, b_d):
    """Predict the displacements of nodes in contact, assuming sliding at constant penetration, and
    of those without a wall at constant acceleration."""
    for j in range(len(interfaces)):
        problem.expected[j] = 0.0
        if interfaces[j].has_wall == 0:
            problem.expected[j] = problem.d0[j] + scaled(b_d, relative(interfaces[j], old.a))
        elif old.force[j] != 0.0:
            ahead = problem.d0[j] + scaled(b_d, relative(interfaces[j], old.a))
            deep = modulus(relative(interfaces[j], old.q))
            problem.expected[j] = scaled(deep / modulus(ahead), ahead)


@jit
def predict_internal_state(scheme, h, old, free):
    """Fill in the predictions of the laws' states at the end of a step; return the weight of their
    rates there. They follow the scheme as velocities do."""
    am, af, _, gamma = scheme
    share = h * gamma / (1.0 - am)
    for i in range(len(free)):
        known = af * old.internal_rate[i] - am * old.internal_rate_carried[i]
        free[i] = (
            old.internal_state[i] + h * (1.0 - gamma) * old.internal_rate_carried[i] + share * known
        )
    return share * (1.0 - af)


@jit
def rescale_carried(motion, ratio):
    """Multiply by `ratio` what the carried accelerations and rates differ by from the exact ones,
    of a motion or of a row of its tangents."""
    for i in range(len(motion.a)):
        motion.a[i] = motion.v_dot[i] + scaled(ratio, motion.a[i] - motion.v_dot[i])
    for i in range(len(motion.internal_state)):
        change = motion.internal_rate_carried[i] - motion.internal_rate[i]
        motion.internal_rate_carried[i] = motion.internal_rate[i] + ratio * change


@jit
def is_finite_within(x, bound):
    """Return whether |x| is within the bound [m or m/s2], and so neither infinite nor NaN."""
    return x.real * x.real + x.imag * x.imag <= bound * bound


@jit
def add_interface_force(structure, work, j, force, a):
    """Add the accelerations caused by the force [N] of an interface."""
    n = structure.M.shape[0]
    for i in range(n):
        a[i] += work.columns[j, i] * force
    for place, sign in sides(structure.interfaces[j]):
        if n <= place < n + len(structure.housings):
            x, y = work.housing[place - n, 0], work.housing[place - n, 1]
            a[place] += by_axis(sign * x, sign * y, force)


@jit
def try_step(structure, scheme, fit, spin, h, loads, old, new, work, problem, limit):
    """Take one step of length h [s] from `old` to `new`; `spin` and `loads` are those at its end,
    `fit` the fitting of the scheme, `limit` as in `solve_interfaces`.

    Return the status, `DONE`, `NOT_CONVERGED` of the interfaces, `NOT_FINITE` or past the bound, or
    `FILM_INVALID`, and the Newton iterations. `old` is never changed.
    """
    key = work.key
    is_new = key[0] != h or key[1] != spin.omega or key[2] != spin.alpha
    if is_new or key[3] != fit.mass or key[4] != fit.damping:
        _factor_step_matrix(structure, scheme, fit, spin, h, work, problem)
    _free_response(structure, scheme, fit, spin, h, loads, old, new, work)

    interfaces = structure.interfaces
    is_finite = True
    for j in range(len(interfaces)):
        problem.d0[j] = relative(interfaces[j], new.q)
        problem.d0_dot[j] = relative(interfaces[j], new.v)
        problem.w_free[j] = relative(interfaces[j], new.a)
        is_finite = is_finite and is_finite_within(problem.w_free[j], 1e150)
    if not is_finite:
        return NOT_FINITE, 0
    b_rate = predict_internal_state(scheme, h, old, problem.free)
    weights_of_laws = Weights(scheme.beta * h * h, scheme.gamma * h, b_rate)
    copy(problem.free, problem.internal_state)
    _predict_contacts(problem, interfaces, old, weights_of_laws.displacement)
    is_converged, iterations = solve_interfaces(
        problem, structure.laws, interfaces, spin, weights_of_laws, limit
    )
    if not is_converged:
        return NOT_CONVERGED, iterations

    for j in range(len(interfaces)):
        force = problem.force[j]
        new.force[j] = force
        if force != 0.0:
            add_interface_force(structure, work, j, force, new.a)
    correct(scheme, h, new.a, new.q, new.v)
    for i in range(len(structure.deflections)):
        if not is_finite_within(new.q[structure.deflections[i, 0]], structure.numbers[0].bound):
            return NOT_FINITE, iterations
    copy(problem.internal_state, new.internal_state)
    if first_invalid_law(structure, new.q, new.internal_state) >= 0:
        return FILM_INVALID, iterations
    balance(scheme, fit.mass, old.a, old.v_dot, new.a, new.v_dot)
    if len(problem.internal_state) > 0:
        _fill_rates(structure, spin, new)
        balance_back(
            scheme,
            old.internal_rate_carried,
            old.internal_rate,
            new.internal_rate,
            new.internal_rate_carried,
        )
    return DONE, iterations
