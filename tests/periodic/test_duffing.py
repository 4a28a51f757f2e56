"""A disc on a cubic spring, Duffing's equation in the plane: exact circles of one harmonic against
the closed form; under gravity, with many harmonics, against shooting."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
import scipy.integrate

from ..packaging.test_new_part import HERE, copy, run  # noqa: F401
from ..parts.machines import bearings, rigid
from .machines import OMEGA

ZETA, CUBIC = 0.05, 4e9  # [1], [N/m3]
UNBALANCE, LIGHT = 0.3e-3, 0.1e-3  # [kg.m]
SAG = 3.0  # gravity of the machine with many harmonics [m/s2]

pytestmark = pytest.mark.slow  # the copy's laws are interpreted


def squares(speed, unbalance, zeta=ZETA):
    """Squares of the radii [m2] of (k - m w^2 + k3 r^2)^2 r^2 + (c w r)^2 = (U w^2)^2, m = 1."""
    a, c = OMEGA**2 - speed**2, 2 * zeta * OMEGA * speed
    return np.roots([CUBIC**2, 2 * a * CUBIC, a * a + c * c, -((unbalance * speed**2) ** 2)])


def radii(speed, unbalance):
    """Radii of all circles [m], the smallest first."""
    roots = squares(speed, unbalance)
    return np.sort(np.sqrt(roots[np.abs(roots.imag) < 1e-9 * np.abs(roots).max()].real))


def closed_folds(unbalance, low, high):
    """Where the number of circles changes, by bisection."""
    speeds, found = np.linspace(low, high, 2000), []
    for a, b in pairwise(speeds):
        at_low = len(radii(a, unbalance))
        if at_low == len(radii(b, unbalance)):
            continue
        for _ in range(50):
            middle = 0.5 * (a + b)
            a, b = (middle, b) if len(radii(middle, unbalance)) == at_low else (a, middle)
        found.append(a)
    return found


def machine(folder, name, unbalance, zeta=ZETA, gravity=0.0):
    file = folder / f"{name}.toml"
    file.write_text(
        rigid(
            gravity=gravity,
            parts=bearings(OMEGA**2, 2 * zeta * OMEGA)
            + f"[[cubic_spring]]\nnode = 2\ncubic = {CUBIC}\n"
            + f"[[unbalance]]\nnode = 2\namount = {unbalance}\n"
            + "[[sensor]]\nnode = 2\nname = 'disc'\n",
        ).replace("young = 2.1e10", "young = 2.1e13")  # bends by nothing
    )
    return str(file)


DAMPINGS = (0.05, 0.06, 0.08)
ONE = {"share": 0.5, "step": 3.0, "harmonics": 1}
MANY = {"share": 1e-12, "harmonics": 15, "step": 4.0}


def peak(zeta):
    """Speed and radius where a circle lags by a right angle, a point of the backbone."""
    r_of_speed = LIGHT / (2 * zeta * OMEGA)
    speed = OMEGA / math.sqrt(1 - CUBIC * r_of_speed**2)
    return speed, r_of_speed * speed


@pytest.fixture(scope="module")
def seen(copy, tmp_path_factory):  # noqa: F811
    folder = tmp_path_factory.mktemp("duffing")
    questions = [
        {
            "file": machine(folder, "circles", UNBALANCE),
            "range": (125.0, 155.0),
            "options": ONE,
            "at": (140.0,),
        },
        *(
            {
                "file": machine(folder, f"backbone{i}", LIGHT, zeta),
                "range": (0.85 * peak(zeta)[0], 1.1 * peak(zeta)[0]),
                "options": ONE,
                "at": (peak(zeta)[0],),
            }
            for i, zeta in enumerate(DAMPINGS)
        ),
        {
            "file": machine(folder, "sagging", LIGHT, ZETA, SAG),
            "range": (95.0, 140.0),
            "options": MANY,
            "at": (100.0, 120.0),
        },
    ]
    asked = HERE / "duffing.py", json.dumps(questions)
    return json.loads(run(copy, *asked, NUMBA_DISABLE_JIT="1").splitlines()[-1])


def test_folds_and_circles_are_those_of_the_closed_form(seen):
    expected = closed_folds(UNBALANCE, 125.0, 155.0)
    assert len(expected) >= 1
    folds = sorted(f["speed"] for f in seen[0]["folds"])
    assert folds == pytest.approx(expected, rel=1e-5)
    motions = sorted(seen[0]["motions"]["140.0"], key=lambda m: m["r"])
    assert [m["r"] for m in motions] == pytest.approx(radii(140.0, UNBALANCE).tolist(), rel=1e-5)
    stable = [m["stable"] for m in motions]
    assert stable == ([True, False, True] if len(stable) == 3 else [True])


@pytest.mark.parametrize("i", range(len(DAMPINGS)))
def test_the_backbone_is_that_of_the_closed_form(seen, i):
    """k + k3 r^2 = m w^2 where the motion lags by a right angle."""
    speed, radius = peak(DAMPINGS[i])
    (motions,) = seen[1 + i]["motions"].values()
    largest = max(motions, key=lambda m: m["r"])
    assert largest["r"] == pytest.approx(radius, rel=1e-5)
    assert largest["phase"] == pytest.approx(-math.pi / 2, abs=1e-4)
    assert OMEGA**2 + CUBIC * radius**2 == pytest.approx(speed**2)


def period(state, speed, with_tangent=True):
    """The disc after a turn, and its derivative by where it starts."""
    c = 2 * ZETA * OMEGA

    def rate(t, z):
        (x, y, u, v), S = z[:4], z[4:].reshape(4, 4)
        pull = OMEGA**2 + CUBIC * (x * x + y * y)
        force = LIGHT * speed**2
        a = -pull * x - c * u + force * math.cos(speed * t)
        b = -pull * y - c * v + force * math.sin(speed * t) - SAG
        A = np.zeros((4, 4))
        A[0, 2] = A[1, 3] = 1.0
        A[2:, :2] = -pull * np.eye(2) - 2 * CUBIC * np.outer((x, y), (x, y))
        A[2:, 2:] = -c * np.eye(2)
        return np.concatenate([[u, v, a, b], (A @ S).ravel()])

    start = np.concatenate([state, np.eye(4).ravel()])
    end = scipy.integrate.solve_ivp(
        rate, (0.0, 2 * math.pi / speed), start, "DOP853", rtol=1e-12, atol=1e-15
    ).y[:, -1]
    return end[:4], end[4:].reshape(4, 4)


def shot(state, speed):
    """The periodic motion near a state, by Newton's method."""
    state = np.array(state)
    for _ in range(20):
        end, M = period(state, speed)
        step = np.linalg.solve(M - np.eye(4), state - end)
        state = state + step
        if np.abs(step).max() < 1e-11 * np.abs(state).max():
            return state, M
    raise AssertionError("shooting does not converge")


def shot_fold(state, speed):
    """The fold near a state and a speed: where one multiplier is 1, by Newton's method."""
    scale = np.array([1e-3, 1e-3, 0.1, 0.1, 100.0])

    def lack(z):
        end, M = period(z[:4] * scale[:4], z[4] * scale[4])
        return np.append((end - z[:4] * scale[:4]) / scale[:4], np.linalg.det(M - np.eye(4)))

    z = np.append(state, speed) / scale
    for _ in range(30):
        J = np.empty((5, 5))
        for i in range(5):
            step = 1e-5 * np.eye(5)[i]
            J[:, i] = (lack(z + step) - lack(z - step)) / 2e-5
        change = np.linalg.solve(J, -lack(z))
        z = z + change
        if np.abs(change).max() < 1e-9:
            return z[4] * scale[4]
    raise AssertionError("shooting does not converge")


def test_motions_of_fifteen_harmonics_are_those_of_shooting(seen):
    count = 0
    for speed, motions in seen[-1]["motions"].items():
        for m in motions:
            assert m["H"] == 15
            state, M = shot(m["state"], float(speed))
            size = np.abs(state[:2]).max() * np.array([1.0, 1.0, OMEGA, OMEGA])
            assert np.abs((state - m["state"]) / size).max() < 1e-6
            assert (np.abs(np.linalg.eigvals(M)).max() < 1) == m["stable"]
            count += 1
    assert count > len(seen[-1]["motions"])  # more than one somewhere


def test_folds_of_fifteen_harmonics_are_those_of_shooting(seen):
    assert len(seen[-1]["folds"]) >= 2
    for fold in seen[-1]["folds"]:
        assert fold["H"] == 15
        assert fold["speed"] == pytest.approx(shot_fold(fold["state"], fold["speed"]), rel=1e-6)
