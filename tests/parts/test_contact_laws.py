"""Contact laws: tangents by differences, potentials, the race's own equation."""

import cmath
import math
from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts import clearance_contact, touchdown_bearing
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.parts.touchdown_bearing import TouchdownBearing
from rotor_fmu.model.quantities import QuantityError, quantities
from rotor_fmu.model.structure.assembly import assemble

from .machines import bearings, rigid

CONTACT = {"node": 2, "journal_radius": 0.03, "clearance": 2e-4, "mu": 0.2, "k": 1e8, "c": 500.0}
RACE = {"race_inertia": 1e-4, "race_drag": 0.05, "race_damping": 1e-4}
KINDS = {
    "linear": {},
    "hertz": {"exponent": 1.5, "k": 1e10},
    "stribeck": {"mu_rise": 0.15, "v_stribeck": 0.4},
    "worn": {"wear": 1e-4, "wear_angle": 4.0, "wear_power": 3.0},
    "all": {"exponent": 1.5, "k": 1e10, "mu_rise": 0.1, "wear": 1e-4, "wear_angle": 4.4},
}
TABLES = np.zeros(0)


def interpreted_law(law):
    """A law's functions in Python: they are called a few times each."""
    return replace(
        law, **{field.name: interpreted(getattr(law, field.name)) for field in fields(law)}
    )


CLEARANCE_CONTACT = interpreted_law(clearance_contact.CLEARANCE_CONTACT)
TOUCHDOWN_BEARING = interpreted_law(touchdown_bearing.TOUCHDOWN_BEARING)


def record(kind, **changes):
    """A record of the law of a part."""
    part = kind(**(CONTACT | changes))
    law = part.law
    row = tuple(getattr(part, name) for name in quantities(law.kind))
    return np.array([row], dtype=law.dtype).view(np.recarray)[0]


def force_and_tangent(law, part, motion, weights, free):
    """Force and its tangent's two numbers, the law's states after a step, and their rates."""
    internal_state, rate = free.copy(), np.zeros(len(free))
    seen = law.tangent(part, TABLES, motion, weights, free, internal_state)
    law.rates(part, TABLES, motion, internal_state, rate)
    return seen, internal_state, rate


def states(rng, count):
    """Displacements in contact and velocities, the friction within and beyond its smoothing."""
    for _ in range(count):
        psi = rng.uniform(0, 2 * math.pi)
        d = cmath.rect(3.3e-4 + rng.uniform(0, 1e-5), psi)
        yield d, complex(*rng.normal(size=2)) * rng.choice([1e-3, 0.1])


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("spin", [0.0, 3.0, 200.0])
def test_the_contacts_tangent_is_the_derivative_of_its_force(name, spin):
    part = record(ClearanceContact, **KINDS[name])
    internal_state = np.zeros(0)
    by_d, by_v = 0.7, 40.0
    for d, v in states(np.random.default_rng(1), 20):
        f, p, q = CLEARANCE_CONTACT.tangent(
            part,
            TABLES,
            Kinematics(d, v, spin, spin, 0.0),
            Weights(by_d, by_v, 0.0),
            internal_state,
            internal_state,
        )
        again = CLEARANCE_CONTACT.force(
            part, TABLES, Kinematics(d, v, spin, spin, 0.0), internal_state
        )
        assert f == pytest.approx(again, rel=1e-12)
        for z in (1e-9 + 0j, 1e-9j):
            ahead, behind = (
                CLEARANCE_CONTACT.force(
                    part,
                    TABLES,
                    Kinematics(d + s * by_d * z, v + s * by_v * z, spin, spin, 0.0),
                    internal_state,
                )
                for s in (1, -1)
            )
            expected = (ahead - behind) / 2
            assert p * z + q * z.conjugate() == pytest.approx(expected, rel=1e-4, abs=1e-7)


@pytest.mark.parametrize("name", ["linear", "hertz", "worn"])
@pytest.mark.parametrize("spin", [3.0, 200.0])
def test_the_touchdown_bearings_tangent_lets_the_race_follow(name, spin):
    part = record(TouchdownBearing, **KINDS[name], **RACE)
    law, by_d, by_v, by_rate, free = TOUCHDOWN_BEARING, 0.7, 40.0, 2e-4, np.array([5.0, 0.0])

    def force(d, v):
        motion, weights = Kinematics(d, v, spin, spin, 0.0), Weights(by_d, by_v, by_rate)
        seen, internal_state, rate = force_and_tangent(law, part, motion, weights, free)
        # the race's own equation holds
        assert internal_state[0] - free[0] - by_rate * rate[0] == pytest.approx(0, abs=1e-9)
        again = law.force(part, TABLES, motion, internal_state)
        assert seen[0] == pytest.approx(again, rel=1e-12)
        return seen

    for d, v in states(np.random.default_rng(2), 20):
        _, p, q = force(d, v)
        for z in (1e-9 + 0j, 1e-9j):
            ahead, behind = (force(d + s * by_d * z, v + s * by_v * z)[0] for s in (1, -1))
            expected = (ahead - behind) / 2
            assert p * z + q * z.conjugate() == pytest.approx(expected, rel=1e-4, abs=1e-7)


def test_the_race_alone_slows_down_by_its_drag():
    part = record(TouchdownBearing, **RACE, race_w_s=1e-6)
    free, internal_state, none = np.array([100.0, 0.0]), np.array([100.0, 0.0]), 0j
    b = 1e-3
    TOUCHDOWN_BEARING.tangent(
        part,
        TABLES,
        Kinematics(none, none, 0.0, 0.0, 0.0),
        Weights(1.0, 1.0, b),
        free,
        internal_state,
    )
    expected = (100.0 - b * 0.05 / 1e-4) / (1 + b * 1e-4 / 1e-4)
    assert internal_state[0] == pytest.approx(expected, rel=1e-12)


def test_the_race_follows_a_change_as_small_as_its_guess_is_off():
    """Sensitivities are differences of races whose guess is that of another step."""
    part, motion = record(TouchdownBearing, **RACE), Kinematics(0j, 0j, 0.0, 0.0, 0.0)
    none = np.array([100.0, 0.0])
    weights = Weights(1.0, 1.0, 1e-8)
    _, there, _ = force_and_tangent(TOUCHDOWN_BEARING, part, motion, weights, none)
    off, change = there + np.array([6e-13, 0.0]), np.array([3e-13, 0.0])
    ends = [off.copy(), off.copy()]
    for end, free in zip(ends, (none + change, none - change), strict=True):
        TOUCHDOWN_BEARING.tangent(part, TABLES, motion, weights, free, end)
    assert ends[0][0] - ends[1][0] == pytest.approx(2.0 * change[0], rel=0.1, abs=0.0)


@pytest.mark.parametrize("name", ["linear", "hertz", "worn", "all"])
def test_without_friction_and_damping_the_force_is_that_of_the_energy(name):
    part = record(ClearanceContact, **(KINDS[name] | {"mu": 0.0, "mu_rise": 0.0, "c": 0.0}))
    none = np.zeros(0)
    for d, _ in states(np.random.default_rng(3), 10):
        for z in (1e-9 + 0j, 1e-9j):
            ahead, behind = (
                CLEARANCE_CONTACT.energy(part, TABLES, d + s * z, none)[0] for s in (1, -1)
            )
            f = CLEARANCE_CONTACT.force(part, TABLES, Kinematics(d, 0j, 0.0, 0.0, 0.0), none)
            assert -(f.conjugate() * z).real == pytest.approx(
                (ahead - behind) / 2, rel=1e-4, abs=1e-9
            )


def test_wear_is_deepest_in_its_direction_and_narrow_with_its_power():
    def clearance(psi, **changes):
        part = record(ClearanceContact, wear=1e-4, wear_angle=4.0, **changes)
        return CLEARANCE_CONTACT.gap(part, cmath.rect(1e-5, psi)) + 1e-5

    assert clearance(4.0) == pytest.approx(3e-4)
    assert clearance(4.0 + math.pi) == pytest.approx(2e-4)
    depths = [clearance(4.6, wear_power=p) for p in (1.0, 3.0, 9.0)]
    assert all(wide > narrow > 2e-4 for wide, narrow in pairwise(depths))


@pytest.mark.parametrize("exponent", [1.0, 10 / 9, 1.5], ids=["linear", "a roller", "a ball"])
def test_the_force_is_that_of_the_exponent_of_its_contact(exponent):
    """Hertz: 3/2; Palmgren for the line contact of a cylinder: 10/9."""
    part = record(ClearanceContact, exponent=exponent, k=1e9)
    f = CLEARANCE_CONTACT.force(
        part, TABLES, Kinematics(2.1e-4 + 0j, 0j, 0.0, 0.0, 0.0), np.zeros(0)
    )
    assert f.real == pytest.approx(-1e9 * 1e-5**exponent, rel=1e-9)


def test_stribecks_friction_falls_from_rest_to_sliding():
    part = record(ClearanceContact, mu_rise=0.15, v_stribeck=0.4)

    def ratio(spin):
        f = CLEARANCE_CONTACT.force(
            part, TABLES, Kinematics(2.1e-4 + 0j, 0j, spin, spin, 0.0), np.zeros(0)
        )
        return f.imag / f.real

    assert ratio(0.05 / 0.03) == pytest.approx(
        0.2 + 0.15 * math.exp(-((0.05 / 0.4) ** 2)), rel=1e-3
    )
    assert ratio(5.0 / 0.03) == pytest.approx(0.2, rel=1e-6)


def test_an_exponent_that_no_contact_has_is_refused():
    contact = "[[contact]]\n" + "\n".join(f"{k} = {v}" for k, v in CONTACT.items())
    machine = rigid(parts=bearings(1e4, 10.0) + contact)
    assert assemble(parse_rotor(machine)).interfaces.has_wall.sum() == 1
    with pytest.raises(QuantityError, match=r"contact\[1\].exponent = 0.5: must be from 1 to 3"):
        parse_rotor(machine + "\nexponent = 0.5\n")
