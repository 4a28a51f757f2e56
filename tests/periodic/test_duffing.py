"""A disc on a cubic spring, Duffing's equation in the plane: exact circles of one harmonic."""

import json

import numpy as np
import pytest

from ..parts.machines import bearings, rigid
from ..test_new_part import HERE, copy, run  # noqa: F401
from .machines import OMEGA

ZETA, CUBIC, UNBALANCE = 0.05, 4e9, 0.3e-3  # [1], [N/m3], [kg.m]


def squares(speed):
    """Squares of the radii [m2] of (k - m w^2 + k3 r^2)^2 r^2 + (c w r)^2 = (U w^2)^2, m = 1."""
    a, c = OMEGA**2 - speed**2, 2 * ZETA * OMEGA * speed
    return np.roots([CUBIC**2, 2 * a * CUBIC, a * a + c * c, -((UNBALANCE * speed**2) ** 2)])


def count(speed):
    return int((np.abs(squares(speed).imag) < 1e-9 * np.abs(squares(speed)).max()).sum())


def fold(low, high):
    """Where the number of circles changes, by bisection."""
    at_low = count(low)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if count(middle) == at_low else (low, middle)
    return low


@pytest.mark.slow  # the copy compiles its laws
def test_duffings_folds_and_circles_are_those_of_the_closed_form(copy, tmp_path):  # noqa: F811
    file = tmp_path / "duffing.toml"
    file.write_text(
        rigid(
            parts=bearings(OMEGA**2, 2 * ZETA * OMEGA)
            + f"[[cubic_spring]]\nnode = 2\ncubic = {CUBIC}\n"
            + f"[[unbalance]]\nnode = 2\namount = {UNBALANCE}\n"
            + "[[sensor]]\nnode = 2\nname = 'disc'\n"
        )
    )
    output = run(copy, HERE / "duffing.py", file).splitlines()[-1]
    seen = json.loads(output)
    speeds = np.linspace(80.0, 260.0, 2000)
    counts = [count(s) for s in speeds]
    turns = [i for i in range(1, len(speeds)) if counts[i] != counts[i - 1]]
    expected = [fold(speeds[i - 1], speeds[i]) for i in turns]
    assert len(expected) >= 1
    assert sorted(seen["folds"]) == pytest.approx(sorted(expected), rel=1e-5)
    radii = (
        np.sqrt(np.sort(squares(140.0).real))[: count(140.0)]
        if count(140.0) == 3
        else (np.sqrt([r.real for r in squares(140.0) if abs(r.imag) < 1e-12]))
    )
    assert sorted(r for r, _ in seen["points"]) == pytest.approx(sorted(radii), rel=1e-5)
    stable = [s for _, s in sorted(seen["points"])]
    assert stable == ([True, False, True] if len(stable) == 3 else [True])
