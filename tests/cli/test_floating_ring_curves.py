"""`rotor-fmu bearing` of bearings with floating rings: closed forms of two films in series, and the
machine in which they are."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import ring_curves
from rotor_fmu.model.linear import LinearError
from rotor_fmu.model.linear.bearing_equilibrium import RingAlone
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.floating_ring_bearing import FloatingRingBearing

from rotor_fmu.linear import answers

from ..parts.rings import RING, SPEED, G, in_series, ocvirk, rigid_in_rings

EXAMPLE = Path(__file__).parents[2] / "examples" / "turbocharger" / "rotor.toml"
NAME = "floating_ring_bearing[1]"


def test_journal_and_ring_rest_over_the_load_as_the_closed_forms_in_series():
    loads = [0.2, 2.0, 8.0]
    found = ring_curves(parse_rotor(rigid_in_rings()), [SPEED], bearing=NAME, load=loads)
    for i, load in enumerate(loads):
        d, x, w = in_series(load)
        assert complex(found.x[i], found.y[i]) == pytest.approx(d, rel=1e-6)
        assert complex(found.ring_x[i], found.ring_y[i]) == pytest.approx(x, rel=1e-6)
        assert found.ratio[i] == pytest.approx(w / SPEED, rel=1e-6)
        assert found.eccentricity[i] == pytest.approx(abs(d - x) / RING["clearance"], rel=1e-6)
    assert found.outer_eccentricity[-1] > 0.5


def _slope(force, at, size):
    """The matrix of a force's derivatives by both parts of `at`, by differences."""
    columns = [(force(at + s) - force(at - s)) / (2.0 * size) for s in (size, 1j * size)]
    return np.array([[c.real for c in columns], [c.imag for c in columns]])


def _dynamic(side, z, turning):
    """Stiffness and damping of a short film, K + i omega C at the frequency of rotation."""
    size = 1e-5 * RING["clearance"]
    K = -_slope(lambda at: ocvirk(side, at, turning), z, size)
    C = -_slope(lambda v: ocvirk(side, z, turning, v), 0j, size)
    return K + 1j * SPEED * C


def test_the_coefficients_are_of_both_films_in_series_with_the_mass_of_the_ring():
    """Of a ring whose polar inertia holds its speed."""
    part = replace(FloatingRingBearing(node=1, **RING), ring_inertia=1.0)
    alone = RingAlone(part, SPEED, NAME, -1j * G)
    d = alone.rest(-3j)
    seen = alone.outputs(d)
    x, w = complex(seen["ring_x"], seen["ring_y"]), seen["ring_speed"]
    inner, outer = _dynamic("inner", d - x, SPEED + w), _dynamic("outer", x, w)
    on_ring = inner + outer - part.ring_mass * SPEED**2 * np.eye(2)
    series = inner - inner @ np.linalg.solve(on_ring, inner)
    K, C = alone.coefficients(d)
    most = np.abs(series).max()
    np.testing.assert_allclose(K, series.real, atol=1e-6 * most)
    np.testing.assert_allclose(SPEED * C, series.imag, atol=1e-6 * most)
    assert np.abs(outer).max() < np.abs(inner).max()


@pytest.mark.usefixtures("drawn")
def test_what_is_written_for_linear_bearings_answers_to_unbalance_as_the_rings(command, tmp_path):
    text, linear = EXAMPLE.read_text(encoding="utf-8"), ""
    speeds = [2000.0, 5000.0, 8000.0]
    for i in (1, 2):
        table = tmp_path / f"{i}.toml"
        name = f"floating_ring_bearing[{i}]"
        given = (
            "--rotor",
            str(EXAMPLE),
            "--bearing",
            name,
            "--speed",
            "2000:8000:3",
            "--table",
            str(table),
        )
        assert f"{name}: the ring turns at 0.1" in command("bearing", *given)
        linear += table.read_text()
        assert "# The ring follows at the frequency of rotation: right for unbalance, not" in linear
    assert (tmp_path / "out" / "bearing.png").read_bytes().startswith(b"\x89PNG")
    shown = json.loads((tmp_path / "out" / "bearing.json").read_text())
    np.testing.assert_allclose(shown["ring_speed"], np.multiply(speeds, shown["ratio"]))
    (tmp_path / "replaced.toml").write_text(text.split("[[floating_ring_bearing]]")[0] + linear)
    rings, replaced = (
        answers.unbalance_response(path, speeds) for path in (EXAMPLE, tmp_path / "replaced.toml")
    )
    np.testing.assert_allclose(replaced.major, rings.major, rtol=1e-6)


def test_the_default_load_is_what_the_machine_puts_on_it_and_turns_with_gravity():
    turned = "gravity_angle = 0.5\n" + rigid_in_rings()
    both = [
        ring_curves(parse_rotor(text), [SPEED], bearing=NAME) for text in (rigid_in_rings(), turned)
    ]
    upright, turned = (complex(c.ring_x[0], c.ring_y[0]) for c in both)
    assert turned == pytest.approx(upright * np.exp(0.5j), rel=1e-8)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], f"--speed: must be given, on which the film of {NAME} depends"),
        (["--speed", "100", "--load", "0"], "--load 0: must be > 0"),
    ],
)
def test_what_cannot_be_asked_is_refused(refusal, arguments, expected):
    assert expected in refusal("bearing", "--rotor", str(EXAMPLE), *arguments)


@pytest.mark.parametrize(
    ("speed", "load", "expected"),
    [
        (0.0, None, f"{NAME}: speed = 0 rad/s: must not be 0, where no film carries"),
        (100.0, 2e4, f"{NAME}: no equilibrium at 100 rad/s: its load is 2e+04 N"),
    ],
)
def test_what_the_films_do_not_carry_is_refused(speed, load, expected):
    with pytest.raises(LinearError) as refused:
        ring_curves(parse_rotor(rigid_in_rings()), [speed], bearing=NAME, load=load)
    assert expected in str(refused.value)
