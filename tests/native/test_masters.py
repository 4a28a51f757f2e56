"""Masters of others with the native FMU: the tests of the FMU in Python, with this one in its
place."""

import shutil

import pytest

import rotor_fmu as rf

from ..fmu.test_hosts import (  # noqa: F401
    cofmpys_results,
    motor,
    test_cofmpy_does_not_end_in_silence_when_the_rotor_fails,
    test_cofmpy_gives_what_a_plain_master_gives,
    test_fmpy_info_shows_what_it_is,
    test_fmpy_simulate_gives_what_its_api_gives,
    test_libcosim_does_not_end_in_silence_when_the_rotor_fails,
    test_libcosim_gives_what_a_plain_master_gives,
)
from .conftest import HERE


@pytest.fixture(scope="session")
def fmu(make, tmp_path_factory):
    """Under the name that the systems' files have."""
    return shutil.copy(make(), tmp_path_factory.mktemp("named") / "RotorBearing.fmu")


@pytest.fixture(scope="module")
def begun(fmu, tmp_path_factory):
    """Likewise, with the preset that libcosim, which leaves enumerations out, cannot set; `fmu` has
    seen to it that there is a library."""
    folder = tmp_path_factory.mktemp("begun")
    built = rf.build_fmu(
        *(rf.load(), folder),
        is_native=True,
        platforms=[HERE],
        parameters={"solver.preset": "paper"},
    )
    return built.rename(folder / "RotorBearing.fmu")
