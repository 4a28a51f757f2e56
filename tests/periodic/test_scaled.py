"""The equations of a machine are the same in other lengths and times, also those of laws whose
states are lengths, velocities or speeds of rotation, and so are its responses and what they start
from, in other masses too."""

from itertools import islice

import numpy as np
import pytest

import rotor_fmu as rf

FILM = "length = {l:g}\nviscosity = {eta:g}\nroughness = {r:g}\nclearance = {s:g}\n"
RUB = "clearance = {s:g}\nmu = 0.1\nk = {k:g}\nc = {c:g}\ndelta_c = {r:g}\nv_s = {v:g}\n"
PARTS = {
    "sticking": f"[[contact]]\n{RUB}k_t = {{k:g}}\nc_t = {{c:g}}\n",
    "race": f"[[touchdown_bearing]]\n{RUB}k_t = {{k:g}}\nc_t = {{c:g}}\n"
    "race_inertia = {j:g}\nrace_damping = {d:g}\n",
    "ring": f"[[floating_ring_bearing]]\n{FILM}outer_radius = {{R2:g}}\nouter_length = {{l:g}}\n"
    "outer_clearance = {s2:g}\nouter_viscosity = {eta:g}\nring_mass = 0.03\nring_inertia = {j:g}\n",
    "pads": f"[[journal_bearing]]\n{FILM}tilting = true\npads = [0.5, 2.6, 4.7]\narc = 1.5\n"
    "pad_inertia = {j:g}\npivot_stiffness = {k:g}\n",
}


def equations(part, m, s):
    """The equations of a disc and a part, in lengths of m and times of s."""
    from rotor_fmu.model.periodic.balance import HarmonicBalance
    from rotor_fmu.model.periodic.linear_structure import CondensedMachine

    sizes = {"l": 0.012 * m, "eta": 0.02 / (m * s), "r": 2e-7 * m, "s": 3e-5 * m, "s2": 6e-5 * m}
    sizes |= {"k": 1e6 / s**2, "c": 100 / s, "v": 1e-3 * m / s, "j": 6e-6 * m**2}
    sizes |= {"d": 1e-4 * m**2 / s, "R2": 0.016 * m}
    text = f"""
[material]
young = {2.1e11 / (m * s**2)}
density = {7800 / m**3}
[shaft]
nodes = [0.0, {0.15 * m}, {0.5 * m}]
diameters = [{0.02 * m}, {0.02 * m}]
[[disc]]
node = 2
diameter = {0.2 * m}
width = {0.02 * m}
e = {8e-5 * m}
[[support]]
node = 1
stiffness = {1e6 / s**2}
[[support]]
node = 3
stiffness = {1e6 / s**2}
{PARTS[part].format(**sizes)}
node = 3
journal_radius = {0.012 * m}
"""
    machine = CondensedMachine(rf.parse(text).rotor)
    return HarmonicBalance(lambda _: machine, "speed", 100 / s, 250 / s, 3)


@pytest.mark.parametrize("part", PARTS)
def test_equations_are_the_same_in_other_lengths_and_times(part):
    m, s = 1e-2, 1e-1
    first, second = equations(part, 1.0, 1.0), equations(part, m, s)
    x = 0.05 * np.random.default_rng(3).standard_normal(first.size)
    x[first.b] = x[2 * first.b + 1] = 1.2 if part in ("sticking", "race") else 0.3
    (residual, jacobian), (seen, slope) = (
        first.linearized(x, 250.0),
        second.linearized(x, 250.0 / s),
    )
    assert seen == pytest.approx(residual, rel=1e-6, abs=1e-8 * np.abs(residual).max())
    assert slope == pytest.approx(jacobian, rel=1e-3, abs=1e-4 * np.abs(jacobian).max())


LOW, HIGH = 240.0, 252.0  # rad/s
# all at once, in powers that do not make up for each other; each alone with the slow tests
OTHERS = [
    (2.0**-6, 2.0**-5, 2.0**9),
    *(
        pytest.param(*each, marks=pytest.mark.slow)
        for each in (
            (2.0**-6, 1.0, 1.0),
            (1.0, 2.0**-6, 1.0),
            (1.0, 1.0, 2.0**6),
            (1.0, 2.0**6, 1.0),
        )
    ),
]


def sagging(m=1.0, s=1.0, kg=1.0):
    """A rotor that sags into its stator, and sticks to it, in lengths of m, times of s and masses
    of kg; powers of 2, which round nothing."""
    k, c = kg / s**2, kg / s
    bearings = "".join(
        f"""
[[linear_bearing]]
node = {node}
kxx = {share * 1e4 * k}
kyy = {share * 1e4 * k}
cxx = {share * 10.0 * c}
cyy = {share * 10.0 * c}
"""
        for node, share in ((1, 0.01), (2, 0.98), (3, 0.01))
    )
    text = f"""
gravity = {9.75 * m / s**2}
[material]
young = {2.1e10 * kg / (m * s**2)}
density = {3.0 * kg / m**3}
[shaft]
nodes = [0.0, {0.05 * m}, {0.1 * m}]
diameters = [{0.02 * m}, {0.02 * m}]
[[point_mass]]
node = 2
mass = {kg}
{bearings}
[[contact]]
node = 2
journal_radius = {0.05 * m}
clearance = {1e-3 * m}
mu = 0.05
k = {4e4 * k}
c = {5.0 * c}
delta_c = {1e-6 * m}
v_s = {1e-3 * m / s}
k_t = {4e4 * k}
c_t = {50.0 * c}
[[unbalance]]
node = 2
amount = {3e-4 * m * kg}
"""
    return rf.parse(text)


def settled(m=1.0, s=1.0, kg=1.0):
    """The motion after a run from rest, in lengths of m."""
    from rotor_fmu.model.periodic.problem import Task, machines_of
    from rotor_fmu.model.periodic.starting_points import guesses

    rotor, task = sagging(m, s, kg).rotor, Task(LOW / s, HIGH / s)
    # of a run of 30 periods; to ask for more motions would begin another
    guessed = guesses(rotor, task, machines_of(rotor, task), LOW / s, False, [])
    return list(islice(guessed, 2))[1].b / m


@pytest.fixture(scope="module")
def settled_at():
    return settled()


@pytest.mark.parametrize(("m", "s", "kg"), OTHERS)
def test_what_a_run_in_time_comes_to_is_the_same_in_other_units(settled_at, m, s, kg):
    size = np.abs(settled_at).max()
    assert settled(m, s, kg) == pytest.approx(settled_at, rel=0.0, abs=1e-5 * size)


@pytest.fixture(scope="module")
def response():
    return rf.response(sagging(), speed=(LOW, HIGH), step=0.4)


@pytest.mark.parametrize(("m", "s", "kg"), OTHERS)
def test_a_response_has_the_same_points_and_multipliers_in_other_units(response, m, s, kg):
    other = rf.response(sagging(m, s, kg), speed=(LOW / s, HIGH / s), step=0.4)
    pairs = zip(response.points, other.points, strict=True)
    for first, second in pairs:
        assert s * second.value == pytest.approx(first.value, rel=1e-7)
        size = np.abs(first.orbit.b).max()
        assert second.orbit.b / m == pytest.approx(first.orbit.b, abs=1e-6 * size)
        largest = np.abs(first.multipliers[0]), np.abs(second.multipliers[0])
        assert largest[1] == pytest.approx(largest[0], rel=1e-6)
