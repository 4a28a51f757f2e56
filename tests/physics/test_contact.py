"""The clearance-bearing law: hand-worked cases, signs, symmetries, tangents."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts import LAWS, clearance_contact
from rotor_fmu.model.parts.clearance_contact import CLEARANCE_CONTACT
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.structure.assembly import assemble

BEARING = assemble(rig()).laws[LAWS.index(CLEARANCE_CONTACT)][0]
S, K, C, MU = BEARING.clearance, BEARING.k, BEARING.c, BEARING.mu
DELTA_C, V_S, R = BEARING.delta_c, BEARING.v_s, BEARING.journal_radius

# penetrations [m] and sliding speeds [m/s] of every branch of the law
RAMP, FULL = (0.05 * DELTA_C, 0.95 * DELTA_C), (1.05 * DELTA_C, 20 * DELTA_C)
STICKING, SLIDING = 0.5 * V_S, 3000 * V_S
BRANCHES = {
    "ramp, sticking": (RAMP, STICKING),
    "ramp, sliding": (RAMP, SLIDING),
    "full damping, sticking": (FULL, STICKING),
    "full damping, sliding": (FULL, SLIDING),
}


def contact_force(part, d, d_dot, omega):
    """Force, normal force, penetration, its rate and sliding speed."""
    result = interpreted(clearance_contact.contact_force)(
        part, Kinematics(d, d_dot, omega, omega, 0.0)
    )
    return result.force, result.normal, result.penetration, result.rate, result.sliding


def contact_tangent(part, d, d_dot, omega, by_position, by_velocity):
    """Force and tangent (p, q) of the law, which has no states of its own."""
    none = np.zeros(0)
    kinematics, weights = (
        Kinematics(d, d_dot, omega, omega, 0.0),
        Weights(by_position, by_velocity, 0.0),
    )
    return interpreted(CLEARANCE_CONTACT.tangent)(part, none, kinematics, weights, none, none)


def force_at(penetration, rate=0.0, sliding=0.0, angle=-math.pi / 2):
    """The law at a penetration [m], its rate and the journal's sliding [m/s], without spin."""
    e = cmath.exp(1j * angle)
    return contact_force(BEARING, (S + penetration) * e, complex(rate, sliding) * e, 0.0)


def states(penetrations, sliding, seed=0, count=100):
    """Random d, d', omega with their penetration and sliding speed in given bounds."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        e = cmath.exp(1j * rng.uniform(0, 2 * math.pi))
        omega = rng.uniform(-400, 400)
        v_t = rng.uniform(-sliding, sliding)
        d = (S + rng.uniform(*penetrations)) * e
        yield d, complex(rng.uniform(-0.05, 0.3), v_t - R * omega) * e, omega


def all_states(count=100):
    for seed, (penetrations, sliding) in enumerate(BRANCHES.values()):
        yield from states(penetrations, sliding, seed, count)


@pytest.mark.parametrize("angle", [0.0, 1.0, 3.0, -1.5])
def test_there_is_no_force_inside_the_clearance_however_fast(angle):
    e = cmath.exp(1j * angle)
    force, normal, delta, *_ = contact_force(BEARING, 0.999 * S * e, (2 + 1j) * e, 400.0)
    assert force == 0
    assert normal == 0
    assert delta == pytest.approx(-0.001 * S)


def test_a_journal_at_the_very_centre_feels_nothing():
    assert contact_force(BEARING, 0j, 1 + 1j, 400.0)[0] == 0
    assert contact_tangent(BEARING, 0j, 1 + 1j, 400.0, 1.0, 1.0) == (0, 0, 0)


def test_resting_at_the_bottom_without_spin_is_carried_straight_up():
    force, normal, delta, rate, sliding = force_at(3e-7)
    assert normal == pytest.approx(K * 3e-7)
    assert force == pytest.approx(1j * K * 3e-7)
    assert delta == pytest.approx(3e-7)
    assert (rate, sliding) == (0, 0)


@pytest.mark.parametrize("omega", [300.0, -300.0])
def test_at_the_bottom_friction_drives_the_journal_against_its_surface_motion(omega):
    force, normal, *_, sliding = contact_force(BEARING, -1j * (S + 3e-7), 0j, omega)
    # counter-clockwise spin moves the lowest point of the journal to +x
    assert sliding == pytest.approx(R * omega)
    assert force.imag == pytest.approx(normal)
    assert force.real == pytest.approx(-math.copysign(MU * normal, omega), rel=1e-6)


def test_friction_at_the_smoothing_speed_is_coulombs_over_root_two():
    force, normal, *_ = force_at(3e-7, sliding=V_S, angle=0.0)
    assert force == pytest.approx(-normal * complex(1, MU / math.sqrt(2)))


def test_approach_adds_the_full_damping_beyond_its_depth():
    assert force_at(3 * DELTA_C, rate=0.1)[1] == pytest.approx(K * 3 * DELTA_C + C * 0.1)


def test_damping_grows_in_proportion_to_the_penetration():
    for share in (0.25, 0.5, 1.0):
        added = force_at(share * DELTA_C, rate=0.1)[1] - force_at(share * DELTA_C)[1]
        assert added == pytest.approx(share * C * 0.1)


def test_a_fast_retreat_pulls_not():
    force, normal, *_ = force_at(3e-7, rate=-2 * K * 3e-7 / C)
    assert force == 0
    assert normal == 0


def test_the_force_vanishes_with_the_penetration():
    for rate in (-1.0, 1.0):
        for penetration in (1e-9, 1e-12, 1e-15):
            largest = (K + C * abs(rate) / DELTA_C) * penetration * math.hypot(1, MU)
            # the penetration itself is known to the rounding of the clearance
            assert abs(force_at(penetration, rate, 1.0)[0]) <= largest * (1 + 1e-4) + 1e-9


def test_the_wall_never_pulls_the_journal_outwards():
    for d, d_dot, omega in all_states():
        force, normal, *_ = contact_force(BEARING, d, d_dot, omega)
        assert normal >= 0
        assert (force * d.conjugate()).real / abs(d) == pytest.approx(-normal)


def test_friction_and_damping_only_dissipate():
    for d, d_dot, omega in all_states():
        force, normal, delta, rate, sliding = contact_force(BEARING, d, d_dot, omega)
        e = d / abs(d)
        friction = force + normal * e
        surface = (rate + 1j * sliding) * e  # of the journal at the point of contact
        assert (friction.conjugate() * surface).real <= 1e-12 * abs(force)
        assert (normal - K * delta) * rate >= 0
        assert abs(friction) <= MU * normal * (1 + 1e-9)


def test_the_law_is_the_same_in_all_directions():
    rng = np.random.default_rng(7)
    for d, d_dot, omega in all_states(30):
        turn = cmath.exp(1j * rng.uniform(0, 2 * math.pi))
        force = contact_force(BEARING, d, d_dot, omega)[0]
        turned = contact_force(BEARING, d * turn, d_dot * turn, omega)[0]
        assert turned == pytest.approx(force * turn, rel=1e-6, abs=1e-6)


def test_the_mirrored_law_is_the_law_of_the_mirrored_spin():
    for d, d_dot, omega in all_states(30):
        force = contact_force(BEARING, d, d_dot, omega)[0]
        mirrored = contact_force(BEARING, d.conjugate(), d_dot.conjugate(), -omega)[0]
        assert mirrored == pytest.approx(force.conjugate(), rel=1e-12)


@pytest.mark.parametrize("branch", BRANCHES)
def test_tangents_are_the_derivatives_of_the_force(branch):
    checked = 0
    for d, d_dot, omega in states(*BRANCHES[branch], seed=11):
        _, normal, *_ = contact_force(BEARING, d, d_dot, omega)
        if normal < 1e-3:
            continue
        checked += 1
        # steps small against the ramp and the smoothing speed, large against rounding
        for by_position, by_velocity, step in ((1.0, 0.0, 1e-12), (0.0, 1.0, 1e-7)):
            _, p, q = contact_tangent(BEARING, d, d_dot, omega, by_position, by_velocity)
            for z in (1.0, 1j, 0.6 - 0.8j):
                change = step * z
                ahead, behind = (
                    contact_force(
                        BEARING,
                        d + sign * by_position * change,
                        d_dot + sign * by_velocity * change,
                        omega,
                    )[0]
                    for sign in (1, -1)
                )
                expected = (ahead - behind) / (2 * step)
                scale = K if by_position else C
                assert abs(p * z + q * z.conjugate() - expected) < 2e-5 * scale
    assert checked > 50


def test_tangents_by_position_and_velocity_add():
    for d, d_dot, omega in all_states(10):
        force = contact_force(BEARING, d, d_dot, omega)[0]
        parts = [
            contact_tangent(BEARING, d, d_dot, omega, *weights)[1:]
            for weights in ((1.0, 0.0), (0.0, 1.0))
        ]
        same, *both = contact_tangent(BEARING, d, d_dot, omega, 3.0, 0.5)
        assert same == force
        for whole, by_position, by_velocity in zip(both, *parts, strict=True):
            assert whole == pytest.approx(3 * by_position + 0.5 * by_velocity, rel=1e-9, abs=1e-3)
