"""A rotor that rubs far above its lowest natural frequency, beside CVODE on independent equations.

Its machine swings slowly while it turns hundreds of times, so that the default method's errors,
which are tolerated in a cycle of the rotation, add up to more than those of the drawn machines,
which turn at up to 2.5 times that frequency: what `docs/explanation/limitations.md` says.
"""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.simulation import Simulation
from sksundae.cvode import CVODE

import rotor_fmu as rf

from ..parts.equations import Equations

# it whirls backward with 529 rad/s, as slowly as a shaft on springs, growing by 6.7 1/s
MACHINE = """
name = "fast"
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.262, 0.546]
diameters = [0.0164, 0.0164]
eta_v = 3.8e-6
[[disc]]
node = 2
diameter = 0.0983
width = 0.0164
e = 2.5e-6
"""
_BEARING = """
[[bearing]]
node = {}
journal_radius = 0.0082
clearance = 1.3e-6
mu = 0.112
k = 2.7e5
c = 51.0
delta_c = 9e-8
v_s = 2e-4
mass = 0.17
mass_ratio = 1.2
kx = 6.6e5
ky = 1.3e6
cx = 67.0
cy = 95.0
"""
MACHINE += _BEARING.format(1) + _BEARING.format(3)
SPEED, RATE, STOP, SAMPLES = 14250.0, 45000.0, 0.16, 200
TOLERANCE = 1e-3


def _cvode(times: np.ndarray) -> np.ndarray:
    """The way of the disc from its start, complex [m]."""
    rotor = parse_rotor(MACHINE)
    equations = Equations(rotor, SPEED, RATE)
    n = equations.size
    q = Simulation(rotor, speed=SPEED, rate=RATE, warn=lambda message: None).motion.q[:n]
    state = np.concatenate([q.real, q.imag, np.zeros(2 * n + len(equations.walls))])
    atol = np.repeat([1e-15, 1e-12, 1e-9], [2 * n, 2 * n, len(equations.walls)])
    solver = CVODE(equations.slope, rtol=1e-8, atol=atol, max_num_steps=10**8)
    y = solver.solve(times, state).y
    return y[:, 2] + 1j * y[:, n + 2] - q[2]


@pytest.fixture(scope="module")
def truth() -> np.ndarray:
    """The way at `SAMPLES` + 1 times."""
    return _cvode(np.linspace(0.0, STOP, SAMPLES + 1))


def _run(**how: object) -> rf.Result:
    speed = ([0.0, STOP], [SPEED, SPEED + RATE * STOP])
    return rf.simulate(
        rf.parse(MACHINE), speed=speed, tolerance=TOLERANCE, step=STOP / SAMPLES, **how
    )


def _error(result: rf.Result, truth: np.ndarray) -> float:
    """The largest distance of the orbits, over the largest displacement, in tolerances."""
    points = result.points
    assert points is not None
    z = points.columns["disc[1].x"] + 1j * points.columns["disc[1].y"]
    return float(np.abs(z - z[0] - truth).max() / np.abs(truth).max() / TOLERANCE)


@pytest.mark.slow
def test_order_five_keeps_its_promise_where_the_default_is_off(truth: np.ndarray) -> None:
    """Errors of hundreds of revolutions add up; those of radau5 are too small for that."""
    default = _error(_run(), truth)
    fifth = _error(_run(parameters={"solver.method": "radau5"}), truth)
    assert fifth < 1.0
    assert 100.0 < default < 300.0


def test_verify_reports_it() -> None:
    """The finer run of `verify` shows that the default's errors are too large."""
    with pytest.warns(UserWarning, match="not confirmed: .* instead of"):
        assert "not-confirmed" in _run(verify=True).status
