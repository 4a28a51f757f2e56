"""The comparison of ways to couple a motor with the rotor through a stiff shaft."""

import fmpy
import numpy as np
import pytest
from rotor_fmu.examples.drive_train import compare

from rotor_fmu.fmi.packing.native_fmu import build_native

STOP, LONG, SHORT = 0.3, 1.5e-2, 1e-4


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    fmu = build_native(tmp_path_factory.mktemp("free"), is_free=True, platforms=["linux64"])
    return fmpy.extract(str(fmu))


@pytest.fixture(scope="module")
def reference(folder):
    return compare.couple(folder, "one Newton iteration", SHORT, STOP).w


def test_at_ten_radians_of_the_joint_a_step_one_newton_iteration_holds(folder, reference):
    """Where explicit coupling, with derivatives and iterated too, diverges."""
    frequency = np.sqrt(compare.STIFFNESS * (1 / compare.J_MOTOR + 1 / 0.00954))
    assert frequency * LONG == pytest.approx(10.0, rel=0.01)
    for way in ("explicit", "explicit with derivatives", "iterated"):
        assert not np.isfinite(compare.couple(folder, way, LONG, STOP).w).all(), way
    newton = compare.couple(folder, "one Newton iteration", LONG, STOP)
    assert np.max(np.abs(newton.w / reference - 1)) < 1e-3
    assert newton.lost < 1e-4


def test_derivatives_take_most_of_an_explicit_couplings_error_away(folder, reference):
    plain = compare.couple(folder, "explicit", SHORT, STOP)
    better = compare.couple(folder, "explicit with derivatives", SHORT, STOP)
    assert better.lost < 0.1 * plain.lost


def test_a_line_is_stable_at_every_step_and_loses_little(folder):
    for h in (5e-4, 3e-3, LONG):
        assert np.isfinite(compare.couple(folder, "transmission line", h, STOP).w).all()
    assert compare.couple(folder, "transmission line", 5e-4, STOP).lost < 1e-4
