"""The ring of a floating ring bearing: its position, velocity and speed of rotation in equilibrium,
over a step and linearized, which are states of the bearing's law (`floating_ring_bearing`)."""

from typing import Any, NamedTuple

from ..film.bearing_film import FilmBearing
from ..film.floating_ring import ring_response, sheared, stiffness, torque_by, torque_of
from ..kernels.functions import modulus, scaled
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import places
from .law import Kinematics

_STEPS, _REST_STEPS = 60, 120
_NEAR = 1e-7  # share of the scales: the error after Newton's last step is of second order in it
_REACH = 0.2  # largest share of the smaller clearance by which a step moves the ring
WEIGHT = places(("x", "y"))  # gravity, at the head of the law's table
STATE = places(("x", "y", "vx", "vy", "speed"))


@jit
def _films(part):
    """Return the `FilmBearing`s of the inner and the outer film, whose tables are one after the
    other behind the ring's weight."""
    begin = part.table + len(WEIGHT)
    behind = begin + (part.rows - len(WEIGHT)) // 2
    contact = (0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0)
    inner = FilmBearing(
        *(begin, part.journal_radius, part.length, part.clearance, part.viscosity),
        *(part.roughness, part.short, part.points, *contact),
    )
    outer = FilmBearing(
        *(behind, part.outer_radius, part.outer_length, part.outer_clearance),
        *(part.outer_viscosity, part.roughness, part.short, part.points, *contact),
    )
    return inner, outer


class Ring(NamedTuple):
    """A ring at an instant: its `Sheared` films, velocities of the journal relative to it and of
    itself [m/s], its speed [rad/s]; force [N] and torque [N.m] on it, without inertia."""

    inner: Any
    outer: Any
    relative_velocity: complex
    velocity: complex
    speed: float
    force: complex
    torque: float


@jit_not_inlined
def ring(part, tables, kinematics, x, velocity, speed, has_slopes=True):
    """Return the `Ring` at a position [m]; has_slopes: of its films, see `sheared`."""
    of_inner, of_outer = _films(part)
    d, relative_velocity, omega = (
        kinematics.displacement - x,
        kinematics.velocity - velocity,
        kinematics.speed,
    )
    inner = sheared(
        *(of_inner, tables),
        Kinematics(d, relative_velocity, omega + speed, omega - speed, 0.0),
        has_slopes,
    )
    outer = sheared(of_outer, tables, Kinematics(x, velocity, speed, speed, 0.0), has_slopes)
    weight = part.ring_mass * complex(tables[part.table], tables[part.table + 1])
    return Ring(
        *(inner, outer, relative_velocity, velocity, speed),
        outer.force - inner.force + weight,
        torque_of(inner, 1.0) - torque_of(outer, -1.0),
    )


@jit
def ring_of_states(part, tables, kinematics, states, has_slopes):
    """Return the `Ring` of internal states; has_slopes: of its films, see `sheared`."""
    return ring(
        *(part, tables, kinematics, complex(states[0], states[1])),
        *(complex(states[2], states[3]), states[4], has_slopes),
    )


@jit
def store_ring(internal_state, x, velocity, speed):
    """Fill in the states of a ring."""
    internal_state[STATE.x] = x.real
    internal_state[STATE.y] = x.imag
    internal_state[STATE.vx] = velocity.real
    internal_state[STATE.vy] = velocity.imag
    internal_state[STATE.speed] = speed


@jit
def _within(part, size):
    """Return the share of a Newton step of a size [m] that is applied."""
    reach = _REACH * min(part.clearance, part.outer_clearance)
    return reach / size if size > reach else 1.0


@jit
def _led(at, by_d, by_v):
    """Return the `RingResponse` of a `Ring` that moves by by_d and with by_v of what is sought,
    without inertia, to the residuals on it."""
    return ring_response(
        *(at.inner, at.outer, 1.0 + 0.0j, 0.0j, complex(by_d, 0.0), complex(by_v, 0.0)),
        *(0.0j, 0.0j, at.force, at.torque),
    )


@jit_not_inlined
def ring_at_rest(part, tables, kinematics, internal_state):
    """Return the `Ring` in equilibrium about a journal at rest, and store it in the states, from
    which the search starts; by implicit steps of a ring without inertia, of growing length, and by
    an endless one, which is Newton's, where that is near."""
    x = complex(internal_state[STATE.x], internal_state[STATE.y])
    speed = internal_state[STATE.speed] if kinematics.speed != 0.0 else 0.0
    at = ring(part, tables, kinematics, x, 0.0j, speed)
    if kinematics.speed == 0.0:  # nothing carries it, and nothing turns it
        store_ring(internal_state, x, 0.0j, speed)
        return at
    step = 1.0 / abs(kinematics.speed)
    for _ in range(_REST_STEPS):
        response = _led(at, 1.0, 0.0)
        is_near = modulus(response.moved) <= _NEAR * part.clearance
        is_near = is_near and abs(response.turned) <= _NEAR * abs(kinematics.speed)
        if is_near:
            x += response.moved
        else:
            response = _led(at, step, 1.0)
            x += response.moved * (step * _within(part, step * modulus(response.moved)))
        speed += response.turned
        at = ring(part, tables, kinematics, x, 0.0j, speed)
        if is_near:
            break
        step *= 2.0
    store_ring(internal_state, x, 0.0j, speed)
    return at


@jit
def ring_over_step(part, tables, kinematics, weights, free, internal_state):
    """Fill in the states at the end of a step, by Newton's method in the ring's velocity and speed;
    return the force on the journal and its derivatives p, q as `Law.tangent` does."""
    b = weights.rate
    by_d, by_v = complex(weights.displacement, 0.0), complex(weights.velocity, 0.0)
    x_before = complex(free[STATE.x], free[STATE.y])
    before = complex(free[STATE.vx], free[STATE.vy])
    v, speed = before, free[STATE.speed]
    mass, inertia = part.ring_mass / b, part.ring_inertia / b
    fast = abs(kinematics.speed) + abs(speed)
    quick = part.clearance * fast + modulus(kinematics.velocity) + modulus(before)
    force = p = q = 0.0j
    for _ in range(_STEPS):
        at = ring(part, tables, kinematics, x_before + b * v, v, speed)
        response = ring_response(
            *(at.inner, at.outer, by_d, by_v, b + 0.0j, 1.0 + 0.0j, mass + 0.0j, inertia + 0.0j),
            at.force - mass * (v - before),
            at.torque - inertia * (speed - free[STATE.speed]),
        )
        size = modulus(response.moved)
        share = _within(part, b * size)
        v += share * response.moved
        speed += share * response.turned
        force = at.inner.force + share * response.force
        p, q = response.matrix.aa, response.matrix.ab
        if size <= _NEAR * quick and abs(response.turned) <= _NEAR * fast:
            break
    store_ring(internal_state, x_before + b * v, v, speed)
    return force, p, q


@jit
def ring_rates(part, at, out):
    """Fill in the rates of the states of a `Ring`."""
    gain = at.force * (1.0 / part.ring_mass)
    store_ring(out, at.velocity, gain, at.torque / part.ring_inertia)


@jit
def _store_slopes(part, slopes, place, force, torque):
    """Fill in how rates change with a state, from the change of the ring's force and torque."""
    slopes.by_states[STATE.vx, place] = force.real / part.ring_mass
    slopes.by_states[STATE.vy, place] = force.imag / part.ring_mass
    slopes.by_states[STATE.speed, place] = torque / part.ring_inertia


@jit_not_inlined
def linearize_ring(part, tables, kinematics, internal_state, solved, slopes):
    """Return the force on the journal and its tangents, and fill in the `StateSlopes`: the
    `Law.linearize` of a bearing with a floating ring."""
    at = ring_of_states(part, tables, kinematics, internal_state, True)
    ring_rates(part, at, slopes.rates)
    slopes.by_states[:5, :5] = 0.0
    slopes.by_states[STATE.x, STATE.vx] = slopes.by_states[STATE.y, STATE.vy] = 1.0
    for by_v in range(2):
        by_d, moves = complex(1 - by_v, 0.0), complex(by_v, 0.0)
        inner, outer = stiffness(at.inner, by_d, moves), stiffness(at.outer, by_d, moves)
        # of a real number that changes by g a + conj(g) conj(a) with z = a
        driven = torque_by(at.inner, 1.0, inner, by_d)[0]
        braked = torque_by(at.outer, -1.0, outer, by_d)[0]
        of_journal = slopes.by_v if by_v else slopes.by_d
        gain = -1.0 / part.ring_mass
        of_journal[STATE.x] = of_journal[STATE.y] = 0.0j
        of_journal[STATE.vx] = scaled(gain, inner.aa.conjugate() + inner.ab)
        of_journal[STATE.vy] = scaled(gain, 1j * (inner.aa.conjugate() - inner.ab))
        of_journal[STATE.speed] = scaled(2.0 / part.ring_inertia, driven.conjugate())
        for i in range(2):  # the ring's own motion, along x and y
            e = 1j if i else 1.0 + 0.0j
            of_inner = inner.aa * e + inner.ab * e.conjugate()
            of_outer = outer.aa * e + outer.ab * e.conjugate()
            place = 2 * by_v + i
            slopes.force[place] = -of_inner
            torque = -2.0 * ((driven + braked) * e).real
            _store_slopes(part, slopes, place, of_inner + of_outer, torque)
    slopes.force[STATE.speed] = at.inner.turned
    turned = at.inner.z * at.inner.turned.conjugate() + at.outer.z * at.outer.turned.conjugate()
    torque = 0.5 * turned.imag - at.inner.drag - at.outer.drag
    _store_slopes(part, slopes, STATE.speed, at.outer.turned - at.inner.turned, torque)
    return at.inner.force, at.inner.p_d, at.inner.q_d, at.inner.p_v, at.inner.q_v
