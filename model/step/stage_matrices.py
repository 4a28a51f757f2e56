"""The linear part of a step in stages: its three systems, factorized, and what forces at the
interfaces do to their motion at all stages. See `stages`.
"""

from __future__ import annotations

from ..kernels.band import factorize, solve
from ..kernels.functions import inverse, scaled
from ..kernels.jit import jit, jit_not_inlined
from ..parts.housing import masses
from ..schemes.radau import LAMBDA, SHARES, STAGES
from .excitation import circulation
from .laws import side_of


@jit
def factorize_systems(structure, spin, h, stages):
    """Factorize the three systems of a step."""
    n, width = structure.M.shape
    kappa = circulation(structure, spin.omega)
    for s in range(STAGES):
        by_v = h * LAMBDA[s]
        by_q = by_v * by_v
        gyroscopic = -1j * (by_v * spin.omega + 0.5 * spin.alpha * by_q)
        circulatory = -1j * kappa * by_q
        factors = stages.factors[s]
        for i in range(n):
            for d in range(width):
                factors[i, d] = (
                    structure.M[i, d]
                    + scaled(structure.C[i, d], by_v)
                    + scaled(structure.K[i, d], by_q)
                    + scaled(structure.G[i, d], gyroscopic)
                )
        if kappa != 0.0:
            for i in range(n):
                for d in range(width):
                    factors[i, d] += scaled(structure.K_shaft[i, d], circulatory)
        factorize(factors)
    _factor_housings(structure, h, stages)
    stages.key[0] = h
    stages.key[1] = spin.omega
    stages.key[2] = spin.alpha
    stages.key[3] = 0.0


@jit
def _factor_housings(structure, h, stages):
    """Fill in what forces on the housings do."""
    for j in range(len(structure.housings)):
        housing = structure.housings[j]
        mass = masses(housing)
        for axis in range(2):
            damping = housing.cx if axis == 0 else housing.cy
            stiffness = housing.kx if axis == 0 else housing.ky
            by_force = stages.housing[axis, j]
            for i in range(STAGES):
                for k in range(STAGES):
                    by_force[i, k] = 0.0
                    stages.housing_d[axis, j, i, k] = 0.0
                    stages.housing_v[axis, j, i, k] = 0.0
            for s in range(STAGES):
                by_v = h * LAMBDA[s]
                by_q = by_v * by_v
                response = inverse(mass[axis] + by_v * damping + by_q * stiffness)
                for i in range(STAGES):
                    for k in range(STAGES):
                        share = SHARES[s, i, k] * response
                        by_force[i, k] += share.real
                        stages.housing_d[axis, j, i, k] += (share * by_q).real
                        stages.housing_v[axis, j, i, k] += (share * by_v).real


@jit_not_inlined
def condense(structure, h, stages):
    """Fill in what forces at the interfaces do to their relative displacements and velocities."""
    n, m = len(structure.weight), len(structure.interfaces)
    by_d, by_v = stages.by_d, stages.by_v
    for s in range(STAGES):
        for b in range(m):
            dof = structure.interfaces[b].dof
            column = stages.columns[s, b]
            for i in range(n):
                column[i] = 0.0
            if dof < n:
                column[dof] = 1.0
                solve(stages.factors[s], column, dof)
    for a in range(m):
        for b in range(m):
            dof = structure.interfaces[a].dof
            for i in range(STAGES):
                for k in range(STAGES):
                    d, v = 0.0j, 0.0j
                    for s in range(STAGES):
                        factor = h * LAMBDA[s]
                        response = stages.columns[s, b, dof] if dof < n else 0.0j
                        part = factor * (SHARES[s, i, k] * response)
                        v += part
                        d += factor * part
                    row, column = 2 * (i * m + a), 2 * (k * m + b)
                    by_d[row, column] = by_d[row + 1, column + 1] = d.real
                    by_d[row, column + 1] = -d.imag
                    by_d[row + 1, column] = d.imag
                    by_v[row, column] = by_v[row + 1, column + 1] = v.real
                    by_v[row, column + 1] = -v.imag
                    by_v[row + 1, column] = v.imag
                    for place in range(len(structure.housings)):
                        side = side_of(structure.interfaces[a], n + place)
                        side *= side_of(structure.interfaces[b], n + place)
                        if side == 0.0:
                            continue
                        for axis in range(2):
                            on_d = side * stages.housing_d[axis, place, i, k]
                            on_v = side * stages.housing_v[axis, place, i, k]
                            by_d[row + axis, column + axis] += on_d
                            by_v[row + axis, column + axis] += on_v
    stages.key[3] = 1.0
