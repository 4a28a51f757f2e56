"""A study whose rows were made in one go."""

import pytest

from rotor_fmu import studies
from rotor_fmu.studies.runner import run_study

from .functions import here, ishigami_study, quiet


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A study, and its rows made in one go."""
    folder = tmp_path_factory.mktemp("undisturbed")
    study = ishigami_study(folder)
    run_study(study, folder / "out", here, quiet)
    return study, studies.open(folder / "out")
