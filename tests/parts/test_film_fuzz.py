"""Oil films drawn at random: their loads are finite, they only dissipate, look the same in a mirror
and turned, and change without a jump, as their tangents say."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.parts.law import Weights
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper

from .film_cases import TURN, Bench, drawn, states

BY_D, BY_V = Weights(1.0, 0.0, 0.0), Weights(0.0, 1.0, 0.0)
# Of a force, where the film is a thousand times thinner than the clearance; of one of the film's
# size, where the pad's edge is all that bears.
ROUNDING, OF_EDGE = 1e-8, 1e-12


def seeds(quick, slow):
    """So many seeds in an ordinary run, and so many more in a long one."""
    return pytest.mark.parametrize(
        "seeds", [range(quick), pytest.param(range(quick, slow), marks=pytest.mark.slow)], ids=len
    )


def cases(seeds, of_test, **options):
    """Cases, each with a generator for what else is drawn."""
    for seed in seeds:
        random = np.random.default_rng([of_test, seed])
        yield seed, drawn(random, **options), random


@seeds(20, 1000)
def test_loads_are_finite_and_a_film_takes_more_than_it_gives(seeds):
    """The power that the journal puts into it, torque times speed less F v, is what is dissipated,
    and never negative."""
    tried = 0
    for seed, case, random in cases(seeds, 1):
        bench = Bench(case)
        for d, v in states(random, case, 50):
            seen = bench.outputs(d, v)
            assert all(math.isfinite(value) for value in seen.values()), (seed, d, v, seen)
            # a damper's spring keeps what goes into it
            film = complex(seen["fx"], seen["fy"]) + getattr(case.part, "stiffness", 0.0) * d
            turned, pushed = seen.get("torque", 0.0) * case.speed, (film * v.conjugate()).real
            size = abs(turned) + abs(film * v)
            assert seen["power"] == pytest.approx(turned - pushed, abs=1e-12 * size), (seed, d, v)
            assert seen["power"] >= 0.0, (seed, d, v)
            tried += size > 0.0
    assert tried > 40 * len(seeds)


@seeds(12, 800)
def test_a_force_is_mirrored_in_a_mirror_and_turns_with_the_bearing(seeds):
    """Turned the other way and with its pads mirrored; a plain circle stays as it is."""
    for seed, case, random in cases(seeds, 2):
        angle = random.uniform(0.0, TURN)
        by = cmath.rect(1.0, angle)
        bench, mirrored, turned = map(Bench, (case, case.mirrored(), case.turned(angle)))
        for d, v in states(random, case, 50, case.reach):
            force = bench.force(d, v)
            # beside it that of a journal that does not whirl at half the speed, which is not 0
            size = abs(force) + abs(bench.force(d, v + 1j * case.speed * d))
            most = ROUNDING * size + OF_EDGE * case.viscous
            in_mirror = mirrored.force(d.conjugate(), v.conjugate()).conjugate()
            assert abs(in_mirror - force) <= most, (seed, d, v)
            assert abs(turned.force(d * by, v * by) / by - force) <= most, (seed, d, v)


@seeds(8, 2000)
def test_a_tangent_is_the_derivative_of_the_force(seeds):
    """With the default's elements or more, but where no pressure builds up, which has no
    derivative there. Of several differences the best counts: a rupture that reaches an edge spoils
    the longer ones."""
    tried = 0
    for seed, case, random in cases(seeds, 3, least_points=48):
        film = case.alone()
        for d, v in states(random, case, 3, case.reach):
            if case.entrained(d, v) < 1e-2:
                continue
            moves = {BY_D: film.outputs(d, v)["film"], BY_V: case.part.clearance * case.pace}
            for weights, move in moves.items():
                tangent = film.tangent(d, v, weights)
                size = np.abs(tangent).max()
                errors = (
                    np.abs(slopes(film, d, v, weights, share * move) - tangent).max()
                    for share in (1e-3, 1e-4, 1e-5, 1e-6)
                )
                assert any(error <= 1e-6 * size for error in errors), (seed, d, v, weights)
                tried += size > 0.0
    assert tried > 2 * len(seeds)


def slopes(film, d, v, weights, h):
    """The tangent by differences of fourth order, shape (2, 2)."""
    columns = []
    for z in (1.0, 1j):
        by_d, by_v = h * weights.displacement * z, h * weights.velocity * z
        behind_2, behind, ahead, ahead_2 = (
            film.force(d + s * by_d, v + s * by_v) for s in (-2, -1, 1, 2)
        )
        slope = (8 * (ahead - behind) - (ahead_2 - behind_2)) / (12 * h)
        columns.append([slope.real, slope.imag])
    return np.transpose(columns)


@seeds(4, 600)
def test_a_force_does_not_jump(seeds):
    """Where a rupture passes a pad's edge or another pad takes over, with the default's elements or
    more."""
    for seed, case, random in cases(seeds, 4, least_points=48):
        for name, force in paths(case, random).items():
            assert largest_jump(force) < 1e-6, (seed, name)


def paths(case, random):
    """Forces along ways from 0 to 1: as the journal goes around, as it crosses the film, as its
    velocity turns, and through a whirl at half the speed, where no pressure builds up."""
    bench, reach = Bench(case), case.reach
    d, along, fast = (
        cmath.rect(size, random.uniform(0.0, TURN))
        for size in (reach * random.uniform(0.05, 1.0), 1.0, case.part.clearance * case.pace)
    )
    off = reach * random.uniform(-0.7, 0.7)
    half = math.sqrt(reach**2 - off**2)

    def around(x):
        turned = d * cmath.rect(1.0, TURN * x)
        return bench.force(turned, 0.3j * case.pace * turned)

    def across(x):
        return bench.force(along * complex((2.0 * x - 1.0) * half, off), fast)

    def turning(x):
        return bench.force(d, fast * cmath.rect(1.0, TURN * x))

    def through_half_the_speed(x):
        return bench.force(d, 1j * (0.2 + 0.6 * x) * case.speed * d)

    return {each.__name__: each for each in (around, across, turning, through_half_the_speed)}


def largest_jump(force):
    """The largest change of a force that a shorter and shorter piece of its way from 0 to 1 keeps,
    over its largest value."""
    pieces, largest = odd_pieces(force, 0.0, 1.0, 300)
    changes = []
    for low, high in pieces[:6]:
        for _ in range(7):
            (low, high), *_ = odd_pieces(force, low, high, 10)[0]
        changes.append(abs(force(high) - force(low)))
    return max(changes) / largest if largest > 0.0 else 0.0


def odd_pieces(force, low, high, count):
    """So many equal pieces of a force's way, those first that bend otherwise than their neighbours;
    and the largest force."""
    at = np.linspace(low, high, 2 * count + 1)
    forces = np.array([force(x) for x in at])
    bends = forces[:-1:2] + forces[2::2] - 2.0 * forces[1::2]
    around = np.pad(bends, 1, mode="reflect")
    odd = np.abs(2.0 * bends - around[:-2] - around[2:])
    pieces = [(at[2 * i], at[2 * i + 2]) for i in np.argsort(odd)[::-1]]
    return pieces, np.abs(forces).max()


@pytest.mark.parametrize("place", [1e-4, 0.1234, 0.5, 0.98765])
def test_a_jump_is_seen(place):
    assert largest_jump(lambda x: complex(np.sin(9 * x), x**3)) < 1e-8
    assert largest_jump(lambda x: np.sin(9 * x) + 1e-5 * (x > place)) > 0.9e-5


def test_neighbouring_states_of_24_elements_have_neighbouring_forces():
    """Where the search for the rupture's ends is slow: a film of 1.3 % of its clearance."""
    part = SqueezeFilmDamper(
        node=1,
        journal_radius=0.030374805142955374,
        length=0.08124213442104915,
        clearance=1.8163555616370514e-05,
        viscosity=0.0178973712523934,
        roughness=2.1251098279325406e-07,
        points=24.0,
        stiffness=1e6,
    )
    film, v = BearingAlone(part, 0.0), 0.0030243555395507386 - 0.0045327255936133395j
    forces = [
        film.force(d, v)
        for d in (
            -6.7438623427980455e-06 - 1.6602049693441512e-05j,
            -6.743862345884243e-06 - 1.6602049685172996e-05j,
        )
    ]
    assert abs(forces[1] - forces[0]) < 1e-6 * abs(forces[0])
