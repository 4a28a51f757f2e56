"""A linear machine integrated in time until it is steady whirls as the harmonic problem says."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import modes, static, unbalance_response
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.port import Port
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from ..machines import overhung

SPEED, SAMPLES = 220.0, 64
NODES = (1, 2, 3)


def machine():
    """Anisotropic bearings with cross coupling, two eccentric discs."""
    bearings = (
        LinearBearing(node=1, kxx=2e5, kxy=3e4, kyx=-2e4, kyy=3e5, cxx=400.0, cyy=300.0),
        LinearBearing(node=3, kxx=3e5, kyy=4e5, cxx=500.0, cxy=20.0, cyx=-10.0, cyy=600.0),
    )
    discs = (Disc(2, 0.2, 0.03, e=1e-5, phase=0.3), Disc(3, 0.1, 0.02, e=2e-5, phase=-1.0))
    return overhung(discs, (), (*bearings, Port(1)))


@pytest.mark.parametrize(("tolerance", "speed"), [(1e-3, SPEED), (1e-5, SPEED), (1e-3, -SPEED)])
def test_amplitude_and_phase_are_reached_within_ten_tolerances(tolerance, speed):
    rotor = machine()
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=speed)
    turn = 2 * math.pi / SPEED
    slowest = -modes(rotor, speed).eigenvalues.real.max()
    times = 20 / slowest + np.arange(SAMPLES) / SAMPLES * turn
    sim.advance(times[0], speed)
    moved = []
    for t in times:
        sim.advance(t, speed)
        moved.append(sim.motion.q[[2 * (node - 1) for node in NODES]].copy())
    moved = np.array(moved)
    at_rest = static(rotor, speed)
    np.testing.assert_allclose(moved.mean(axis=0).imag, at_rest.y, rtol=10 * tolerance)
    mark = np.exp(-1j * speed * times)
    result = unbalance_response(rotor, [speed])
    scale = result.major.max()
    for plane, part in (("x", moved.real), ("y", moved.imag)):
        amplitude = 2 * (part * mark[:, None]).mean(axis=0)
        assert np.abs(amplitude - getattr(result, plane)[0]).max() < 10 * tolerance * scale
        for place, node in (("disc[1]", 2), ("disc[2]", 3)):
            size, phase = (sim.read(f"{place}.{plane}_1x{of}") for of in ("", "_phase"))
            lead = getattr(result, f"phase_{plane}")[0, node - 1]
            right = abs(getattr(result, plane)[0, node - 1]) * np.exp(1j * lead)
            assert abs(size * np.exp(1j * phase) - right) < 10 * tolerance * scale
