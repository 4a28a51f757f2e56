"""A rolling bearing whose outer ring sits in a squeeze film: two bearings in series with the ring's
mass between, against the closed form of centred circular orbits.

Rollers of a linear contact, preloaded, are a spring of half their number times k in every
direction. With the rotor's orbit R, the ring's E, its film's stiffness K(e) and damping C(e):

    R (k_b - M s^2) = M u s^2 + k_b E,    E (k - m s^2 + K + i s C + k_b) = k_b R
"""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import modes, static, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import CouplingOptions, Simulation

import rotor_fmu as rf

from ..integrators.test_sensitivities import Differences, within
from ..toml_text import refusal_of, table
from .films import DAMPER
from .machines import shaft

C, SPEED = 1e-4, 160.0
MASS, RING, BEARING, CAGE, U = 10.0, 1.0, 1e6, 1e5, 0.3 * C  # of both ends together
FILM = 0.05 * MASS * 100.0  # mu R L^3 / c^3 [N.s/m]
VISCOSITY = FILM * C**3 / (2 * DAMPER["journal_radius"] * DAMPER["length"] ** 3)
ROLLERS = {
    **{"count": 10, "pitch_diameter": 0.052, "element_diameter": 0.006, "exponent": 1.0},
    **{"k": BEARING / 10, "c": 1e-3, "clearance": -1e-4},
}
LINEAR = {"kxx": BEARING / 2, "kyy": BEARING / 2, "cxx": 0.0, "cyy": 0.0}


def machine(kind="rolling_bearing", e=U, gravity=1e-5, young=2.1e13, density=1.0, **more):
    """A weightless rotor with a mass amid two such bearings, each in a ring of its own."""
    body = table("[body]", node=2, mass=MASS, I_d=1e-2, I_p=1e-3, e=e)
    light = table("material", young=young, density=density)
    text = f"gravity = {gravity}\n{shaft(0.0, 0.1, 0.2, material=light)}{body}"
    film = {**DAMPER, "viscosity": VISCOSITY, "short": True, **more}
    of_bearing = ROLLERS if kind == "rolling_bearing" else LINEAR
    for node, name in ((1, "left"), (3, "right")):
        cage = {"kx": CAGE / 2, "ky": CAGE / 2, "cx": 0.0, "cy": 0.0}
        text += table("[housing]", name=name, mass=RING / 2, **cage)
        text += table(f"[{kind}]", node=node, housing=name, **of_bearing)
        text += table("[squeeze_film_damper]", **{**film, "node": node, "ring": name})
    return text


def left_of(e, s):
    """The closed form's equation of an orbit e of the ring at a speed s, 0 where it holds [1]."""
    K, D = 2 * FILM * s * e / (1 - e**2) ** 2, math.pi * FILM / (2 * (1 - e**2) ** 1.5)
    dynamic = BEARING - MASS * s**2
    pushed = BEARING * MASS * U * s**2 / dynamic
    held = CAGE - RING * s**2 + BEARING + K + 1j * s * D - BEARING**2 / dynamic
    return np.abs(held) * e * C / abs(pushed) - 1.0


def orbits(s):
    """Orbits of the ring over the clearance, the smallest first."""
    e = np.linspace(1e-3, 0.999, 1_000_001)
    return e[:-1][np.diff(np.sign(left_of(e, s))) != 0]


def _run(text, speed, **options):
    settings = choose("controlled", **{"tolerance": 1e-4, **options})
    return Simulation(parse_rotor(text), settings, speed=speed, warn=lambda _: None)


def _ring(read):
    return read("squeeze_film_damper[1].eccentricity")


@pytest.mark.parametrize("method", ["default", "radau5"])
def test_the_orbit_that_a_rotor_begun_at_rest_comes_to(method):
    small = orbits(SPEED)[0]
    of_method = {"method": method} if method == "radau5" else {}
    run = _run(machine(), SPEED, tolerance=1e-5, **of_method)
    run.advance(3.0, SPEED)
    assert _ring(run.read) == pytest.approx(small, rel=1e-3)
    ring = complex(run.read("housing[1].housing_x"), run.read("housing[1].housing_y"))
    rotor = complex(run.read("body[1].x"), run.read("body[1].y"))
    assert abs(ring) == pytest.approx(small * C, rel=1e-3)
    # what the rotor moves by follows from the ring's orbit and the unbalance, with their angles
    heavy = U * np.exp(1j * SPEED * 3.0)
    expected = (MASS * heavy * SPEED**2 + BEARING * ring) / (BEARING - MASS * SPEED**2)
    assert abs(rotor - expected) < 1e-3 * abs(expected)
    lost = run.read("energy.film_loss")
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_the_other_stable_orbit_is_reached_from_below_the_fold():
    below, above = 120.0, 145.0
    assert (len(orbits(below)), len(orbits(above))) == (1, 3)
    run = _run(machine(), below)
    run.advance(1.0, below)
    run.advance(3.5, below, rate=10.0)
    run.advance(8.0, above, rate=0.0)
    assert _ring(run.read) == pytest.approx(orbits(above)[2], rel=1e-3)


@pytest.mark.slow
def test_all_orbits_and_the_fold_by_harmonic_balance():
    text = machine("linear_bearing", gravity=0.0, young=2.1e15, density=1e-3)
    curve = rf.response(parse_rotor(text), speed=(124.0, 146.0))
    (fold,) = curve.bifurcations
    low, high = (len(orbits(fold.value * (1.0 + by))) for by in (-1e-4, 1e-4))
    assert (fold.kind, low, high) == ("fold", 1, 3)
    for s in (125.0, 145.0):
        found = sorted(curve.at(s), key=lambda p: curve.amplitude(p, "body[1]"))
        assert [p.is_stable for p in found] == ([True] if s < fold.value else [True, False, True])
        for e, point in zip(orbits(s), found, strict=True):
            # the rotor's orbit is the ring's times what holds that over the bearing's stiffness
            film = 2 * FILM * s * e / (1 - e**2) ** 2
            film += 1j * s * math.pi * FILM / (2 * (1 - e**2) ** 1.5)
            expected = abs(CAGE - RING * s**2 + film + BEARING) / BEARING * e * C
            assert curve.amplitude(point, "body[1]") == pytest.approx(expected, rel=1e-4)


def test_linear_answers_of_a_full_film():
    """About its middle a full film is a damper; the ring hangs in its cage's spring."""
    sagged = static(parse_rotor(machine("linear_bearing", full=True, gravity=0.1)), SPEED)
    assert sagged.housing_y == pytest.approx(2 * [-(MASS + RING) * 0.1 / CAGE], rel=1e-5)
    stiff = {"young": 2.1e15, "density": 1e-3, "gravity": 0.0}
    free = parse_rotor(machine("linear_bearing", full=True, **stiff))
    s, D = 140.0, math.pi * FILM
    held = CAGE - RING * s**2 + 1j * s * D + BEARING - BEARING**2 / (BEARING - MASS * s**2)
    ring = BEARING * MASS * U * s**2 / (BEARING - MASS * s**2) / held
    ring_response = unbalance_response(free, [s])
    assert np.abs(ring_response.housing_x) == pytest.approx(abs(ring), rel=1e-5)
    both = np.polymul([MASS, 0.0, BEARING], [RING, D, CAGE + BEARING])
    roots = np.roots(np.polysub(both, [BEARING**2]))
    known = modes(free, 0.0).eigenvalues
    nearest = [np.abs(known - root).min() / abs(root) for root in roots if root.imag > 0]
    assert max(nearest) < 1e-5


def test_fmus_have_the_bits_of_the_simulation(machine_of):
    text = machine(e=0.1 * U, young=2.1e11)
    names = ("body[1].x", "housing[2].housing_y", "squeeze_film_damper[2].fx")
    simulation = _run(text, SPEED)
    with machine_of(text).start(speed=SPEED, tolerance=1e-4) as run:
        for i in range(1, 6):
            run.advance(0.02 * i)
            simulation.advance(0.02 * i, SPEED)
            assert run.read(*names) == [simulation.read(name) for name in names]


def test_component_modes_keep_the_rings():
    """All of a machine's component modes are the machine."""
    text = machine(young=2.1e11)
    whole, few = (_run(text, SPEED, reduction=n) for n in (0, 100))
    for run in (whole, few):
        run.advance(0.2, SPEED)
    assert _ring(few.read) == pytest.approx(_ring(whole.read), rel=1e-3)


@pytest.mark.parametrize("speed", [SPEED])
def test_sensitivities(speed):
    text = machine("linear_bearing", young=2.1e11, e=0.5 * U, stiffness=1e4)
    made = Differences(parse_rotor(text), speed, 30, coupling=CouplingOptions(True))
    read = ("body[1].x", "body[1].y", "squeeze_film_damper[2].fx", "housing[1].housing_y")
    assert not within(made.errors(read, range(1, made.inputs), 1e-2), 1e-6)


def test_growing_whirls_are_found():
    """A cross coupling that the films hold down to a threshold: the survey at the start agrees with
    the modes."""
    for cross, grows in ((2e3, False), (2e5, True)):
        text = machine("linear_bearing", full=True, e=0.0, young=2.1e11)
        text += table("[linear_bearing]", node=2, **CROSS, kxy=cross, kyx=-cross)
        rotor = parse_rotor(text)
        assert (modes(rotor, SPEED).eigenvalues.real.max() > 0.0) == grows
        warnings = []
        Simulation(rotor, choose("robust"), speed=SPEED, warn=warnings.append)
        assert any(m.code == "unstable" for m in warnings) == grows


CROSS = {"kxx": 1.0, "kyy": 1.0, "cxx": 0.0, "cyy": 0.0}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"ring": "lft"}, ".ring = 'lft': no housing of that name; there is left, right; did you"),
        ({"ring": "right"}, ".ring = 'right': must be the housing of a bearing at node 1"),
        ({"housing": "left"}, ".ring = 'left': must differ from squeeze_film_damper[1].ho"),
    ],
)
def test_a_ring_that_cannot_be_is_refused(change, message):
    text = machine()
    old = table("[squeeze_film_damper]", **_film(ring="left"))
    assert old in text
    changed = table("[squeeze_film_damper]", **_film(**{"ring": "left", **change}))
    assert refusal_of(text.replace(old, changed)).startswith(f"squeeze_film_damper[1]{message}")


def _film(**more):
    return {**DAMPER, "viscosity": VISCOSITY, "short": True, "node": 1, **more}
