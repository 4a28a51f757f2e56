"""Rotors in journal bearings whose pads tilt, in motion."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.linear import (
    LinearError,
    modes,
    static,
    unbalance_response,
)
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.linear.frequency_response import frequency_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.periodic.laws import LawsAlongMotion
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from ..toml_text import table
from .driven import of_both
from .films import OF_A_FILM, heavy_shaft
from .stated_law import StatedLaw

_BETWEEN = tuple(math.pi / 4 + i * math.pi / 2 for i in range(4))
_SPEED = 100.0


def _pads(node, **more):
    """A bearing of four pads, the load between them, as a table of a machine file."""
    shape = {"pads": [round(angle, 9) for angle in _BETWEEN], "arc": 1.4, "preload": 0.3}
    given = {**OF_A_FILM, **shape, **more}
    return table("[journal_bearing]", node=node, length=0.05, tilting=True, **given)


def _in_pads(e=0.0, **more):
    return parse_rotor(heavy_shaft(e) + _pads(1, **more) + _pads(3, **more))


def _run(rotor, speed, tolerance=1e-3, **options):
    settings = choose("controlled", tolerance=tolerance)
    return Simulation(rotor, settings, speed=speed, warn=lambda _: None, **options)


def _place(run):
    return complex(run.read("body[1].x"), run.read("body[1].y"))


@pytest.mark.parametrize("inertia", [0.0, 2e-3])
def test_a_pivot_displaced_inwards_returns_nearly_at_once(inertia):
    """By a millionth of the damping of a film as thick as the clearance, as no film holds it;
    all else is as of one that has returned, with all derivatives."""
    rotor = _in_pads(pad_inertia=inertia, pivot_stiffness=1e8)
    laws, part = LawsAlongMotion(assemble(rotor), np.array([0])), rotor.parts[-1]
    c, end = part.clearance, laws.states // 4 - 1
    returns = 1e14 * (c / part.journal_radius) ** 3 / (part.viscosity * part.length)
    back = c * np.random.default_rng(4).uniform(0.0, 0.1, (1, laws.states))
    back[0, end] = 0.0
    inwards = back - 1e-3 * c * (np.arange(laws.states) == end)
    d, v, scale = np.array([[2e-5, -3e-5]]), np.array([[3e-4, 1e-3]]), laws.state_scales(_SPEED)
    returned, seen = (laws.tangents(d, v, own, scale, _SPEED) for own in (back, inwards))
    assert np.abs(returned.force).max() > 100.0
    returned.rates[0, end] += 1e-3 * c * returns
    returned.by_states[..., end] = returned.rates_by_states[..., end] = 0.0
    returned.rates_by_states[0, end, end] = -returns
    for of_seen, expected in zip(seen, returned, strict=True):
        np.testing.assert_allclose(of_seen, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("inertia", "pivot"),
    [
        *((0.0, 0.0), (1e-3, 1e8)),
        *(pytest.param(*each, marks=pytest.mark.slow) for each in ((1e-3, 0.0), (0.0, 1e8))),
    ],
)
def test_a_run_begins_at_the_static_position_and_comes_back_to_it(inertia, pivot):
    rotor = _in_pads(pad_inertia=inertia, pivot_stiffness=pivot)
    run = _run(rotor, 500.0)
    rest = _place(run)
    film = bearing_curves(rotor, [500.0])
    journal = complex(run.motion.q[0])
    assert journal == pytest.approx(complex(film.x[0], film.y[0]), abs=1e-7 * film.clearance)
    run.advance(0.05, 500.0)
    assert abs(_place(run) - rest) < 1e-5 * film.clearance
    run.advance(0.052, 500.0, np.array([400.0 + 0j]))
    assert abs(_place(run) - rest) > 5e-3 * film.clearance
    run.advance(1.5, 500.0, np.array([0j]))
    assert abs(_place(run) - rest) < 1e-4 * film.clearance
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert abs(run.read("energy.residual")) < 1e-4 * lost
    tilts = [run.read(f"journal_bearing[1].tilt_{i}") for i in range(1, 5)]
    # mirrored in the line of the load, and the lower ones wedge against the rotation
    assert all(abs(tilt) < 2e-3 for tilt in tilts)


def test_pads_without_preload_hold_a_journal_off_their_middle():
    """In it they have no stiffness."""
    rotor = _in_pads(preload=0.0)
    film = bearing_curves(rotor, [500.0])
    # a body of 40 kg and a light shaft of 0.157 kg
    weight = rotor.gravity * (40.0 + 100.0 * 0.2 * 0.25 * math.pi * 0.1**2)
    assert film.load[0][1] == pytest.approx(-0.5 * weight, rel=1e-6)
    assert film.x[0] == pytest.approx(0.0, abs=1e-3 * film.clearance)
    journal = complex(_run(rotor, 500.0).motion.q[0])
    assert journal == pytest.approx(complex(film.x[0], film.y[0]), abs=1e-6 * film.clearance)


@pytest.mark.parametrize("speed", [57.0355, 57.0378, 57.06])
def test_a_journal_rests_where_the_film_of_a_pad_begins_to_carry(speed):
    """From there on its force is as the root of the displacement: tangents lead to and fro."""
    pads = [1.5 * math.pi + i * 0.4 * math.pi for i in range(5)]
    result = static(_in_pads(pads=pads, arc=1.0, preload=0.3), speed)
    assert result.load_y[0] == pytest.approx(result.load_y[1], rel=1e-9)


def test_without_gravity_pads_without_preload_are_said_to_lack_stiffness_not_to_be_too_few():
    rotor = replace(_in_pads(preload=0.0), gravity=0.0)
    with pytest.raises(LinearError) as refused:
        static(rotor, 0.0)
    said = str(refused.value)
    assert "2 bearings and supports have no stiffness" in said
    assert "gravity is 0" in said
    assert "at least 2" not in said


@pytest.mark.parametrize("seconds", [0.05, pytest.param(0.3, marks=pytest.mark.slow)])
def test_pads_are_stable_far_beyond_the_whip_of_pads_that_stand(seconds):
    standing = {"pads": [0.785398163, 2.35619449, 3.926990817, 5.497787144], "arc": 1.4}
    stands = "".join(
        table("[journal_bearing]", node=n, length=0.05, **OF_A_FILM, **standing, preload=0.3)
        for n in (1, 3)
    )
    fixed, rotor = parse_rotor(heavy_shaft() + stands), _in_pads()
    threshold = bearing_curves(fixed, np.linspace(200.0, 1500.0, 5)).threshold
    assert threshold is not None
    speed = 3.0 * threshold
    assert modes(fixed, speed).eigenvalues.real.max() > 0
    assert modes(rotor, speed).eigenvalues.real.max() < 0
    assert bearing_curves(rotor, np.linspace(200.0, speed, 3)).threshold is None
    sizes = []
    for machine in (fixed, rotor):
        run = _run(machine, speed, 1e-2)
        rest = _place(run)
        run.advance(1e-3, speed, np.array([100.0 + 0j]))
        run.advance(seconds, speed, np.array([0j]))
        sizes.append(abs(_place(run) - rest))
    assert sizes[1] < 1e-3 * sizes[0]


def test_an_unbalanced_rotor_whirls_as_the_linear_answer_says():
    """Whose coefficients are reduced at the frequency of rotation, which is the whirl's."""
    rotor = _in_pads(e=2e-7)
    linear = unbalance_response(rotor, [400.0])
    run = _run(rotor, 400.0, 1e-4)
    run.advance(0.12, 400.0)
    assert run.read("body[1].x_1x") == pytest.approx(abs(linear.x[0, 1]), rel=1e-2)
    assert run.read("body[1].y_1x") == pytest.approx(abs(linear.y[0, 1]), rel=1e-2)


@pytest.mark.parametrize(
    "shares", [[0.5, 1.0], pytest.param([0.2, 0.5, 1.0, 2.0], marks=pytest.mark.slow)], ids=len
)
@pytest.mark.parametrize(("inertia", "pivot"), [(0.0, 0.0), (2e-3, 0.0), (2e-3, 5e8)])
def test_a_force_at_any_frequency_is_answered_by_pads_that_follow_at_it(inertia, pivot, shares):
    """A rigid rotor amid two bearings, whose pads' states are unknowns of their own beside x and y,
    linearized by differences."""
    pads = {"pad_inertia": inertia, "pivot_stiffness": pivot}
    text = heavy_shaft(young=2.1e14) + _pads(1, **pads) + _pads(3, **pads)
    speed, rotor = 400.0, parse_rotor(text)
    film = BearingAlone(dict(rotor.named_parts())["journal_bearing[1]"], speed)
    mass = 40.0 + 100.0 * 0.2 * 0.25 * math.pi * 0.1**2
    d = film.rest(-0.5j * mass * rotor.gravity)
    law, n = StatedLaw(film), 4
    each = law.count // n
    rest = np.zeros(law.count)
    rest[::each] = film.tilts(d).real
    if pivot:
        rest[each - 1 :: each] = film.tilts(d).imag
    size = 1e-4 * film.part.clearance
    scales = n * [size, *([size * speed] if inertia else []), *([size] if pivot else [])]
    K, C = film.coefficients(d)  # of pads that follow at the speed
    frequencies = np.array(shares) * speed
    answer = frequency_response(rotor, frequencies, 2, [2], speed=speed).receptance[:, 0]
    for w, seen in zip(frequencies, answer, strict=True):
        followed = law.vibration(d, rest, w, size, scales)
        expected = np.linalg.inv(-(w**2) * mass * np.eye(2) - 2.0 * followed)
        np.testing.assert_allclose(seen, expected, atol=2e-3 * np.abs(expected).max())
        off = np.abs(followed + K + 1j * w * C).max() / np.abs(followed).max()
        assert (off < 1e-3) == (w == speed)


def test_ledger_closes_as_pads_are_rubbed():
    rotor = _in_pads(e=2e-6, k=1e8, roughness=1e-5)
    run = _run(rotor, 0.0, 1e-2)
    assert run.read("journal_bearing[1].contact") == 1.0
    run.advance(0.4, 0.0, rate=600.0)
    assert run.read("journal_bearing[1].contact") == 0.0
    assert run.read("energy.friction_loss") > 0
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert abs(run.read("energy.residual")) < 1e-4 * lost


@pytest.mark.parametrize(
    "more",
    [{}, pytest.param({"pad_inertia": 1e-3, "pivot_stiffness": 5e8}, marks=pytest.mark.slow)],
)
def test_ledger_closes_as_a_load_presses_a_journal_on_its_pads_at_speed(more):
    run = _run(_in_pads(e=2e-6, k=1e8, roughness=1e-5, **more), 300.0, 3e-4)
    run.advance(0.002, 300.0)
    run.advance(0.01, 300.0, np.array([-1e5j]))
    assert run.read("journal_bearing[1].contact") == 1.0
    run.advance(0.04, 300.0, np.array([0j]))
    assert run.read("journal_bearing[1].contact") == 0.0
    assert run.read("energy.friction_loss") > 0
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_fmu_has_the_bits_of_the_simulation(machine_of):
    """The FMU in Python and the native one, pads with inertia and without."""
    text = heavy_shaft(1e-5) + _pads(1, k=1e8) + _pads(3, pad_inertia=1e-3, pivot_stiffness=5e8)
    names = ("journal_bearing[1].fx", "journal_bearing[1].tilt_3", "journal_bearing[2].tilt_4")
    names = (*names, "journal_bearing[2].film", "journal_bearing[2].pivot_3", "energy.pads")
    of_fmu, of_simulation = of_both(machine_of, text, names, 500.0)
    assert of_fmu == of_simulation
