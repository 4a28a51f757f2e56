"""The film of a journal bearing: against closed forms, a grid's solution, its own differences."""

import math
from itertools import pairwise

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves.reynolds_2d import film_in_plane
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone, critical_mass
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.law import Weights

from ..toml_text import refusal_of, table
from .films import THRESHOLDS
from .machines import shaft

_PI = math.pi
_GIVEN = {"journal_radius": 0.05, "length": 0.03, "clearance": 1e-4, "viscosity": 0.1}
BY_D, BY_V = Weights(1.0, 0.0, 0.0), Weights(0.0, 1.0, 0.0)
_AXIAL_GROOVES = {"pads": (_PI / 2, 1.5 * _PI), "arc": _PI - math.radians(20)}
_SHAPES = {
    "plain": {},
    "one groove": {"pads": (1.5 * _PI,), "arc": 2 * _PI - 0.3},
    "axial grooves": _AXIAL_GROOVES,
    "lemon": {**_AXIAL_GROOVES, "preload": 0.5},
    "three lobes": {"pads": tuple(_PI / 2 + i * 2 * _PI / 3 for i in range(3)), "arc": 1.8}
    | {"preload": (0.3, 0.4, 0.5)},
    "offset halves": {**_AXIAL_GROOVES, "preload": 0.4, "offset": 1.0},
    "four lobes": {"pads": tuple(_PI / 4 + i * _PI / 2 for i in range(4)), "arc": 1.3}
    | {"preload": 0.5},
}


def _bearing(**values):
    return JournalBearing(**{"node": 1, **_GIVEN, **values})


def test_short_bearing_of_friswell_et_al_5_5_1():
    film = BearingAlone(_bearing(short=True), 1500 * _PI / 30)
    d = film.rest(-525j)
    K, C = film.coefficients(d)
    assert abs(d) / 1e-4 == pytest.approx(0.266298, rel=1e-4)
    # the book's u is our x; the cross terms' signs are those of x right, y up, load downwards
    np.testing.assert_allclose(K, [[12.8080e6, 16.3936e6], [-25.0604e6, 8.8153e6]], rtol=1e-4)
    np.testing.assert_allclose(C, [[232.897e3, -81.924e3], [-81.924e3, 294.912e3]], rtol=1e-4)


@pytest.mark.parametrize(("e", "threshold", "whirl"), THRESHOLDS)
def test_threshold_of_a_rigid_rotor(e, threshold, whirl):
    c, speed = 1e-4, 200.0
    film = BearingAlone(_bearing(short=True), speed)
    force = film.force(e * c)
    mass, frequency = critical_mass(*film.coefficients(e * c * 1j * abs(force) / force))
    # speed sqrt(c / g), where the load is m g
    assert speed * math.sqrt(mass * c / abs(force)) == pytest.approx(threshold, rel=1e-4)
    assert frequency / speed == pytest.approx(whirl, rel=3e-4)


def test_no_threshold_above_an_eccentricity_of_0_756():
    film = BearingAlone(_bearing(short=True), 200.0)
    force = film.force(0.757e-4)
    mass, _ = critical_mass(*film.coefficients(0.757e-4 * 1j * abs(force) / force))
    assert mass == math.inf


def test_a_plain_bearing_without_a_load_whirls_at_half_the_speed():
    """Its film's cross coupling is half its damping times the speed, and drives even no mass."""
    of_film = BearingAlone(_bearing(short=True), 200.0).coefficients(0j)
    K, C = (np.where(np.abs(of) > 1e-9 * np.abs(of).max(), of, 0.0) for of in of_film)
    assert critical_mass(K, C) == (0.0, pytest.approx(100.0, rel=1e-9))


def test_each_mass_is_unstable_where_the_bearing_does_not_even_hold_none():
    """The roots of m s^2 + C s + K: neither a stiffness of negative determinant nor one that pushes
    in both directions has a critical mass that is negative or infinite."""
    C = np.diag([2e4, 3e4])
    for K, critical in (
        ([[1e7, 2e7], [3e7, 1e7]], 0.0),
        ([[-1e7, 0.0], [0.0, 1e7]], 0.0),
        ([[-1e7, 6e7], [-6e7, -2e7]], 0.0),
        ([[1e7, 2e7], [-1e7, 1e7]], None),
        ([[1e7, 2e6], [-2e6, 3e7]], math.inf),
    ):
        mass, _ = critical_mass(np.array(K), C)
        assert mass == critical or (critical is None and 0.0 < mass < math.inf)
        for m in (1e-3, 0.99 * mass, 1.01 * mass, 1e5):
            if 0.0 < m < math.inf:
                inverse = -np.linalg.inv(m * np.eye(2))
                system = np.block([[np.zeros((2, 2)), np.eye(2)], [inverse @ K, inverse @ C]])
                assert (np.linalg.eigvals(system).real.max() < 0.0) == (m < mass)


# L/D, e: S, attitude, K c / W, C c speed / W, of a grid of 360 x 20
_GRID = {
    (1, 0.2): (0.6249, 77.66, (2.125, 4.652, -5.448, 1.192), (9.784, -2.140, -2.140, 10.705)),
    (1, 0.5): (0.1792, 58.68, (2.017, 1.116, -3.208, 1.950), (3.468, -2.110, -2.110, 5.966)),
    (1, 0.8): (0.0448, 36.79, (1.915, -0.472, -3.935, 5.260), (1.586, -2.120, -2.120, 7.009)),
    (0.5, 0.2): (2.0344, 76.14, (2.369, 4.562, -5.642, 1.393), (9.654, -2.381, -2.381, 10.887)),
    (0.5, 0.5): (0.5109, 55.34, (2.143, 0.950, -3.651, 2.524), (3.207, -2.217, -2.217, 6.396)),
    (0.5, 0.8): (0.0919, 32.99, (1.848, -0.553, -4.510, 6.950), (1.314, -2.024, -2.024, 7.711)),
    (0.25, 0.5): (1.7937, 54.13, (2.189, 0.881, -3.868, 2.800), (3.095, -2.238, -2.238, 6.554)),
}


@pytest.mark.parametrize(("ratio", "e"), _GRID)
def test_finite_bearing_against_a_grid(ratio, e):
    S, attitude, K_grid, C_grid = _GRID[ratio, e]
    c, speed, mu = 1e-4, 100.0, 0.1
    film = BearingAlone(_bearing(length=0.1 * ratio), speed)
    force = film.force(e * c)
    load = abs(force)
    # S = mu N L D / W (R / c)^2
    assert mu * speed / (2 * _PI) * 0.01 * ratio / load * 500**2 == pytest.approx(S, rel=0.015)
    assert math.degrees(film.outputs(e * c)["attitude"]) == pytest.approx(attitude, abs=0.3)
    d = e * c * 1j * load / force  # the load downwards
    assert film.force(d) == pytest.approx(1j * load, rel=1e-9)
    K, C = film.coefficients(d)
    K, C = K * c / load, C * c * speed / load
    np.testing.assert_allclose(K.ravel(), K_grid, atol=0.03 * np.abs(K_grid).max())
    np.testing.assert_allclose(C.ravel(), C_grid, atol=0.03 * np.abs(C_grid).max())


@pytest.mark.parametrize(
    ("ratio", "S", "e", "attitude"), [(0.5, 0.917, 0.372, 57.45), (1.0, 0.235, 0.460, 49.27)]
)
def test_axial_grooves_of_lund_and_thomsen(ratio, S, e, attitude):
    speed, length = 100.0, 0.1 * ratio
    load = 0.1 * speed / (2 * _PI) * length * 0.1 / S * 500**2
    film = BearingAlone(_bearing(length=length, **_AXIAL_GROOVES), speed)
    d = film.rest(-1j * load)
    assert abs(d) / 1e-4 == pytest.approx(e, rel=0.06)
    assert math.degrees(film.outputs(d)["attitude"]) == pytest.approx(attitude, rel=0.06)


# shape, rupture, length, e at 0.8 rad below the right: side flow over R c N L of a grid of 160 x 40
_SIDE_FLOWS = [
    ("axial grooves", "reynolds", 0.05, 0.2, 0.8347),
    ("axial grooves", "reynolds", 0.1, 0.6, 1.6441),
    ("axial grooves", "guembel", 0.05, 0.6, 2.3670),
    ("axial grooves", "guembel", 0.1, 0.2, 0.5842),
    ("three lobes", "reynolds", 0.05, 0.6, 2.5863),
    ("three lobes", "guembel", 0.05, 0.2, 1.2960),
]


@pytest.mark.parametrize(("shape", "rupture", "length", "e", "flow"), _SIDE_FLOWS)
def test_what_leaves_at_the_sides_of_pads_against_a_grid(shape, rupture, length, e, flow):
    """What enters a pad less what its ends pass on: the parabola's slope at the sides alone gives
    up to 37 % less."""
    film = BearingAlone(_bearing(length=length, rupture=rupture, **_SHAPES[shape]), 100.0)
    found = film.outputs(e * 1e-4 * np.exp(-0.8j))["flow"]
    assert found == pytest.approx(flow * 0.05 * 1e-4 * 100.0 / (2 * _PI) * length, rel=0.04)


@pytest.mark.parametrize("shape", ["plain", "axial grooves", "four lobes"])
def test_a_short_film_leaves_at_the_sides_by_what_its_pads_narrow(shape):
    """Speed R L / 2 times how much thinner it becomes along each of them, to its edges."""
    part, speed, d = _bearing(short=True, **_SHAPES[shape]), 100.0, 0.4e-4 * np.exp(-0.8j)
    narrowed = 0.0
    for middle in part.pads or (0.0,):
        theta = middle + part.arc * np.linspace(-0.5, 0.5, 10001)
        clearance = part.clearance / (1.0 - part.preload)
        centre = -(clearance - part.clearance) * np.exp(1j * middle)
        h = clearance - ((d - centre) * np.exp(-1j * theta)).real
        narrowed += np.maximum(-np.diff(h), 0.0).sum()
    flow = speed * part.journal_radius * part.length / 2 * narrowed
    assert BearingAlone(part, speed).outputs(d)["flow"] == pytest.approx(flow, rel=1e-6)


# shape, length, e at 0.8 rad below the right: largest pressure over mu w (R / c)^2 of a grid of 241
# x 49, and how much it is exceeded
_PRESSURES = [
    ("axial grooves", 0.05, 0.6, 1.3565, 0.02),
    ("axial grooves", 0.05, 0.9, 24.371, 0.06),
    ("axial grooves", 0.1, 0.6, 3.0401, 0.05),
    ("axial grooves", 0.1, 0.9, 33.883, 0.12),
    ("three lobes", 0.05, 0.6, 1.1594, 0.06),
    ("four lobes", 0.05, 0.6, 1.0267, 0.07),
    ("four lobes", 0.1, 0.6, 1.2743, 0.15),
]


@pytest.mark.parametrize(("shape", "length", "e", "pressure", "excess"), _PRESSURES)
def test_the_largest_pressure_exceeds_that_of_a_grid(shape, length, e, pressure, excess):
    """Along the length it is flatter than a parabola that bears as much."""
    film = BearingAlone(_bearing(length=length, **_SHAPES[shape]), 100.0)
    found = film.outputs(e * 1e-4 * np.exp(-0.8j))["pressure"] / (0.1 * 100.0 * 500.0**2)
    assert pressure < found < (1.0 + excess) * pressure


# shape, length: position over the clearance, K [MN/m], C [kN.s/m] under 2500 N at 3000 rev/min, of
# a grid of 241 x 61 on each pad
_LOBES = {
    ("axial grooves", 0.05): (
        *((0.3856, -0.3341), (43.614, 16.704, -91.816, 71.537)),
        (179.20, -155.23, -155.26, 547.25),
    ),
    ("lemon", 0.05): (
        *((0.7952, -0.3042), (18.220, 2.452, -50.776, 81.892)),
        (62.62, -51.63, -51.64, 316.08),
    ),
    ("lemon", 0.1): (
        *((0.4645, -0.0074), (9.290, 48.272, -60.445, 94.193)),
        (165.73, 125.85, 125.90, 598.91),
    ),
    ("offset halves", 0.05): (
        *((-0.0471, -1.0584), (31.440, -9.769, -65.952, 84.196)),
        (73.74, -105.44, -105.39, 328.43),
    ),
}


@pytest.mark.parametrize(("shape", "length"), _LOBES)
def test_grooves_and_lobes_against_a_grid(shape, length):
    position, K_grid, C_grid = _LOBES[shape, length]
    values = {**_SHAPES[shape]} | ({} if shape == "axial grooves" else {"preload": 0.5})
    bearing = _bearing(length=length, viscosity=0.02, **values)
    film = BearingAlone(bearing, 100 * _PI)
    d = film.rest(-2500j)
    assert abs(d / 1e-4 - complex(*position)) < 0.005
    K, C = film.coefficients(d)
    np.testing.assert_allclose(K.ravel() / 1e6, K_grid, atol=0.015 * np.abs(K_grid).max())
    np.testing.assert_allclose(C.ravel() / 1e3, C_grid, atol=0.01 * np.abs(C_grid).max())

    # the load and the stiffness of another grid, of finite differences, there
    def in_plane(moved=0.0):
        at = 1e-4 * complex(*position) + moved
        return film_in_plane(bearing, 100 * _PI, at, viscosity=bearing.viscosity)

    assert abs(in_plane() - 2500j) < 0.003 * 2500
    by_d = [(in_plane(-2e-7 * way) - in_plane(2e-7 * way)) / 4e-7 for way in (1.0, 1j)]
    K_plane = np.array([[k.real for k in by_d], [k.imag for k in by_d]]) / 1e6
    np.testing.assert_allclose(K_plane.ravel(), K_grid, atol=0.006 * np.abs(K_grid).max())


def _states(count, seed):
    """Bearings of every shape with a journal anywhere that moves in any direction."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        shape = list(_SHAPES.values())[random.integers(len(_SHAPES))]
        part = _bearing(
            length=float(random.uniform(0.02, 0.15)),
            short=bool(random.random() < 0.3),
            points=float(random.choice([12, 24, 48])),
            roughness=3e-6,
            k=float(random.choice([0.0, 1e9])),
            **shape,
        )
        d = 1.02e-4 * math.sqrt(random.random()) * np.exp(2j * _PI * random.random())
        v = 3e-3 * complex(*random.normal(size=2))
        yield BearingAlone(part, float(random.choice([0.0, 100.0, -100.0]))), d, v


@pytest.mark.parametrize("count", [30, pytest.param(120, marks=pytest.mark.slow)])
def test_tangent_is_the_derivative_of_the_force(count):
    for film, d, v in _states(count, 1):
        for weights, h in ((BY_D, 1e-10), (BY_V, 3e-7)):
            by_d, by_v = weights.displacement * h, weights.velocity * h
            seen = []
            for z in (1, 1j):
                change = film.force(d + by_d * z, v + by_v * z) - film.force(
                    d - by_d * z, v - by_v * z
                )
                seen.append([change.real / (2 * h), change.imag / (2 * h)])
            tangent = film.tangent(d, v, weights)
            np.testing.assert_allclose(tangent, np.transpose(seen), atol=2e-6 * abs(tangent).max())


def test_force_does_not_jump_as_the_rupture_moves():
    for name, shape in _SHAPES.items():
        film = BearingAlone(_bearing(length=0.06, points=24.0, **shape), 100.0)
        path = 0.6e-4 * np.exp(1j * np.linspace(0.0, 2 * _PI, 400))
        # around the bearing the force follows its tangent, from each state to the next
        seen = [(d, film.force(d), film.tangent(d, 0j, BY_D)) for d in path]
        for (d, force, tangent), (after, next_force, next_tangent) in pairwise(seen):
            step, change = after - d, next_force - force
            mean = 0.5 * (tangent + next_tangent)
            left = np.array([change.real, change.imag]) - mean @ [step.real, step.imag]
            assert np.abs(left).max() < 2e-4 * abs(force), name


def test_friction_of_a_centred_journal_is_petroffs():
    speed = 100.0
    film = BearingAlone(_bearing(short=True), speed)
    petroff = 2 * _PI * 0.1 * speed * 0.05**3 * 0.03 / 1e-4
    assert film.outputs(0j)["torque"] == pytest.approx(petroff, rel=1e-9)


@pytest.mark.parametrize("speed", [100.0, -100.0])
@pytest.mark.parametrize("more", [{"short": True}, {}], ids=["short", "finite"])
def test_a_synchronous_whirl_dissipates_what_a_journal_at_rest_does(more, speed):
    """In the frame that turns with it the journal rests and its bore turns backward: the same film
    in a mirror."""
    film = BearingAlone(_bearing(**more), speed)
    for e in (0.1, 0.3, 0.6, 0.9):
        d = e * 1e-4 * np.exp(0.7j)
        at_rest, whirling = film.outputs(d, 0j), film.outputs(d, 1j * speed * d)
        assert whirling["power"] == pytest.approx(at_rest["power"], rel=1e-6)


@pytest.mark.parametrize("more", [{"short": True}, {}], ids=["short", "finite"])
def test_no_motion_shears_more_than_a_gap_full_of_oil(more):
    film, random = BearingAlone(_bearing(**more), 100.0), np.random.default_rng(4)
    petroff = 2 * _PI * 0.1 * 100.0 * 0.05**3 * 0.03 / 1e-4
    for e in np.linspace(0.05, 0.95, 30):
        d, v = 1e-4 * e * np.exp(2j * _PI * random.random(2)) * (1.0, 100.0)
        by_force = 0.5 * (d.conjugate() * film.force(d, v)).imag
        sheared = film.outputs(d, v)["torque"] - by_force
        assert 0.5 * petroff < sheared <= petroff / math.sqrt(1 - e**2) * (1 + 1e-9)


def test_a_film_dissipates_what_goes_into_it():
    for film, d, v in _states(60, 2):
        assert film.outputs(d, v)["power"] >= 0.0


def _machine(more):
    """A machine file whose first bearing has these lines beside or in the place of its own."""
    given = {key: value for key, value in _GIVEN.items() if not more.startswith(f"{key} = ")}
    mass = table("[point_mass]", node=2, mass=100.0)
    first, second = (table("[journal_bearing]", node=1, **given), {"node": 3, **_GIVEN})
    films = f"{first}{more}\n{table('[journal_bearing]', **second)}"
    return shaft(0.0, 0.1, 0.2, diameter=0.1) + mass + films


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("length = 0.21", "length = 0.21 m: must be at most 2 diameters, 0.2 m"),
        ("preload = 1.0\npads = [0.0]\narc = 1.0", "preload = 1: must be from 0 to 0.99"),
        ("pads = [0.0, 1.0]\narc = 1.5", "pads: pads 1 and 2 overlap"),
        ("pads = [0.0, 6.0]\narc = 0.6", "pads: pads 1 and 2 overlap"),
        ("arc = 1.0", "pads: is missing; arc, preload and offset need pads"),
        ("offset = 0.2", "pads: is missing; arc, preload and offset need pads"),
        ("pads = [0.0, 3.0]\narc = [1.0]", "arc: 1 given, 2 needed, as many as"),
        ("pads = 1.0\narc = 1.0", "pads = 1.0: must be a list of numbers"),
        ("roughness = 6e-5", "roughness = 6e-05 m: must be below half the clearance, 5e-05 m"),
        ("points = 24.5", "points = 24.5: must be a whole number"),
        ("viscosity = -0.1", "viscosity = -0.1 Pa.s: must be > 0 and finite"),
        ("clearence = 1e-4", "clearence: unknown key; did you mean clearance?"),
    ],
)
def test_bad_bearing_is_refused(more, message):
    said = refusal_of(_machine(more))
    assert said.startswith("journal_bearing[1].")
    assert message in said
