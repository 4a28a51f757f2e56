"""A linear machine's FMU run until it is steady whirls as `unbalance` says: amplitude and phase."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import modes, static, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor

from .machines import shaft

SAMPLES, NODES = 64, (2, 3, 5)

MACHINE = (
    shaft(0.0, 0.05, 0.2, 0.35, 0.5)
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
kxx = [3e5, 4e5]
kyy = [4e5, 5e5]
cxx = [500.0, 450.0]
cxy = [20.0, 30.0]
cyx = [-10.0, 0.0]
cyy = [600.0, 550.0]
speed = [100.0, 400.0]
"""
    + "".join(f'[[sensor]]\nnode = {node}\nname = "at{node}"\n' for node in NODES)
)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
@pytest.mark.parametrize("speed", [140.0, 320.0])
def test_amplitude_and_phase_are_reached_within_ten_tolerances(machine_of, speed, tolerance):
    rotor = parse_rotor(MACHINE)
    slowest = -modes(rotor, speed).eigenvalues.real.max()
    times = 20 / slowest + np.arange(SAMPLES) / SAMPLES * 2 * math.pi / speed
    names = [f"at{node}.{axis}" for node in NODES for axis in "xy"]
    with machine_of(MACHINE).start(speed=speed, tolerance=tolerance) as run:
        seen, angles = [], []
        for t in times:
            run.advance(t)
            seen.append(run.read(*names))
            angles.append(run.read("phi"))
    seen = np.reshape(seen, (SAMPLES, len(NODES), 2))
    at = [node - 1 for node in NODES]
    rest = static(rotor, speed)
    np.testing.assert_allclose(seen[..., 1].mean(axis=0), rest.y[at], rtol=10 * tolerance)
    # the part that turns with the rotor
    mark = np.exp(-1j * np.array(angles))[:, None]
    result = unbalance_response(rotor, [speed])
    scale = result.major.max()
    for axis, output in enumerate((result.x[0], result.y[0])):
        amplitude = 2 * (seen[..., axis] * mark).mean(axis=0)
        assert np.abs(amplitude - output[at]).max() < 10 * tolerance * scale
