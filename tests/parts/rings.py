"""A bearing with a floating ring: its numbers, a machine that rests in two, and closed forms of its
short films."""

import math

import numpy as np
from scipy.optimize import fsolve

from ..toml_text import table
from .machines import shaft

RING = {
    **{"journal_radius": 3.5e-3, "length": 5e-3, "clearance": 1.6e-5, "viscosity": 0.006},
    **{"outer_radius": 6e-3, "outer_length": 7e-3, "outer_clearance": 4e-5},
    **{"outer_viscosity": 0.010, "ring_mass": 3.5e-3, "ring_inertia": 8.5e-8, "short": True},
}
SPEED, G = 4000.0, 9.81
INNER, OUTER = ("journal_radius", "length", "clearance", "viscosity"), "outer_"


def of_side(side):
    names = INNER if side == "inner" else [f"{OUTER}{n}" for n in ("radius", *INNER[1:])]
    return [RING[name] for name in names]


def drag(side, e=0.0):
    """Petroff's friction torque over the speed [N.m.s], of an eccentric journal."""
    R, L, c, mu = of_side(side)
    return 2.0 * math.pi * mu * R**3 * L / (c * math.sqrt(1.0 - e * e))


def ocvirk(side, z, turning, v=0.0):
    """The force of a short film on a journal at z, that moves at v, to first order in what of it
    is radial, in closed form [N]."""
    R, L, c, mu = of_side(side)
    e, along = abs(z) / c, z / abs(z)
    moves = v * along.conjugate() / c
    turning -= 2.0 * moves.imag / e
    scale, left = mu * R * L**3 / c**2, 1.0 - e * e
    radial = -turning * e**2 / left**2
    radial -= moves.real * math.pi * (1.0 + 2.0 * e * e) / (2.0 * left**2.5)
    across = turning * math.pi * e / (4.0 * left**1.5) + moves.real * 2.0 * e / left**2
    return scale * complex(radial, across) * along


def in_series(load):
    """Journal, ring [m] and speed of the ring where two films in series carry a load downwards and
    the ring's weight."""

    def left(u):
        d, x, w = complex(*u[:2]) * 1e-5, complex(*u[2:4]) * 1e-5, u[4] * SPEED
        inner = ocvirk("inner", d - x, SPEED + w)
        outer = ocvirk("outer", x, w)
        driven, braked = (
            drag("inner", abs(d - x) / RING["clearance"]) * (SPEED - w),
            drag("outer", abs(x) / RING["outer_clearance"]) * w,
        )
        driven += 0.5 * ((d - x) * inner.conjugate()).imag
        braked -= 0.5 * (x * outer.conjugate()).imag
        on_journal = inner - 1j * load
        on_ring = outer - inner - 1j * RING["ring_mass"] * G
        torque = (driven - braked) / (drag("inner") * SPEED)
        return [
            *(on_journal.real / load, on_journal.imag / load),
            *(on_ring.real / load, on_ring.imag / load, torque),
        ]

    u = fsolve(left, [0.5, -0.5, 0.4, -0.4, 0.2], xtol=1e-13)
    assert np.abs(left(u)).max() < 1e-9
    return complex(*u[:2]) * 1e-5, complex(*u[2:4]) * 1e-5, u[4] * SPEED


def rigid_in_rings(mass=0.1, e=0.0, **more):
    """A body amid a light shaft in two such bearings, whose load is half its weight."""
    body = table("[body]", node=2, mass=mass, I_d=1e-5, I_p=1e-5, e=e)
    light = table("material", young=2.1e13, density=1.0)
    rings = "".join(table("[floating_ring_bearing]", node=n, **{**RING, **more}) for n in (1, 3))
    return shaft(0.0, 0.02, 0.04, diameter=0.007, material=light) + body + rings
