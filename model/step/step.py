"""One implicit step of a rotor in clearance bearings.

The linear part is eliminated exactly, down to the journals' relative displacements: the band matrix
of the step is factorized anew whenever step length or speed have changed (that costs less than a
microsecond, being a band), and what remains is the small problem of `contact_problem`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..kernels.band import add_product, factorize, solve
from ..kernels.compiled import compiled
from ..march.energy import FLOWS, STORES
from ..parts.clearance_contact import contact_force
from ..structure.assembly import Structure
from .contact_problem import ContactProblem, new_contact_problem, solve_contacts
from .excitation import add_applied, circulation
from .linear_step import balance, correct, predict, weights


class Motion(NamedTuple):
    """State at one instant, each of shape (n + bearings,), complex, journals' nodes first, housings
    last: displacement q [m], velocity v [m/s]; a: the accelerations that generalized-alpha carries
    along, v_dot: those of the equation of motion [m/s2]; jerk [m/s3] (of the Li-Zeng-Wiberg
    indicator); force: of the contacts on the journals, shape (bearings,) [N]."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    v_dot: np.ndarray
    jerk: np.ndarray
    force: np.ndarray


class Workspace(NamedTuple):
    """Scratch of a step: nothing in it outlives the step but the factorized matrix, valid for
    `key` = (h, omega, alpha)."""

    key: np.ndarray
    factors: np.ndarray
    columns: np.ndarray
    scratch: np.ndarray
    housing: np.ndarray
    stores: np.ndarray
    powers: np.ndarray
    problem: ContactProblem


def new_motion(structure: Structure) -> Motion:
    """A motion of zeros; its rows of length n + bearings share one buffer."""
    nb = len(structure.contacts)
    rows = np.zeros((5, structure.M.shape[0] + nb), dtype=complex)
    return Motion(*rows, force=np.zeros(nb, dtype=complex))


def new_workspace(structure: Structure) -> Workspace:
    """Scratch arrays for steps of this structure."""
    n, nb = structure.M.shape[0], len(structure.contacts)
    return Workspace(
        key=np.full(3, np.nan),
        factors=np.zeros(structure.M.shape, dtype=complex),
        columns=np.zeros((nb, n), dtype=complex),
        scratch=np.zeros(n, dtype=complex),
        housing=np.zeros((nb, 2)),
        stores=np.zeros(len(STORES)),
        powers=np.zeros(len(FLOWS)),
        problem=new_contact_problem(nb),
    )


@compiled
def by_axis(x_factor, y_factor, z):
    """Different factors on the x and the y part of z."""
    return complex(x_factor * z.real, y_factor * z.imag)


@compiled
def _add_internal(structure, spin, factor, damping, q, v, scratch, out):
    """out += factor (damping (C - i Omega G) v + (K - i kappa K_shaft - i/2 Omega' G) q)."""
    n = len(out)
    for i in range(n):
        scratch[i] = factor * damping * v[i]
    add_product(structure.C, scratch, out)
    for i in range(n):
        scratch[i] = factor * q[i]
    add_product(structure.K, scratch, out)
    for i in range(n):
        turned = factor * (damping * spin.omega * v[i] + 0.5 * spin.alpha * q[i])
        scratch[i] = complex(turned.imag, -turned.real)
    add_product(structure.G, scratch, out)
    kappa = factor * circulation(structure, spin.omega)
    if kappa != 0.0:
        for i in range(n):
            scratch[i] = complex(kappa * q[i].imag, -kappa * q[i].real)
        add_product(structure.K_shaft, scratch, out)


@compiled
def _housing_forces(bearing, gravity, q, v):
    """Springs, dampers and weight of a housing [N]."""
    spring = by_axis(bearing.kx, bearing.ky, q)
    damper = by_axis(bearing.cx, bearing.cy, v)
    return spring + damper + 1j * bearing.mass * gravity


@compiled
def accelerate(structure, spin, damping, loads, motion, work):
    """Fill motion.force and motion.v_dot from the equation of motion at this instant; damping: the
    factor that a `fitting` gives it."""
    n = structure.M.shape[0]
    f = motion.v_dot[:n]
    for i in range(n):
        f[i] = 0.0
    add_applied(structure, spin, loads, f)
    _add_internal(structure, spin, -1.0, damping, motion.q, motion.v, work.scratch, f)
    for j in range(len(structure.contacts)):
        bearing = structure.contacts[j]
        q, v = motion.q[n + j], motion.v[n + j]
        d = motion.q[bearing.dof] - q
        d_dot = motion.v[bearing.dof] - v
        force = contact_force(bearing, d, d_dot, spin.omega)[0]
        motion.force[j] = force
        f[bearing.dof] += force
        housing = _housing_forces(bearing, structure.gravity, q, damping * v) + force
        motion.v_dot[n + j] = housing * (-1.0 / bearing.mass)
    solve(structure.M_factors, f)


@compiled
def _factor_step_matrix(structure, scheme, fit, spin, h, work):
    """Factorize the step matrix of the accelerations; condense it to the journals and housings."""
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
    contacts = structure.contacts
    nb = len(contacts)
    flexibility = work.problem.flexibility
    for j in range(nb):
        column = work.columns[j]
        for i in range(n):
            column[i] = 0.0
        column[contacts[j].dof] = share
        solve(factors, column, contacts[j].dof)
        for i in range(nb):
            response = column[contacts[i].dof]
            flexibility[2 * i, 2 * j] = response.real
            flexibility[2 * i, 2 * j + 1] = -response.imag
            flexibility[2 * i + 1, 2 * j] = response.imag
            flexibility[2 * i + 1, 2 * j + 1] = response.real
        bearing = contacts[j]
        inertia = m_factor * bearing.mass
        work.housing[j, 0] = share / (inertia + c_factor * bearing.cx + k_factor * bearing.kx)
        work.housing[j, 1] = share / (inertia + c_factor * bearing.cy + k_factor * bearing.ky)
        flexibility[2 * j, 2 * j] += work.housing[j, 0]
        flexibility[2 * j + 1, 2 * j + 1] += work.housing[j, 1]
    work.key[0] = h
    work.key[1] = spin.omega
    work.key[2] = spin.alpha


@compiled
def _free_response(structure, scheme, fit, spin, h, loads, old, new, work):
    """Predictions of q and v, and the accelerations that would follow without contact."""
    am, af = fit.mass * scheme.alpha_m, scheme.alpha_f
    share = 1.0 - af
    n = structure.M.shape[0]
    predict(scheme, h, old.q, old.v, old.a, new.q, new.v)
    free, scratch = new.a[:n], work.scratch
    for i in range(n):
        free[i] = 0.0
        scratch[i] = 0.0
    add_applied(structure, spin, loads, free)
    for i in range(n):
        free[i] *= share
        scratch[i] = af * old.v_dot[i] - am * old.a[i]
    add_product(structure.M, scratch, free)
    _add_internal(structure, spin, -share, fit.damping, new.q, new.v, scratch, free)
    solve(work.factors, free)
    for j in range(len(structure.contacts)):
        bearing = structure.contacts[j]
        at = n + j
        v = fit.damping * new.v[at]
        force = _housing_forces(bearing, structure.gravity, new.q[at], v)
        force += (am * old.a[at] - af * old.v_dot[at]) * (bearing.mass / share)
        new.a[at] = -by_axis(work.housing[j, 0], work.housing[j, 1], force)


@compiled
def _expect(problem, contacts, old, n, b_d):
    """Where the journals in contact will be if they slide on at the same depth."""
    for j in range(len(contacts)):
        at = contacts[j].dof
        problem.expected[j] = 0.0
        if old.force[j] != 0.0:
            ahead = problem.d0[j] + b_d * (old.a[at] - old.a[n + j])
            problem.expected[j] = ahead * (abs(old.q[at] - old.q[n + j]) / abs(ahead))


@compiled
def _is_sane(x, bound):
    """Whether |x| is within the bound [m or m/s2] and so neither infinite nor NaN."""
    return x.real * x.real + x.imag * x.imag <= bound * bound


@compiled
def try_step(structure, scheme, fit, spin, h, loads, old, new, work):
    """One step of length h [s] from `old` to `new`; `spin` and `loads` are those at its end,
    `fit` what the scheme is fitted with.

    Returns (status, Newton iterations): 0 done, 1 the contacts did not converge, 2 not finite or
    past the bound. Whatever the status, `old` is untouched.
    """
    n = structure.M.shape[0]
    if work.key[0] != h or work.key[1] != spin.omega or work.key[2] != spin.alpha:
        _factor_step_matrix(structure, scheme, fit, spin, h, work)
    _free_response(structure, scheme, fit, spin, h, loads, old, new, work)

    contacts, problem = structure.contacts, work.problem
    is_finite = True
    for j in range(len(contacts)):
        at = contacts[j].dof
        problem.d0[j] = new.q[at] - new.q[n + j]
        problem.d0_dot[j] = new.v[at] - new.v[n + j]
        problem.w_free[j] = new.a[at] - new.a[n + j]
        is_finite = is_finite and _is_sane(problem.w_free[j], 1e150)
    if not is_finite:
        return 2, 0
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    _expect(problem, contacts, old, n, b_d)
    is_converged, iterations = solve_contacts(problem, contacts, spin.omega, b_d, b_v)
    if not is_converged:
        return 1, iterations

    for j in range(len(contacts)):
        force = problem.force[j]
        new.force[j] = force
        if force != 0.0:
            for i in range(n):
                new.a[i] += work.columns[j, i] * force
            new.a[n + j] -= by_axis(work.housing[j, 0], work.housing[j, 1], force)
    correct(scheme, h, new.a, new.q, new.v)
    for i in range(len(structure.deflections)):
        if not _is_sane(new.q[structure.deflections[i, 0]], structure.bound):
            return 2, iterations
    balance(scheme, fit.mass, old.a, old.v_dot, new.a, new.v_dot)
    return 0, iterations
