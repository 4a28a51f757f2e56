"""`rotor-fmu bearing` of rolling bearings: loads, stiffness, and what is written."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import rolling_curves
from rotor_fmu.model.bearing_curves.rolling_bearing import RollingAlone
from rotor_fmu.model.linear import (
    static,
)
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.rolling_bearing import RollingBearing

from rotor_fmu.display import choose, restored
from rotor_fmu.linear import answers, bearing_answers

from .bearing_machines import PNG, ROLLING, with_part

BALLS = RollingBearing(
    node=1, count=8, pitch_diameter=0.052, element_diameter=0.0119, k=8e9, c=200.0
)


@pytest.mark.parametrize(
    ("exponent", "factor"), [(1.5, 4.370), pytest.param(1.111111, 4.085, marks=pytest.mark.slow)]
)
def test_many_elements_without_clearance_carry_what_the_closed_form_says(exponent, factor):
    """Stribeck: the largest carries factor times the load over the count, half of them carry, and
    of a force that goes with x^n the stiffness is n F / x."""
    part = replace(BALLS, count=80, element_diameter=1e-3, exponent=exponent)
    found = rolling_curves(with_part(part), bearing="rolling_bearing[1]", load=1000.0)
    assert found.largest[0] == pytest.approx(factor * 1000.0 / 80, rel=5e-3)
    assert found.loaded[0] == pytest.approx(40, abs=1)
    carried = found.elements[0] @ np.exp(1j * found.angles)
    assert carried == pytest.approx(-1000j, rel=1e-9)
    assert found.K[0, 1, 1] == pytest.approx(exponent * 1000.0 / -found.y[0], rel=1e-6)


def test_a_preload_makes_it_as_stiff_as_the_closed_form():
    """K = Z / 2 n k clearance^(n - 1), C = Z / 2 c."""
    part = replace(BALLS, clearance=-5e-6)
    found = rolling_curves(with_part(part), bearing="rolling_bearing[1]", load=1e-3)
    stiffness = 8 / 2 * 1.5 * 8e9 * math.sqrt(5e-6)
    np.testing.assert_allclose(found.K[0], stiffness * np.eye(2), rtol=1e-3, atol=1e-3 * stiffness)
    np.testing.assert_allclose(found.C[0], 8 / 2 * 200.0 * np.eye(2), rtol=1e-9, atol=1e-6)


def test_the_load_is_carried_wherever_elements_and_shaft_are():
    """Preload and clearance of 0.1 mm, loads over nine decades, any place of the elements."""
    random = np.random.default_rng(3)
    for _ in range(30):
        part = replace(
            BALLS,
            count=int(random.integers(3, 30)),
            element_diameter=0.004,
            clearance=float(random.choice([0.0, 1.0, -1.0]) * 10 ** random.uniform(-7, -4)),
            exponent=float(random.choice([1.0, 10 / 9, 1.5])),
            cage_angle=float(random.uniform(0, 6)),
            outer_depth=float(random.choice([0.0, 2e-6])),
        )
        alone = RollingAlone(part, passed=float(random.uniform(0, 6)))
        load = 10 ** random.uniform(-3, 6) * np.exp(1j * random.uniform(0, 2 * math.pi))
        d = alone.rest(load)
        assert abs(alone.force(d) + load) < 1e-6 * abs(load), part
        stiffness, damping = alone.coefficients(d)
        for matrix in (stiffness, damping):
            assert np.linalg.eigvalsh(matrix).min() > -1e-9 * np.abs(matrix).max()


def test_a_picture_holds_all_that_is_written_in_it():
    """Also in units with long numbers, which leave its panels less room."""
    with restored():
        choose("us")
        figure = bearing_answers.rolling(ROLLING, bearing="left", load=[10.0, 2e3]).figure()
    figure.canvas.draw()
    drawn = figure.get_tightbbox(figure.canvas.get_renderer())
    assert drawn.x0 >= 0.0
    assert drawn.x1 <= figure.get_figwidth()


@pytest.mark.parametrize("load", [0.0, 1e-13, 1e-4])
def test_a_preload_is_in_balance_beside_a_defect_under_next_to_no_load(load):
    """A vertical machine's load is 0 or rounding: the shaft rests beside the defect below it, and
    the force that is left is rounding too."""
    part = replace(BALLS, clearance=-5e-6, outer_depth=4e-6, outer_arc=0.5)
    alone = RollingAlone(part)
    d = alone.rest(-1j * load)
    assert -3e-6 < d.imag < -1e-7
    assert abs(alone.force(d) - 1j * load) < 1e-10 * 8e9 * 5e-6**1.5


def test_a_vertical_machine_has_the_stiffness_of_its_preload():
    text = ROLLING.read_text(encoding="utf-8")
    rotor = parse_rotor(f"inclination = {math.pi / 2}\n{text}")
    found, whole = rolling_curves(rotor, bearing="left"), static(rotor)
    assert abs(found.load).max() < 1e-9
    assert found.y[0] == pytest.approx(whole.y[0], rel=1e-5)
    assert found.K[0, 1, 1] > 1e7


def test_the_load_of_a_rolling_bearing_is_that_of_the_machine_at_rest():
    rotor = parse_rotor(ROLLING.read_text(encoding="utf-8"))
    found, whole = rolling_curves(rotor, bearing="left"), static(rotor)
    on = whole.supports.index("left")
    assert -found.load[0, 1] == pytest.approx(-whole.load_y[on], rel=1e-9)
    assert -found.y[0] == pytest.approx(-whole.y[0], rel=1e-6)


@pytest.mark.usefixtures("drawn")
def test_coefficients_written_for_a_rolling_bearing_give_the_modes_of_the_machine(
    command, tmp_path
):
    text, linear = ROLLING.read_text(encoding="utf-8"), ""
    for name, node in (("left", 1), ("right", 3)):
        table = tmp_path / f"{node}.toml"
        said = command("bearing", "--rotor", str(ROLLING), "--bearing", name, "--table", str(table))
        assert f"{name}: 8 elements" in said
        linear += table.read_text()
    assert (tmp_path / "out" / "bearing.png").read_bytes().startswith(PNG)
    values = json.loads((tmp_path / "out" / "bearing.json").read_text())
    assert len(values["elements"][0]) == 8
    assert sum(load > 0 for load in values["elements"][0]) == values["loaded"][0]
    (tmp_path / "replaced.toml").write_text(text.split("[[rolling_bearing]]")[0] + linear)
    roots = [answers.modes(path, 100.0) for path in (ROLLING, tmp_path / "replaced.toml")]
    np.testing.assert_allclose(roots[1].eigenvalues, roots[0].eigenvalues, rtol=1e-6)


def test_a_bearing_in_its_clearance_without_load_has_no_stiffness_and_no_minus_zero():
    part = replace(BALLS, clearance=1e-5)
    found = bearing_answers.rolling(with_part(part), bearing="rolling_bearing[1]", load=0.0)
    assert not found.K_passing.any()
    assert "-0" not in str(found.table())
