"""Viscosity over the speed, and over the temperature of a film whose heat leaves with its oil."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.laws_at_rest.oil import oil_of, with_oil
from rotor_fmu.model.linear import modes
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from rotor_fmu.linear.where_linearized import where_beyond_ranges
from rotor_fmu.periodic.request import response_request

from ..toml_text import table
from .driven import of_both
from .films import film, heavy_shaft

_SPEED, _LOAD = 300.0, 1000.0
_GIVEN = {"journal_radius": 0.05, "length": 0.05, "clearance": 1e-4, "viscosity": 0.02}
_OVER_SPEED = {"speed": (50.0, 200.0, 500.0), "viscosity": (0.05, 0.03, 0.02)}
_OVER_TEMPERATURE = {
    "temperature": (40.0, 60.0, 80.0, 100.0),
    "viscosity": (0.04, 0.02, 0.012, 0.008),
    "speed": (0.0, 100.0, 300.0, 600.0),
    "static_load": _LOAD,
}
_PADS = {"pads": (math.pi / 2, 1.5 * math.pi), "arc": 2.6, "preload": 0.2}
_TILTING = {"pads": (0.8, 2.4, 4.0, 5.5), "arc": 1.3, "preload": 0.3, "tilting": True}


def _part(**more):
    part = JournalBearing(**{"node": 1, **_GIVEN, **more})
    part.check("journal_bearing[1]")
    return part


@pytest.mark.parametrize("shape", [{}, {"short": True}, _PADS, _TILTING], ids=str)
@pytest.mark.parametrize("speed", [50.0, 130.0, -350.0, 500.0, 10.0, 900.0])
def test_a_film_is_that_of_the_viscosity_that_its_table_has_at_the_speed(shape, speed):
    """Of either sense; by PCHIP between the speeds, that of the end beyond them."""
    over = _OVER_SPEED["speed"]
    at = np.clip(abs(speed), over[0], over[-1])
    constant = float(PchipInterpolator(over, _OVER_SPEED["viscosity"])(at))
    d, v = (2e-5 - 3e-5j), (1e-4 + 2e-3j)
    film, expected = (
        BearingAlone(_part(**shape, **more), speed)
        for more in (_OVER_SPEED, {"viscosity": constant})
    )
    assert film.viscosity == pytest.approx(constant, rel=1e-12)
    assert film.force(d) == pytest.approx(expected.force(d), rel=1e-9)
    assert film.force(d, v) == pytest.approx(expected.force(d, v), rel=1e-9)
    for of, other in zip(film.coefficients(d), expected.coefficients(d), strict=True):
        np.testing.assert_allclose(of, other, rtol=1e-6, atol=1e-8 * np.abs(other).max())
    seen, known = film.outputs(d), expected.outputs(d)
    assert all(seen[name] == pytest.approx(known[name], rel=1e-9, abs=1e-9) for name in known)


@pytest.mark.parametrize(
    ("shape", "share"),
    [({}, 1.0), ({}, 0.4), (_PADS, 1.0), pytest.param(_PADS, 0.4, marks=pytest.mark.slow)],
    ids=str,
)
def test_the_heat_of_the_film_leaves_with_its_oil(shape, share):
    """At each speed, by the outputs of a film of that constant viscosity."""
    part = _part(**shape, **_OVER_TEMPERATURE, heat_share=share)
    oil = oil_of(part, -1j, 1)
    assert oil.temperature[0] == part.inlet_temperature
    over = PchipInterpolator(part.temperature, np.log(part.viscosity))
    for speed, temperature, viscosity in list(zip(*oil, strict=True))[1:]:
        assert viscosity == pytest.approx(math.exp(over(temperature)), rel=1e-9)
        alone = BearingAlone(_part(**shape, viscosity=viscosity), speed)
        seen = alone.outputs(alone.rest(-1j * _LOAD))
        rise = share * seen["power"] / (part.density * part.specific_heat * seen["flow"])
        assert rise > 1.0
        assert temperature - part.inlet_temperature == pytest.approx(rise, abs=1e-3)
    assert oil is oil_of(replace(part, node=2, name="front"), -1j, 1)  # made once


def test_a_short_film_heats_up_as_the_closed_form_says():
    """Ocvirk's load and side flow e c R L speed, the shear of the film and of its strips."""
    part = _part(**_OVER_TEMPERATURE, short=True)
    R, L, c, speed = part.journal_radius, part.length, part.clearance, 300.0
    over = PchipInterpolator(part.temperature, np.log(part.viscosity))

    def beyond(temperature):
        """By how much the temperature is above the one that it leads to."""
        viscosity = math.exp(over(temperature))
        scale = viscosity * R * speed * L**3 / (4 * c**2)

        def borne(e):
            return scale * e * math.sqrt(math.pi**2 * (1 - e**2) + 16 * e**2) / (1 - e**2) ** 2

        e = brentq(lambda e: borne(e) - _LOAD, 1e-3, 0.99)
        theta = np.linspace(0.0, math.pi, 20001)
        # the ruptured half is in strips that are as wide as where it begins, at the thinnest film
        film, strips = (1 / (1 - e * np.cos(theta)) ** n for n in (1, 2))
        sheared = np.trapezoid(film, theta) + (1 - e) * np.trapezoid(strips, theta)
        attitude = math.atan2(math.pi * math.sqrt(1 - e**2), 4 * e)
        torque = viscosity * R**3 * L * speed / c * sheared
        torque += 0.5 * e * c * _LOAD * math.sin(attitude)
        heat = torque * speed / (part.density * part.specific_heat * e * c * R * L * speed)
        return temperature - part.inlet_temperature - heat

    expected = brentq(beyond, 40.0, 100.0)
    assert oil_of(part, -1j, 1).temperature[2] == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"density": 1e-29}, "its film would be hotter at 100 rad/s than its temperature"),
        ({"speed": (100.0, 3000.0)}, "its film would be hotter at 3000 rad/s than its temperat"),
        (
            {"static_load": 1e6},
            "no equilibrium: its film does not carry static_load = 1e+06 N at 100 rad/s and 40",
        ),
    ],
)
def test_a_heat_balance_that_cannot_be_is_refused_where_its_film_is_needed(more, message):
    """By a run and by linear analyses with one sentence; a file is read without it."""
    lists = table("[journal_bearing]", node=3, **_listed(_GIVEN | _OVER_TEMPERATURE | more))
    machine = parse_rotor(heavy_shaft() + film(1) + lists)
    uses = (
        lambda: Simulation(machine, speed=300.0, warn=lambda _: None),
        lambda: modes(machine, 300.0),
        lambda: bearing_curves(machine, [300.0], bearing="journal_bearing[2]", load=_LOAD),
    )
    for use in uses:
        with pytest.raises(QuantityError) as refused:
            use()
        assert str(refused.value).startswith(f"journal_bearing[2]: {message}")
        assert "\n" not in str(refused.value)


def test_a_machine_that_is_turned_with_gravity_has_the_same_oil():
    """Its static load is along gravity, and so is a given load."""

    def turned(angle, load=None):
        pads = {"pads": [angle + p for p in _PADS["pads"]], "arc": 2.6, "preload": 0.2}
        lists = _listed(_GIVEN | _OVER_TEMPERATURE) | pads | {"speed": [100.0, 300.0]}
        text = f"gravity_angle = {angle}\n{heavy_shaft()}{film(1)}"
        machine = parse_rotor(text + table("[journal_bearing]", node=3, **lists))
        return bearing_curves(machine, [_SPEED], bearing="journal_bearing[2]", load=load)

    for load in (None, _LOAD):
        upright, on_its_side = turned(0.0, load), turned(0.5 * math.pi, load)
        assert on_its_side.temperature == pytest.approx(upright.temperature, rel=1e-6)
        assert on_its_side.viscosity == pytest.approx(upright.viscosity, rel=1e-6)
        assert on_its_side.x == pytest.approx(-upright.y, rel=1e-4)
        assert on_its_side.y == pytest.approx(upright.x, rel=1e-4)


def _listed(of):
    return {name: list(v) if isinstance(v, tuple) else v for name, v in of.items()}


def test_a_run_takes_the_viscosity_of_its_speed():
    """Through a change of the speed; linear answers too."""
    at = float(PchipInterpolator(*_OVER_SPEED.values())(400.0))
    text = heavy_shaft() + film(1) + film(3)
    lists = "speed = [50.0, 200.0, 500.0]\nviscosity = [0.05, 0.03, 0.02]"
    machine, constant = (
        parse_rotor(re.sub(r"viscosity = \S+", given, text))
        for given in (lists, f"viscosity = {at!r}")
    )
    film_of, expected = (bearing_curves(m, [400.0]) for m in (machine, constant))
    np.testing.assert_allclose(film_of.K, expected.K, rtol=1e-9)
    assert film_of.viscosity == pytest.approx(at, rel=1e-12)
    assert film_of.temperature is None
    roots = [np.sort_complex(modes(m, 400.0).eigenvalues) for m in (machine, constant)]
    np.testing.assert_allclose(*roots, rtol=1e-6)
    settings = choose("controlled", tolerance=1e-4)
    runs = [
        Simulation(m, settings, speed=speed, warn=lambda _: None)
        for m, speed in ((machine, 380.0), (constant, 400.0))
    ]
    runs[0].advance(0.1, 380.0, rate=200.0)
    for run in runs:
        run.advance(1.0, 400.0, rate=0.0)
    for name in ("journal_bearing[1].eccentricity", "journal_bearing[1].torque"):
        assert runs[0].read(name) == pytest.approx(runs[1].read(name), rel=1e-3)
    lost = sum(runs[0].read(n) for n in runs[0].names if n.endswith("_loss"))
    assert abs(runs[0].read("energy.residual")) < 1e-4 * lost


@pytest.mark.parametrize("sense", [1, -1])
def test_a_speed_outside_the_table_is_warned_of_whichever_way_the_shaft_turns(sense):
    text = heavy_shaft(1e-6) + film(1) + film(3)
    lists = "speed = [50.0, 500.0]\nviscosity = [0.05, 0.02]"
    machine = parse_rotor(re.sub(r"viscosity = \S+", lists, text, count=1))
    said = []
    run = Simulation(machine, speed=sense * 490.0, warn=said.append)
    run.advance(0.01, sense * 490.0, rate=sense * 300.0)
    assert not [m for m in said if "table" in m]
    run.advance(0.1, sense * 493.0, rate=sense * 300.0)
    (warned,) = [m for m in said if "table" in m]
    assert warned.startswith(f"journal_bearing[1]: speed {sense * 520} rad/s lies outside its ta")
    assert "viscosity" in warned


@pytest.mark.parametrize(
    "shape",
    [{}, _PADS | {"offset": 0.4}, pytest.param(_TILTING | {"offset": 0.6}, marks=pytest.mark.slow)],
)
def test_a_film_turned_the_other_way_heats_up_as_its_mirror_image_does(shape):
    """Mirrored across its load; it has another temperature than its own at the positive speed,
    unless it is its own mirror image."""
    lists = {name: of for name, of in _OVER_TEMPERATURE.items() if name != "speed"}
    part = _part(**lists, **shape, speed=(100.0, 300.0))
    image = part
    if part.pads:
        pads = tuple(math.pi - angle for angle in part.pads)
        image = replace(part, pads=pads, offset=1.0 - part.offset)
    found, expected, own = (
        with_oil(of, "", -1j).viscosity_tables()[sense]
        for of, sense in ((part, 1), (image, 0), (part, 0))
    )
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    is_its_own_image = np.allclose(found[:, -1], own[:, -1], rtol=1e-4)
    assert is_its_own_image == (not part.pads)


def test_a_film_that_has_no_heat_balance_turned_the_other_way_says_so():
    """It keeps the viscosity of positive speeds there, which a periodic response is not made of."""
    oil = {"viscosity": (0.04, 0.02), "temperature": (40.0, 60.0), "speed": (100.0, 300.0)}
    part = _part(**_PADS, static_load=_LOAD, offset=0.3, **oil)
    coolest, hottest = sorted(oil_of(part, -1j, sense).temperature[-1] for sense in (1, -1))
    assert coolest == oil_of(part, -1j, 1).temperature[-1]
    end = 0.5 * (coolest + hottest)  # of the same line of logarithms
    oil |= {"temperature": (40.0, end), "viscosity": (0.04, 0.04 * 0.5 ** ((end - 40.0) / 20.0))}
    heated = _GIVEN | _PADS | oil | {"static_load": _LOAD, "offset": 0.3}
    machine = parse_rotor(
        heavy_shaft() + film(1) + table("[journal_bearing]", node=3, **_listed(heated))
    )
    said = []
    for speed in (250.0, -250.0):
        Simulation(machine, speed=speed, warn=said.append)
    (warned,) = [str(m) for m in said if "heat balance" in m]
    assert warned.startswith("journal_bearing[2]: speed -250 rad/s is negative, where it has no he")
    assert "its film would be hotter at -300 rad/s than its temperature, which ends at" in warned
    curves = bearing_curves(machine, [-250.0, 250.0], bearing="journal_bearing[2]", load=_LOAD)
    assert curves.viscosity[0] == curves.viscosity[1]
    assert curves.temperature[0] == curves.temperature[1]
    assert where_beyond_ranges(machine, [-250.0, 250.0]) == [warned]
    assert where_beyond_ranges(machine, [-250.0, -120.0, -200.0]) == [warned]
    with pytest.raises(QuantityError, match=re.escape(warned)):
        response_request(machine, speed=(-250.0, -200.0))


def test_fmu_has_the_bits_of_the_simulation(machine_of):
    """The FMU in Python and the native one, with a table over speed and with a heat balance."""
    text = heavy_shaft(1e-6) + film(1) + film(3)
    heat = "\n".join(f"{k} = {v}" for k, v in _listed(_OVER_TEMPERATURE).items())
    text = re.sub(
        r"viscosity = \S+", "speed = [50.0, 500.0]\nviscosity = [0.05, 0.02]", text, count=1
    )
    text = re.sub(r"viscosity = 0.01\b", heat, text, count=1)
    names = ("journal_bearing[1].fx", "journal_bearing[1].torque", "journal_bearing[2].film")
    of_fmu, of_simulation = of_both(machine_of, text, names, 300.0)
    assert of_fmu == of_simulation


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"temperature": (40.0, 60.0, 80.0, 70.0)}, ".temperature[4] = 70 degC: must be above 80"),
        ({"viscosity": (0.04, 0.02, 0.01, -1.0)}, ".viscosity[4] = -1 Pa.s: must be > 0"),
        ({"viscosity": (0.04, 0.02)}, ".viscosity: 2 given, 4 needed, as many as "),
        (
            {"viscosity": (0.04, 0.05, 0.01, 0.008)},
            ".viscosity = 0.05 Pa.s: must be below 0.04 Pa.s, as the temperature is higher",
        ),
        ({"inlet_temperature": 20.0}, ".inlet_temperature = 20 degC: must be within journal_"),
        ({"static_load": 0.0}, ".static_load = 0 N: must be > 0: the heat balance needs it"),
        ({"speed": ()}, ".speed: 0 given, at least 2 are needed"),
        ({"speed": (100.0, -3.0)}, ".speed[2] = -3 rad/s: must be >= 0"),
        ({"heat_share": 1.5}, ".heat_share = 1.5: must be from 0 to 1"),
        ({"temperature": 40.0}, ".temperature = 40.0: must be a list of numbers"),
        ({"temperature": (), "speed": ()}, ".viscosity: a list needs journal_bearing[1].speed or"),
        (
            {"temperature": (), "viscosity": (0.04, 0.02), "speed": (300.0, 200.0)},
            ".speed[2] = 200 rad/s: must be above 300",
        ),
        ({"viscosity": 0.02}, ".speed: needs journal_bearing[1].viscosity, a list over it"),
        (
            {"viscosity": 0.02, "speed": (), "temperature": ()},
            ".static_load: needs journal_bearing[1].temperature, for the heat balance",
        ),
        (
            {"viscosity": 0.02, "speed": (), "temperature": (), "inlet_temperature": 30.0},
            ".inlet_temperature: needs journal_bearing[1].temperature, for the heat balance",
        ),
        (
            {"temperature": (), "viscosity": (0.04, 0.02), "speed": (0.0, 9.0), "static_load": 0.0}
            | {"heat_share": 0.5},
            ".heat_share: needs journal_bearing[1].temperature, for the heat balance",
        ),
    ],
)
def test_a_viscosity_that_cannot_be_is_refused(more, message):
    with pytest.raises(QuantityError) as refused:
        _part(**{**_OVER_TEMPERATURE, **more})
    assert str(refused.value).startswith("journal_bearing[1]")
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)
