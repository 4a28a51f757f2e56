"""A linear machine integrated in time until it is steady whirls as the harmonic problem says."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import modes, static, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from ..parts.machines import shaft

SAMPLES, NODES = 64, (2, 3, 5)

MACHINE = (
    shaft(0.0, 0.05, 0.2, 0.35, 0.5)
    + "mass_damping = 20.0\n"
    + """
[[body]]
node = 3
mass = 2.0
I_d = 0.004
I_p = 0.008
e = 1e-5
phase = 0.3
[[body]]
node = 5
mass = 1.0
I_d = 0.002
I_p = 0.004
e = 2e-5
phase = -1.0
[[linear_bearing]]
node = 1
kxx = 2e5
kxy = 3e4
kyx = -2e4
kyy = 3e5
cxx = 400.0
cyy = 300.0
[[linear_bearing]]
node = 4
kxx = [2e5, 3e5, 4e5]
kyy = [4e5, 4e5, 5e5]
cxx = [550.0, 500.0, 450.0]
cxy = [10.0, 20.0, 30.0]
cyx = [-20.0, -10.0, 0.0]
cyy = [650.0, 600.0, 550.0]
speed = [-400.0, 100.0, 400.0]
"""
    + "".join(f'[[sensor]]\nnode = {node}\nname = "at{node}"\n' for node in NODES)
)


@pytest.mark.parametrize(("tolerance", "speed"), [(1e-3, 140.0), (1e-5, 320.0), (1e-3, -320.0)])
def test_amplitude_and_phase_are_reached_within_ten_tolerances(tolerance, speed):
    rotor, at = parse_rotor(MACHINE), [node - 1 for node in NODES]
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=speed)
    turn = 2 * math.pi / abs(speed)
    slowest = -modes(rotor, speed).eigenvalues.real.max()
    times = 20 / slowest + np.arange(SAMPLES) / SAMPLES * turn
    moved = []
    for t in times:
        sim.advance(t, speed)
        moved.append(sim.motion.q[[2 * (node - 1) for node in NODES]].copy())
    moved = np.array(moved)
    rest = static(rotor, speed)
    np.testing.assert_allclose(moved.mean(axis=0).imag, rest.y[at], rtol=10 * tolerance)
    mark = np.exp(-1j * speed * times)[:, None]
    result = unbalance_response(rotor, [speed])
    most = 10 * tolerance * result.major.max()
    for plane, part in (("x", moved.real), ("y", moved.imag)):
        expected = getattr(result, plane)[0][at]
        assert np.abs(2 * (part * mark).mean(axis=0) - expected).max() < most
        leads = getattr(result, f"phase_{plane}")[0][at]
        for node, of, lead in zip(NODES, expected, leads, strict=True):
            size, phase = (sim.read(f"at{node}.{plane}_1x{word}") for word in ("", "_phase"))
            assert abs(size * np.exp(1j * phase) - abs(of) * np.exp(1j * lead)) < most
