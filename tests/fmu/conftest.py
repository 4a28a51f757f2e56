"""The FMU that these tests drive, built once."""

from pathlib import Path

import pytest

from rotor_fmu.bundle import build


@pytest.fixture(scope="session")
def fmu(tmp_path_factory) -> Path:
    return build(tmp_path_factory.mktemp("fmu"))
