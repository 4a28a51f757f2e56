"""The linear part of a step in stages: its factorized systems, and the influence of interface
forces on the motion at all stages. See `stages`."""

from ..kernels.functions import inverse, scaled
from ..kernels.jit import jit, jit_not_inlined
from ..parts.housing import masses
from ..schemes.radau import LAMBDA, SHARES, STAGES, of_parts, parts_times
from .excitation import circulation
from .laws import side_of, sides


@jit
def factorize_systems(structure, spin, h, stages):
    """Fill in and factorize the three systems of a step."""
    n, width = structure.M.shape
    kappa = circulation(structure, spin.omega)
    real, by_v = h * LAMBDA[0].real, h * LAMBDA[1]
    by_q = by_v * by_v
    gyroscopic = -1j * (by_v * spin.omega + 0.5 * spin.alpha * by_q)
    of_real = -(real * spin.omega + 0.5 * spin.alpha * (real * real))
    factors = stages.factors
    for i in range(n):
        for d in range(width):
            m, c, k, g = structure.M[i, d], structure.C[i, d], structure.K[i, d], structure.G[i, d]
            even, odd = m + c * by_v.real + k * by_q.real, c * by_v.imag + k * by_q.imag
            x, y = g * gyroscopic.real, g * gyroscopic.imag
            factors[i, d, 0] = complex(m + c * real + k * (real * real), g * of_real)
            factors[i, d, 1] = complex(even + x, y + odd)
            factors[i, d, 2] = complex(even - x, y - odd)
    if kappa != 0.0:
        for i in range(n):
            for d in range(width):
                strain = kappa * structure.K_shaft[i, d]
                x, y = strain * by_q.imag, -strain * by_q.real
                factors[i, d, 0] += complex(0.0, -strain * (real * real))
                factors[i, d, 1] += complex(x, y)
                factors[i, d, 2] += complex(-x, y)
    _factorize(factors)
    _factor_housings(structure, h, stages)
    stages.key[0] = h
    stages.key[1] = spin.omega
    stages.key[2] = spin.alpha
    stages.key[3] = 0.0


@jit
def _factorize(bands):
    """Do `kernels.band.factorize` for three matrices, bands[:, :, s], interleaved, so that a
    processor can overlap the three factorizations."""
    n, width = bands.shape[:2]
    for j in range(n):
        a, b, c = inverse(bands[j, 0, 0]), inverse(bands[j, 0, 1]), inverse(bands[j, 0, 2])
        last = min(width, n - j)
        for d in range(1, last):
            p, q, r = bands[j, d, 0] * a, bands[j, d, 1] * b, bands[j, d, 2] * c
            for e in range(d, last):
                bands[j + d, e - d, 0] -= p * bands[j, e, 0]
                bands[j + d, e - d, 1] -= q * bands[j, e, 1]
                bands[j + d, e - d, 2] -= r * bands[j, e, 2]
            bands[j, d, 0], bands[j, d, 1], bands[j, d, 2] = p, q, r
        bands[j, 0, 0], bands[j, 0, 1], bands[j, 0, 2] = a, b, c


@jit
def solve_systems(factors, x, first=0):
    """Do `kernels.band.solve` for three right-hand sides, x[:, s], and replace the solutions a, b,
    c by the parts a, b + c, i (b - c); see `schemes.radau`."""
    n, width = factors.shape[:2]
    for j in range(first, n):
        a, b, c = x[j, 0], x[j, 1], x[j, 2]
        for d in range(1, min(width, n - j)):
            x[j + d, 0] -= factors[j, d, 0] * a
            x[j + d, 1] -= factors[j, d, 1] * b
            x[j + d, 2] -= factors[j, d, 2] * c
    for j in range(n - 1, -1, -1):
        a, b, c = factors[j, 0, 0] * x[j, 0], factors[j, 0, 1] * x[j, 1], factors[j, 0, 2] * x[j, 2]
        for d in range(1, min(width, n - j)):
            a -= factors[j, d, 0] * x[j + d, 0]
            b -= factors[j, d, 1] * x[j + d, 1]
            c -= factors[j, d, 2] * x[j + d, 2]
        x[j, 0], x[j, 1], x[j, 2] = a, b, c
    for j in range(n):
        b, c = x[j, 1], x[j, 2]
        x[j, 1], x[j, 2] = b + c, complex(c.imag - b.imag, b.real - c.real)


@jit
def _factor_housings(structure, h, stages):
    """Fill in the influence of forces on the housings."""
    for j in range(len(structure.housings)):
        housing = structure.housings[j]
        mass = masses(housing)
        for axis in range(2):
            damping = housing.cx if axis == 0 else housing.cy
            stiffness = housing.kx if axis == 0 else housing.ky
            responses = (
                stages.housing[axis, j],
                stages.housing_v[axis, j],
                stages.housing_d[axis, j],
            )
            real, pair = h * LAMBDA[0].real, h * LAMBDA[1]
            p = complex(1.0 / (mass[axis] + real * damping + (real * real) * stiffness), 0.0)
            one = inverse(mass[axis] + pair * damping + (pair * pair) * stiffness)
            s, t = complex(2.0 * one.real, 0.0), complex(-2.0 * one.imag, 0.0)
            for response in responses:
                for i in range(STAGES):
                    for k in range(STAGES):
                        response[i, k] = of_parts(SHARES[i, k], p, s, t).real
                p = scaled(real, p)
                s, t = parts_times(pair, s, t)


@jit_not_inlined
def condense(structure, h, stages):
    """Fill in the influence of interface forces on their relative displacements and velocities."""
    n, m = len(structure.static_load), len(structure.interfaces)
    real, pair = h * LAMBDA[0].real, h * LAMBDA[1]
    for b in range(m):
        dof, columns = structure.interfaces[b].dof, stages.columns[b]
        for i in range(n):
            for k in range(STAGES):
                columns[i, k] = 0.0
        if dof < n:
            for k in range(STAGES):
                columns[dof, k] = 1.0
            solve_systems(stages.factors, columns, dof)
        for a in range(m):
            at = structure.interfaces[a].dof
            p, s, t = 0.0j, 0.0j, 0.0j
            if at < n:
                p, s, t = columns[at, 0], columns[at, 1], columns[at, 2]
            v_p = scaled(real, p)
            v_s, v_t = parts_times(pair, s, t)
            d_p = scaled(real, v_p)
            d_s, d_t = parts_times(pair, v_s, v_t)
            for i in range(STAGES):
                for k in range(STAGES):
                    row, column = 2 * (i * m + a), 2 * (k * m + b)
                    weights = SHARES[i, k]
                    _fill_block(stages.by_d, column, row, of_parts(weights, d_p, d_s, d_t))
                    _fill_block(stages.by_v, column, row, of_parts(weights, v_p, v_s, v_t))
            for place, sign in sides(structure.interfaces[b]):
                side = sign * side_of(structure.interfaces[a], place)
                if side != 0.0 and n <= place < n + len(structure.housings):
                    _add_housing(stages, side, place - n, 2 * a, 2 * b, 2 * m)
    stages.key[3] = 1.0


@jit
def _fill_block(by_force, column, row, response):
    """Fill in the response to a force in x, and the same turned by a right angle for a force in
    y."""
    by_force[column, row] = by_force[column + 1, row + 1] = response.real
    by_force[column + 1, row] = -response.imag
    by_force[column, row + 1] = response.imag


@jit
def _add_housing(stages, side, place, row, column, width):
    """Add the response of a housing, in a block for each pair of stages."""
    for i in range(STAGES):
        for k in range(STAGES):
            for axis in range(2):
                u, at = column + k * width + axis, row + i * width + axis
                stages.by_d[u, at] += side * stages.housing_d[axis, place, i, k]
                stages.by_v[u, at] += side * stages.housing_v[axis, place, i, k]
