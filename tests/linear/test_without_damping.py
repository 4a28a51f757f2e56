"""Resonances without damping: infinite there, and the closed form of one mass beside them."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import critical_peaks, response_with_peaks, unbalance_check
from rotor_fmu.model.linear.frequency_response import frequency_response
from rotor_fmu.model.machine.toml import parse_rotor

from ..toml_text import table

MASS, KX, KY, E = 2.0, 2.01e4, 2.01e4 * (1 + 2e-4), 1e-5
ENDS = 2e-3  # of the bearings that keep the shaft from tilting, together
SPEEDS = np.linspace(10.0, 200.0, 191)


def text(ky=KY, c=0.0):
    bearings = ((1, ENDS / 2, ENDS / 2, 0.0), (2, KX, ky, c), (3, ENDS / 2, ENDS / 2, 0.0))
    return "".join(
        [
            "gravity = 0.0\n",
            table("material", young=2.1e11, density=1e-6),
            table("shaft", nodes=[0.0, 0.2, 0.4], diameters=[0.05, 0.05]),
            table("[point_mass]", node=2, mass=MASS),
            table("[unbalance]", node=2, amount=MASS * E),
            *(
                table("[linear_bearing]", node=node, kxx=kx, kyy=ky, cxx=c, cyy=c)
                for node, kx, ky, c in bearings
            ),
        ]
    )


def machine(**given):
    return parse_rotor(text(**given))


def critical(k):
    return math.sqrt((k + ENDS) / MASS)


def test_an_orbit_is_infinite_at_its_resonance_and_the_closed_form_elsewhere():
    found = response_with_peaks(machine(), SPEEDS, nodes=[2])
    for values, k in ((found.x, KX), (found.y, KY)):
        size = np.abs(values[:, 1])
        poles = found.speeds[np.isinf(size)]
        assert len(poles) == 1
        assert poles[0] == pytest.approx(critical(k), rel=1e-8)
        at = found.speeds[np.isfinite(size)]
        expected = E * at**2 / (critical(k) ** 2 - at**2)
        assert size[np.isfinite(size)] == pytest.approx(np.abs(expected), rel=1e-4)
    assert np.isinf(found.major[:, 1]).sum() == len(found.peaks[2]) == 2


def test_a_curve_does_not_climb_the_pole_further_than_a_thousandth_beside_it():
    found = response_with_peaks(machine(ky=KX), SPEEDS, nodes=[2])
    finite = found.major[np.isfinite(found.major[:, 1]), 1]
    assert finite.max() == pytest.approx(E / 2e-3, rel=1e-2)
    assert set(SPEEDS) <= set(found.speeds)


def test_the_amplification_factor_is_infinite_and_no_clearance_is_kept():
    (x, y) = critical_peaks(machine(ky=KX), 200.0, [2])
    for found in (x, y):
        assert found.peak.amplitude == found.peak.amplification == math.inf
        assert found.peak.speed == pytest.approx(critical(KX), rel=1e-8)
    check = unbalance_check(machine(ky=KX), 110.0, 200.0, [2], clearances={2: 1.0})
    (clearance,) = check.clearances
    assert clearance.scaled == math.inf
    assert not clearance.is_met


@pytest.mark.parametrize("zeta", [pytest.param(1e-4, marks=pytest.mark.slow), 1e-6])
def test_a_little_damping_leaves_a_finite_peak(zeta):
    damped = machine(ky=KX, c=2 * zeta * math.sqrt(KX * MASS))
    (x, _) = critical_peaks(damped, 200.0, [2])
    assert x.peak.amplification == pytest.approx(1 / (2 * zeta), rel=1e-3)
    found = response_with_peaks(damped, SPEEDS, nodes=[2])
    assert found.major[:, 1].max() == pytest.approx(E / (2 * zeta), rel=1e-3)


def test_a_receptance_is_infinite_in_the_direction_that_resonates():
    found = frequency_response(machine(), SPEEDS, 2, [2], peaks=True)
    for i, k in enumerate((KX, KY)):
        values = np.abs(found.receptance[:, 0, i, i])
        (pole,) = found.frequencies[np.isinf(values)]
        assert pole == pytest.approx(critical(k), rel=1e-8)
    assert np.isfinite(found.receptance[:, 0, 0, 1]).all()


def test_the_command_says_that_the_response_is_infinite(tmp_path, command):
    path = tmp_path / "undamped.toml"
    path.write_text(text(ky=KX))
    said = command("unbalance", "--rotor", str(path), "--speed", "10:200", "--out", str(tmp_path))
    rows = [line.split() for line in said.splitlines()]
    assert [row for row in rows if row[:1] == ["2"] and row[3:6] == ["inf"] * 3]
    assert [row for row in rows if row[:2] == ["2", "x"] and row[3] == row[-1] == "inf"]
