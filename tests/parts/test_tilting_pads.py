"""Journal bearings whose pads tilt: against a grid's solution, and their own differences."""

import math

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves.journal_bearing import bearing_curves
from rotor_fmu.model.film.bearing_film import bearing_of
from rotor_fmu.model.film.tilting_pads import pad_balance
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone, critical_mass
from rotor_fmu.model.linear.subsynchronous import subsynchronous_whirl
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.law import Weights
from rotor_fmu.model.quantities import QuantityError

from .machines import bearings, rigid
from .stated_law import StatedLaw

_PI = math.pi
_BETWEEN = {"pads": tuple(_PI / 4 + i * _PI / 2 for i in range(4)), "arc": math.radians(80)}
_ON_PAD = {"pads": tuple(1.5 * _PI + i * 0.4 * _PI for i in range(5)), "arc": math.radians(60)}
_SPEED = 100.0


def _part(shape=_BETWEEN, /, **more):
    given = {"journal_radius": 0.05, "length": 0.05, "clearance": 1e-4, "viscosity": 0.1}
    part = JournalBearing(**{"node": 1, **given, "preload": 0.3, "tilting": True, **shape, **more})
    part.check("journal_bearing")
    return part


def _load(part, S):
    """The load of a Sommerfeld number mu N L D / W (R / c)^2 [N]."""
    R, L, c = part.journal_radius, part.length, part.clearance
    return part.viscosity * _SPEED / (2 * _PI) * L * 2 * R / S * (R / c) ** 2


# shape, S: y / c, K c / W, C c speed / W, of x and y, of a grid of 120 x 16 a pad
_GRID = [
    (_BETWEEN, 0.3, -0.7159, (2.620, 2.620), (2.035, 2.035)),
    (_BETWEEN, 1.0, -0.3587, (2.202, 2.202), (3.320, 3.320)),
    (_ON_PAD, 0.3, -0.6373, (0.530, 4.941), (0.762, 3.101)),
    (_ON_PAD, 1.0, -0.3930, (1.242, 3.052), (2.304, 3.620)),
]


@pytest.mark.parametrize(("shape", "S", "y", "K_grid", "C_grid"), _GRID)
def test_position_and_reduced_coefficients_against_a_grid(shape, S, y, K_grid, C_grid):
    part = _part(shape)
    load, c = _load(part, S), part.clearance
    film = BearingAlone(part, _SPEED)
    d = film.rest(-1j * load)
    assert film.force(d) == pytest.approx(1j * load, abs=1e-9 * load)
    assert d.imag / c == pytest.approx(y, rel=0.01)
    assert abs(d.real) < 1e-9 * c
    K, C = film.coefficients(d)
    K, C = K * c / load, C * c * _SPEED / load
    np.testing.assert_allclose(np.diag(K), K_grid, rtol=0.02)
    np.testing.assert_allclose(np.diag(C), C_grid, rtol=0.02)
    for matrix in (K, C):  # no cross terms
        assert max(abs(matrix[0, 1]), abs(matrix[1, 0])) < 1e-6 * np.abs(matrix).max()


def _borne(law, d, v):
    """Size of what each pad bears as it was put last [N]."""
    at, balance = (
        (interpreted(bearing_of)(law.record), law.tables, law.alone._moving(d, v)),
        interpreted(pad_balance),
    )
    return np.array([abs(balance(*at, i).force) for i in range(len(law.alone.part.pads))])


def _states(part, count, seed):
    random = np.random.default_rng(seed)
    c = part.clearance
    for _ in range(count):
        d = 0.7 * c * math.sqrt(random.random()) * np.exp(2j * _PI * random.random())
        v = 0.3 * c * _SPEED * complex(*random.normal(size=2))
        yield d, v, c * random.uniform(-0.5, 0.5, len(part.pads)), random


@pytest.mark.parametrize("count", [4, pytest.param(12, marks=pytest.mark.slow)])
@pytest.mark.parametrize("inertia", [0.0, 2e-3])
@pytest.mark.parametrize(
    ("k", "pivot"), [(0.0, 0.0), pytest.param(1e8, 0.0, marks=pytest.mark.slow), (1e8, 3e8)]
)
def test_tangent_of_a_step_is_the_derivative_of_its_force(inertia, k, pivot, count):
    part = _part(
        *(_ON_PAD,),
        pad_inertia=inertia,
        k=k,
        roughness=1.5e-5 if k else 1e-6,
        pivot_stiffness=pivot,
    )
    law = StatedLaw(BearingAlone(part, _SPEED))
    tried = 0
    for d, v, tilts, random in _states(part, count, 1):
        columns = [tilts]
        if inertia:
            columns.append(part.clearance * _SPEED * random.normal(size=len(tilts)))
        if pivot:
            columns.append(part.clearance * random.uniform(0.0, 0.1, len(tilts)))
        free = np.column_stack(columns).ravel()
        b = 10 ** random.uniform(-6, -3)
        weights = Weights(0.5 * b * b, b, b)
        _, _, own = law.step(d, v, weights, free)
        # the states are those of an implicit step, and the force is theirs; a pad that hardly
        # anything presses on may be anywhere between its edges of rupture
        borne = _borne(law, d, v)
        bears = borne > 1e-6 * borne.max()
        assert bears.sum() >= 2
        moved = free + b * law.rates(d, v, own)
        each, atol = len(columns), 1e-9 * part.clearance
        np.testing.assert_allclose(own[::each][bears], moved[::each][bears], atol=atol)
        seen = law.force(d, v, own)
        assert law.step(d, v, weights, free)[0] == pytest.approx(seen, abs=1e-7 * abs(seen))
        assert law.has_tangent(d, v, weights, free, part.clearance, 2e-5)
        tried += 1
    assert tried == count


@pytest.mark.parametrize("pivot", [0.0, 1e9])
def test_a_vibration_is_reduced_as_its_implicit_steps_are(pivot):
    """Pads that follow a harmonic motion of small size: amplitudes of the force by the states'
    own rates, against the reduced coefficients."""
    part = _part(_ON_PAD, pad_inertia=1e-2, pivot_stiffness=pivot)
    film = BearingAlone(part, _SPEED)
    d = film.rest(-1j * _load(part, 0.5))
    K, C = film.coefficients(d)
    law, n, each = StatedLaw(film), len(part.pads), 3 if pivot else 2
    rest = np.zeros(each * n)
    rest[::each] = film.tilts(d).real
    if pivot:
        rest[2::3] = film.tilts(d).imag
    size = 1e-4 * part.clearance
    scales = n * [size, size * _SPEED, size][:each]
    dynamic = -law.vibration(d, rest, _SPEED, size, scales)
    most = np.abs(dynamic).max()
    np.testing.assert_allclose(K, dynamic.real, atol=1e-4 * most)
    np.testing.assert_allclose(_SPEED * C, dynamic.imag, atol=1e-4 * most)
    # which is not what pads without inertia do
    light = BearingAlone(_part(_ON_PAD), _SPEED).coefficients(d)
    assert np.abs(light[0] - K).max() > 1e-3 * most


def test_a_stiff_pivot_is_a_rigid_one():
    """Whose flexibility adds to that of the film, by 1 / stiffness."""
    rigid = BearingAlone(_part(), _SPEED)
    load = _load(rigid.part, 1.0)
    d = rigid.rest(-1j * load)
    K_rigid = rigid.coefficients(d)[0]
    changes = []
    for stiffness in (1e13, 1e12):
        film = BearingAlone(_part(pivot_stiffness=stiffness), _SPEED)
        K = film.coefficients(film.rest(-1j * load, d))[0]
        changes.append(np.abs(K - K_rigid).max() / np.abs(K_rigid).max())
    assert changes[0] < 3.0 * K_rigid[1, 1] / 1e13
    assert changes[1] / changes[0] == pytest.approx(10.0, rel=1e-2)


def test_a_pivot_is_a_spring_in_series_with_the_film_of_its_pad():
    """Two pads without preload bear the load, each 45 degrees beside it: both pivots together are
    as stiff as one, and as much more flexible than rigid ones is the bearing at rest."""
    load, k = 1e4, 3e8
    rests = []
    for stiffness in (0.0, k):
        film = BearingAlone(_part(preload=0.0, pivot_stiffness=stiffness), _SPEED)
        d = film.rest(-1j * load, rests[-1][0] if rests else None)
        rests.append((d, -film.tangent(d, 0j, Weights(1.0, 0.0, 0.0))[1, 1]))
    (d_rigid, K_rigid), (d, K) = rests
    assert 0.2 < k / K_rigid < 5.0
    assert 1.0 / K - 1.0 / K_rigid == pytest.approx(1.0 / k, rel=1e-5)
    assert d - d_rigid == pytest.approx(-1j * load / k, abs=1e-6 * abs(d))
    assert film.tilts(d).imag[2:] == pytest.approx(load / math.sqrt(2) / k, rel=1e-6)
    loads = [0.0, 0.0, load / math.sqrt(2), load / math.sqrt(2)]
    assert film.pad_loads(d) == pytest.approx(loads, abs=1e-6 * load)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"pads": ()}, "tilting = true: needs journal_bearing.pads, which tilt"),
        ({"short": True}, "tilting = true: needs journal_bearing.short = false"),
        ({"offset": 0.0}, "offset = 0: must be between 0 and 1 of a pad that tilts"),
        ({"offset": (0.5, 0.5, 0.5, 1.0)}, "offset = 1: must be between 0 and 1"),
        ({"pads": (0.0,), "arc": 2 * _PI}, "arc = 6.28319 rad: must be at most pi of a pad"),
        ({"pad_inertia": -1.0}, "pad_inertia = -1 kg.m2: must be >= 0 and finite"),
        ({"tilting": 1}, "tilting = 1: must be true or false"),
        (
            {"tilting": False, "pad_inertia": 1e-3},
            "pad_inertia = 0.001 kg.m2: needs journal_bearing.tilting = true",
        ),
        (
            {"tilting": False, "pivot_stiffness": 1e8},
            "pivot_stiffness = 1e+08 N/m: needs journal_bearing.tilting = true",
        ),
        ({"pivot_stiffness": -1.0}, "pivot_stiffness = -1 N/m: must be >= 0 and finite"),
    ],
)
def test_pads_that_cannot_tilt_are_refused(more, message):
    shape = {"pads": (), "arc": 2 * _PI, "preload": 0.0} if more.get("pads") == () else {}
    with pytest.raises(QuantityError) as raised:
        _part(**{**shape, **more})
    assert str(raised.value).startswith("journal_bearing.")
    assert message in str(raised.value)
    assert "\n" not in str(raised.value)


_LIGHT = """
[[journal_bearing]]
node = 2
journal_radius = 0.025
length = 0.02
clearance = 4e-5
viscosity = 0.04
tilting = true
pads = [-1.570796, 0.523599, 2.617994]
arc = 1.5
preload = 0.25
"""
_ALIKE = """
[[journal_bearing]]  # four pads, which are alike in every direction between them
node = 2
journal_radius = 0.04
length = 0.03
clearance = 8e-5
viscosity = 0.02
tilting = true
pads = [0.785398163, 2.356194490, 3.926990817, 5.497787144]
arc = 1.3
preload = 0.2
pivot_stiffness = 1e8
"""


@pytest.mark.parametrize(
    ("film", "speed", "load"),
    [
        (_LIGHT, 1500.0, 3000.0),
        (_LIGHT + "pad_inertia = 4e-5\npivot_stiffness = 7e8\n", 1500.0, 3000.0),
        (_ALIKE, 700.0, 600.0),
    ],
)
def test_the_critical_mass_is_that_of_pads_that_follow_the_whirl(film, speed, load):
    """The coefficients at the frequency of rotation have none: their cross coupling is nearly 0. A
    whirl at a fifth of it makes the pads tilt as they do not at the frequency of rotation."""

    def machine(mass):
        parts = film + bearings(10.0, 1.0)
        return parse_rotor(rigid(mass=mass, gravity=load / mass, parts=parts))

    found = bearing_curves(machine(300.0), [speed], load=load)
    assert critical_mass(found.K[0], found.C[0])[0] == math.inf
    critical, whirl = float(found.critical_mass[0]), float(found.whirl[0])
    for share in (0.99, 1.01):
        seen = subsynchronous_whirl(machine(share * critical), speed)
        assert seen.is_growing == (share > 1.0)
        assert seen.frequency == pytest.approx(whirl, rel=0.01)
