"""One implicit step of a rotor in clearance bearings.

The linear part is eliminated exactly, down to the journals' relative displacements: the band matrix
of the step is factorized anew whenever step length or speed have changed (that costs less than a
microsecond, being a band), and what remains is the small problem of `contact_problem`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .assembly import Structure
from .band import add_product, factorize, solve
from .compiled import compiled
from .contact import contact_force
from .contact_problem import ContactProblem, new_contact_problem, solve_contacts
from .energy import STORES
from .excitation import add_applied, circulation
from .linear_step import correct, predict, weights


class Motion(NamedTuple):
    """State at one instant, each of shape (n + bearings,), complex, journals' nodes first, housings
    last: displacement q [m], velocity v [m/s], acceleration a [m/s2], residual r = C v + K q - f
    [N], jerk [m/s3] (of the Li-Zeng-Wiberg indicator); force: of the contacts on the journals,
    shape (bearings,) [N]."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    r: np.ndarray
    jerk: np.ndarray
    force: np.ndarray


class Workspace(NamedTuple):
    """Scratch of a step: nothing in it outlives the step but the factorized matrix, valid for
    `key` = (h, omega, alpha)."""

    key: np.ndarray
    factors: np.ndarray
    columns: np.ndarray
    free: np.ndarray
    scratch: np.ndarray
    turning: np.ndarray
    housing: np.ndarray
    stores: np.ndarray
    problem: ContactProblem


def new_motion(structure: Structure) -> Motion:
    """A motion of zeros; its rows of length n + bearings share one buffer."""
    nb = len(structure.contacts)
    rows = np.zeros((5, structure.M.shape[1] + nb), dtype=complex)
    return Motion(*rows, force=np.zeros(nb, dtype=complex))


def new_workspace(structure: Structure) -> Workspace:
    """Scratch arrays for steps of this structure."""
    n, nb = structure.M.shape[1], len(structure.contacts)
    return Workspace(
        key=np.full(3, np.nan),
        factors=np.zeros(structure.M.shape, dtype=complex),
        columns=np.zeros((n, nb), dtype=complex),
        free=np.zeros((n, 1), dtype=complex),
        scratch=np.zeros(n, dtype=complex),
        turning=np.zeros(n, dtype=complex),
        housing=np.zeros((nb, 2)),
        stores=np.zeros(len(STORES)),
        problem=new_contact_problem(nb),
    )


@compiled
def by_axis(x_factor, y_factor, z):
    """Different factors on the x and the y part of z."""
    return complex(x_factor * z.real, y_factor * z.imag)


@compiled
def internal_forces(structure, spin, q, v, turning, out):
    """out += (C - i Omega G) v + (K - i kappa K_shaft - i/2 Omega' G) q, first n entries [N];
    turning: scratch of shape (n,)."""
    kappa = circulation(structure, spin.omega)
    add_product(1.0, structure.C, v, out)
    add_product(1.0, structure.K, q, out)
    for i in range(len(turning)):
        turned = spin.omega * v[i] + 0.5 * spin.alpha * q[i]
        turning[i] = complex(turned.imag, -turned.real)
    add_product(1.0, structure.G, turning, out)
    if kappa != 0.0:
        add_product(-1j * kappa, structure.K_shaft, q, out)


@compiled
def residual(structure, spin, loads, motion, turning):
    """Fill motion.force and motion.r = internal - applied - contact forces at this instant."""
    n = structure.M.shape[1]
    r = motion.r
    for i in range(n):
        r[i] = 0.0
    add_applied(structure, spin, loads, r)
    for i in range(n):
        r[i] = -r[i]
    internal_forces(structure, spin, motion.q, motion.v, turning, r)
    for j in range(len(structure.contacts)):
        bearing = structure.contacts[j]
        q, v = motion.q[n + j], motion.v[n + j]
        d = motion.q[bearing.dof] - q
        d_dot = motion.v[bearing.dof] - v
        force = contact_force(bearing, d, d_dot, spin.omega)[0]
        motion.force[j] = force
        r[bearing.dof] -= force
        r[n + j] = housing_forces(bearing, structure.gravity, q, v) + force


@compiled
def housing_forces(bearing, gravity, q, v):
    """Springs, dampers and weight of a housing [N]."""
    spring = by_axis(bearing.kx, bearing.ky, q)
    damper = by_axis(bearing.cx, bearing.cy, v)
    return spring + damper + 1j * bearing.mass * gravity


@compiled
def _factor_step_matrix(structure, scheme, spin, h, work):
    """Factorize the step matrix of the accelerations; condense it to the journals and housings."""
    af = scheme.alpha_f
    m_factor, c_factor, k_factor = weights(scheme, h)
    g_factor = -1j * (c_factor * spin.omega + 0.5 * k_factor * spin.alpha)
    s_factor = -1j * k_factor * circulation(structure, spin.omega)
    for d in range(structure.M.shape[0]):
        for i in range(structure.M.shape[1]):
            work.factors[d, i] = (
                m_factor * structure.M[d, i]
                + c_factor * structure.C[d, i]
                + k_factor * structure.K[d, i]
                + g_factor * structure.G[d, i]
            )
    if s_factor != 0.0:
        for d in range(structure.M.shape[0]):
            for i in range(structure.M.shape[1]):
                work.factors[d, i] += s_factor * structure.K_shaft[d, i]
    factorize(work.factors)
    contacts = structure.contacts
    nb = len(contacts)
    work.columns[:, :] = 0.0
    for j in range(nb):
        work.columns[contacts[j].dof, j] = 1.0 - af
    solve(work.factors, work.columns)
    flexibility = work.problem.flexibility
    for j in range(nb):
        for i in range(nb):
            response = work.columns[contacts[i].dof, j]
            flexibility[2 * i, 2 * j] = response.real
            flexibility[2 * i, 2 * j + 1] = -response.imag
            flexibility[2 * i + 1, 2 * j] = response.imag
            flexibility[2 * i + 1, 2 * j + 1] = response.real
        bearing = contacts[j]
        inertia = m_factor * bearing.mass
        work.housing[j, 0] = (1.0 - af) / (inertia + c_factor * bearing.cx + k_factor * bearing.kx)
        work.housing[j, 1] = (1.0 - af) / (inertia + c_factor * bearing.cy + k_factor * bearing.ky)
        flexibility[2 * j, 2 * j] += work.housing[j, 0]
        flexibility[2 * j + 1, 2 * j + 1] += work.housing[j, 1]
    work.key[0] = h
    work.key[1] = spin.omega
    work.key[2] = spin.alpha


@compiled
def _free_response(structure, scheme, spin, h, loads, old, new, work):
    """Predictions of q and v, and the accelerations that would follow without contact."""
    am, af = scheme.alpha_m, scheme.alpha_f
    n = structure.M.shape[1]
    predict(scheme, h, old.q, old.v, old.a, new.q, new.v)
    applied, internal = work.scratch, new.r
    for i in range(n):
        applied[i] = 0.0
        internal[i] = 0.0
    add_applied(structure, spin, loads, applied)
    internal_forces(structure, spin, new.q, new.v, work.turning, internal)
    for i in range(n):
        work.free[i, 0] = (1.0 - af) * (applied[i] - internal[i]) - af * old.r[i]
    add_product(-am, structure.M, old.a, work.free[:, 0])
    solve(work.factors, work.free)
    for i in range(n):
        new.a[i] = work.free[i, 0]
    for j in range(len(structure.contacts)):
        bearing = structure.contacts[j]
        at = n + j
        force = housing_forces(bearing, structure.gravity, new.q[at], new.v[at])
        force += (am * bearing.mass * old.a[at] + af * old.r[at]) / (1.0 - af)
        new.a[at] = -by_axis(work.housing[j, 0], work.housing[j, 1], force)


@compiled
def try_step(structure, scheme, spin, h, loads, old, new, work):
    """One step of length h [s] from `old` to `new`; `spin` and `loads` are those at its end.

    Returns (status, Newton iterations): 0 done, 1 the contacts did not converge, 2 not finite or
    past the bound. Whatever the status, `old` is untouched.
    """
    n = structure.M.shape[1]
    if work.key[0] != h or work.key[1] != spin.omega or work.key[2] != spin.alpha:
        _factor_step_matrix(structure, scheme, spin, h, work)
    _free_response(structure, scheme, spin, h, loads, old, new, work)

    contacts, problem = structure.contacts, work.problem
    is_finite = True
    for j in range(len(contacts)):
        at = contacts[j].dof
        problem.d0[j] = new.q[at] - new.q[n + j]
        problem.d0_dot[j] = new.v[at] - new.v[n + j]
        problem.w_free[j] = new.a[at] - new.a[n + j]
        is_finite = is_finite and np.isfinite(abs(problem.w_free[j]))
    if not is_finite:
        return 2, 0
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    is_converged, iterations = solve_contacts(problem, contacts, spin.omega, b_d, b_v, old.force)
    if not is_converged:
        return 1, iterations

    for j in range(len(contacts)):
        force = problem.force[j]
        if force != 0.0:
            for i in range(n):
                new.a[i] += work.columns[i, j] * force
            new.a[n + j] -= by_axis(work.housing[j, 0], work.housing[j, 1], force)
    correct(scheme, h, new.a, new.q, new.v)
    for i in range(0, n, 2):
        if not abs(new.q[i]) <= structure.bound:
            return 2, iterations
    residual(structure, spin, loads, new, work.turning)
    return 0, iterations
