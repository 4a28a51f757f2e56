"""Rolling bearings: their elements' loads, passing, tangent and power, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.parts.rolling_bearing import ROLLING_BEARING, RollingBearing, cage_ratio
from rotor_fmu.model.quantities import QuantityError, quantities
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf

from .driven import of_both

_SHAFT = """
[material]
young = 2.1e11
density = 7850.0
[shaft]
nodes = [0.0, 0.1, 0.2]
diameters = [0.03, 0.03]
eta_v = 1e-5
[[port]]
node = 2
[[body]]
node = 2
mass = 20.0
I_d = 0.05
I_p = 0.08
e = {e}
"""
_BEARING = """
[[rolling_bearing]]
node = {node}
pitch_diameter = 0.052
{more}
"""
_BALLS = "count = 8\nelement_diameter = 0.0119\nk = 8e9\nc = 200.0"
_DAMAGED = f"{_BALLS}\nclearance = -1e-6\nouter_depth = 2e-6\nouter_arc = 0.2"
_IN_BALLS = RollingBearing(
    node=1,
    count=8,
    pitch_diameter=0.052,
    element_diameter=0.0119,
    k=5e9,
    clearance=2e-6,
    outer_depth=1e-6,
    outer_arc=0.5,
    inner_depth=2e-6,
    inner_arc=0.4,
)
_NONE = np.zeros(0)


def _rotor(more=_BALLS, e=0.0, other=None):
    bearings = ((1, more), (3, more if other is None else other))
    text = "".join(_BEARING.format(node=node, more=text) for node, text in bearings)
    return parse_rotor(_SHAFT.format(e=e) + text)


def _run(rotor, speed, tolerance=1e-3, **options):
    return Simulation(
        *(rotor, choose("controlled", tolerance=tolerance)),
        speed=speed,
        warn=lambda _: None,
        **options,
    )


@pytest.mark.parametrize(
    ("more", "factor"),
    [("k = 8e9\nexponent = 1.5", 4.370), ("k = 2e8\nexponent = 1.111111", 4.085)],
)
def test_the_largest_load_is_that_of_the_closed_form_for_many_elements(more, factor):
    """Stribeck's integral for bearings without clearance: factor times the load over the count."""
    count = 120
    rotor = _rotor(f"count = {count}\nelement_diameter = 0.001\n{more}\ncage_angle = -1.570796")
    run = _run(rotor, 0.0)
    load = run.read("rolling_bearing[1].fy")
    assert load == pytest.approx(0.5 * rotor_weight(run), rel=1e-6)
    assert run.read("rolling_bearing[1].largest") == pytest.approx(factor * load / count, rel=5e-3)


def rotor_weight(run):
    """Weight of the shaft with what is on it [N]."""
    return -float(np.sum(run.structure.static_load[::2].imag))


def test_a_ball_passes_as_often_as_the_races_radii_say():
    """8 balls between races of 40.1 and 63.9 mm, and a cage of its own speed."""
    rotor = _rotor()
    run = _run(rotor, 100.0)
    run.advance(0.01, 100.0)
    order = 8 * run.read("rolling_bearing[1].cage") / 100.0
    assert order == pytest.approx(8 * 40.1 / (40.1 + 63.9), rel=1e-6)
    turned = run.read("rolling_bearing[1].cage_angle")
    assert turned == pytest.approx(0.01 * 100.0 * order / 8, rel=1e-9)
    slipping = _run(_rotor(f"{_BALLS}\ncage_ratio = 0.3"), 100.0)
    assert slipping.read("rolling_bearing[1].cage") == pytest.approx(30.0)


@pytest.mark.parametrize(("race", "order"), [("outer", 3.0846), ("inner", 4.9154)])
def test_a_defect_gives_its_line_in_the_spectrum(race, order):
    """Of the outer race Z cage, of the inner one Z (1 - cage): the largest but for its multiples,
    in the torque, which has no direction and so no sidebands."""
    damaged = f"{_BALLS}\nclearance = -3e-6\n{race}_depth = 2e-6\n{race}_arc = 0.2"
    rotor = _rotor(damaged, other=f"{_BALLS}\nclearance = -3e-6")
    speed, every, count = 2.0 * math.pi * 20.0, 1e-3, 1024
    run = _run(rotor, speed, 1e-2)
    run.advance(0.3, speed)
    torque = np.empty(count)
    for i in range(count):
        run.advance(0.3 + every * (i + 1), speed)
        torque[i] = run.read("rolling_bearing[1].torque")
    amplitudes = np.abs(np.fft.rfft((torque - torque.mean()) * np.hanning(count)))
    per_bin = 1.0 / (count * every) / 20.0
    orders = np.arange(len(amplitudes)) * per_bin
    is_near = (orders > 1.5) & (orders < 1.45 * order)
    largest = orders[is_near][np.argmax(amplitudes[is_near])]
    assert abs(largest - order) <= per_bin


def _drawn(rng):
    """A displacement [m], velocity [m/s], speed [rad/s], and the states of a cage and a race."""
    d, v = complex(*rng.normal(0, 8e-6, 2)), complex(*rng.normal(0, 1e-2, 2))
    return d, v, rng.normal(0, 300), rng.uniform(-10, 10, 2)


def _record(part):
    row = tuple(float(getattr(part, name)) for name in quantities(ROLLING_BEARING.kind))
    return np.array([row], ROLLING_BEARING.dtype).view(np.recarray)[0]


@pytest.mark.parametrize("count", [60, pytest.param(300, marks=pytest.mark.slow)])
def test_the_tangent_is_the_derivative_of_the_force(count):
    record, rng = _record(_IN_BALLS), np.random.default_rng(1)
    force, tangent = (interpreted(f) for f in (ROLLING_BEARING.force, ROLLING_BEARING.tangent))
    for _ in range(count):
        d, v, speed, states = _drawn(rng)
        for weights, size in ((Weights(1.0, 0.0, 0.0), 1e-11), (Weights(0.0, 1.0, 0.0), 1e-8)):
            here = Kinematics(d, v, speed, speed, 0.0)
            at, p, q = tangent(record, _NONE, here, weights, states, np.zeros(2))
            assert at == pytest.approx(force(record, _NONE, here, states), rel=1e-12)
            for z in (1.0, 1.0j):
                sides = [
                    force(
                        *(record, _NONE),
                        Kinematics(
                            d + sign * size * z * weights.displacement,
                            v + sign * size * z * weights.velocity,
                            *(speed, speed, 0.0),
                        ),
                        states,
                    )
                    for sign in (1.0, -1.0)
                ]
                seen = (sides[0] - sides[1]) / (2.0 * size)
                assert abs(seen - p * z - q * np.conj(z)) <= 1e-6 * (abs(p) + abs(q))


def test_what_enters_is_stored_or_dissipated():
    """Power of force and torque against the change of the elastic energy along the motion."""
    record, rng = _record(_IN_BALLS), np.random.default_rng(2)
    law = ROLLING_BEARING
    ratio = float(interpreted(cage_ratio)(record))
    loaded = 0
    for _ in range(300):
        d, v, speed, states = _drawn(rng)
        here, lost = Kinematics(d, v, speed, speed, 0.0), np.zeros(1)
        torque = interpreted(law.dissipate)(record, _NONE, here, states, lost)
        f = interpreted(law.force)(record, _NONE, here, states)
        entering = torque * speed - (f * v.conjugate()).real
        dt, turning = 1e-9, np.array([ratio * speed, speed])
        energies = [
            interpreted(law.energy)(record, _NONE, d + s * dt * v, states + s * dt * turning)[0]
            for s in (1.0, -1.0)
        ]
        stored = (energies[0] - energies[1]) / (2.0 * dt)
        size = abs(torque * speed) + abs(f * v.conjugate()) + lost[0]
        assert abs(entering - stored - lost[0]) <= 1e-6 * size
        assert lost[0] >= 0.0
        loaded += size > 0.0
    assert loaded > 200


@pytest.mark.parametrize("settings", [{"tolerance": 1e-4}, {"tolerance": 1e-5, "method": "radau5"}])
def test_the_ledger_closes_over_a_run_with_a_defect(settings):
    """Of the drive's work: what the balls store and give back is far more than they dissipate.
    Steps of order five that keep the same tolerance are fewer, and the balls' forces have corners.
    """
    run = Simulation(
        *(_rotor(_DAMAGED, e=2e-5), choose("controlled", **settings)),
        speed=150.0,
        warn=lambda _: None,
    )
    run.advance(0.1, 150.0)
    assert run.read("energy.contact_loss") > 0.0
    assert abs(run.read("energy.residual")) < 1e-4 * run.read("energy.drive_work")


def test_a_free_rotor_loses_what_its_bearings_dissipate_and_store():
    rotor = _rotor(f"{_BALLS}\nclearance = -3e-6", e=2e-5)
    run = _run(rotor, 150.0, 1e-4, drive_torque=0.0)
    names = ("kinetic", "elastic", "compression", "gravity")
    before = sum(run.read(f"energy.{name}") for name in names)
    run.advance(0.2, 0.0)
    lost = run.read("energy.contact_loss") + run.read("energy.structure_loss")
    change = before - sum(run.read(f"energy.{name}") for name in names)
    assert change == pytest.approx(lost, rel=1e-2)


@pytest.mark.parametrize("across", ["gravity = 0.0", "inclination = 1.5707963"])
def test_a_vertical_shaft_rests_in_the_middle_of_preloaded_bearings(across):
    """Within what rounding leaves of their elements' forces, which balance."""
    bearings = "".join(_BEARING.format(node=n, more=f"{_BALLS}\nclearance = -3e-6") for n in (1, 3))
    run = _run(parse_rotor(f"{across}\n{_SHAFT.format(e=0.0)}{bearings}"), 100.0)
    assert abs(complex(run.read("body[1].x"), run.read("body[1].y"))) < 1e-12 * 3e-6


def test_a_preload_makes_it_as_stiff_as_the_closed_form():
    """K = Z / 2 n k clearance^(n - 1) of a journal in its middle."""
    rotor = _rotor(f"{_BALLS}\nclearance = -5e-6")
    stiffness = 8 / 2 * 1.5 * 8e9 * math.sqrt(5e-6)
    record = _record(rotor.of_kind(RollingBearing)[0])
    here = Kinematics(0j, 0j, 0.0, 0.0, 0.0)
    tangent = interpreted(ROLLING_BEARING.tangent)
    _, p, q = tangent(record, _NONE, here, Weights(1.0, 0.0, 0.0), np.zeros(2), np.zeros(2))
    assert -p.real == pytest.approx(stiffness, rel=1e-12)
    assert abs(q) < 1e-12 * stiffness


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("clearance", [-3e-6, 0.0, 4e-6])
def test_linear_answers_are_those_of_small_motions_about_its_rest(clearance, axis):
    """The lowest mode of each plane against the swing after a push, a ball under the load."""
    rotor = _rotor(f"{_BALLS}\nclearance = {clearance}\ncage_angle = -1.570796")
    found = modes(rotor, 0.0)
    is_along = np.abs((found.x, found.y)[axis][:2, 1]) > 0.5
    frequency = abs(found.eigenvalues[:2][is_along][0])
    run = _run(rotor, 0.0, 1e-4)
    name = f"body[1].{'xy'[axis]}"
    rest = run.read(name)
    run.advance(1e-4, 0.0, np.array([0.02 * 1j**axis]))
    run.advance(2e-4, 0.0, np.array([0j]))
    every, count = 5e-5, 4000
    swing = np.empty(count)
    for i in range(count):
        run.advance(2e-4 + every * (i + 1), 0.0)
        swing[i] = run.read(name) - rest
    rises = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    times = rises + swing[rises] / (swing[rises] - swing[rises + 1])
    seen = 2.0 * math.pi * (len(times) - 1) / ((times[-1] - times[0]) * every)
    assert seen == pytest.approx(frequency, rel=2e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"count": 8.5}, r"b\.count = 8.5: must be a whole number"),
        ({"count": 2}, r"b\.count = 2: must be from 3 to 200"),
        ({"element_diameter": 0.03}, r"b\.element_diameter = 0.03 m: must be at most 0.0198995 m"),
        ({"outer_arc": 7.0}, r"b\.outer_arc = 7 rad: must be > 0 and at most 2 pi"),
        ({"cage_ratio": 1.2}, r"b\.cage_ratio = 1.2: must be from 0 to 1"),
        ({"inner_depth": -1e-6}, r"b\.inner_depth = -1e-06 m: must be >= 0"),
    ],
)
def test_a_bearing_that_cannot_be_is_refused(change, message):
    with pytest.raises(QuantityError, match=message):
        replace(_IN_BALLS, **change).check("b")


@pytest.mark.parametrize("whirl", [False, True])
def test_a_periodic_motion_is_refused_before_it_is_sought(whirl):
    """The cage turns by half of what the inner race does, less the share of the elements' size."""
    parts = (_BEARING.format(node=node, more=_DAMAGED) for node in (1, 3))
    machine = rf.parse(_SHAFT.format(e=2e-6) + "".join(parts))
    ratio = 0.5 * (1 - 0.0119 / 0.052)
    with pytest.raises(
        rf.InputError, match=rf"^rolling_bearing\[1\]: its cage turns {ratio:.4g} "
    ) as no:
        rf.response(machine, speed=(100.0, 1000.0), whirl=whirl)
    assert "\n" not in str(no.value)


def test_fmu_has_the_bits_of_the_simulation(machine_of):
    text = _SHAFT.format(e=1e-5) + "".join(
        _BEARING.format(node=node, more=_DAMAGED) for node in (1, 3)
    )
    names = ("rolling_bearing[1].fx", "rolling_bearing[1].largest", "rolling_bearing[2].torque")
    of_fmu, of_simulation = of_both(machine_of, text, names, 300.0)
    assert of_fmu == of_simulation


def test_an_angular_contact_bearing_is_one_of_radial_quantities_as_the_page_says():
    """The axial preload s and a radial motion d with the velocity v, ball by ball, each compressed
    along the line of its contact, which is inclined by the angle a."""
    K, C, a, s, d, v = 8e9, 200.0, 0.4, 5e-6, 1e-6, 1e-3
    towards = np.cos(2.0 * math.pi * np.arange(8) / 8)
    compressed = d * towards * math.cos(a) + s * math.sin(a)
    normal = K * compressed**1.5 + C * v * towards * math.cos(a)
    part = replace(
        _IN_BALLS,
        outer_depth=0.0,
        inner_depth=0.0,
        k=K * math.cos(a) ** 2.5,
        c=C * math.cos(a) ** 2,
        clearance=-s * math.tan(a),
        contact_angle=a,
    )
    here = Kinematics(complex(d), complex(v), 0.0, 0.0, 0.0)
    force = interpreted(ROLLING_BEARING.force)(_record(part), _NONE, here, np.zeros(2))
    assert abs(force) == pytest.approx(np.sum(normal * towards) * math.cos(a), rel=1e-9)
