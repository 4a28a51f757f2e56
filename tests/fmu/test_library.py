"""The library of kernels that the FMU carries: nothing is compiled, and numba is not needed."""

import hashlib
import zipfile

import pytest
from rotor_fmu.model.kernels import library

from rotor_fmu.packing.bundle import build

from .test_hosting import in_a_process

pytestmark = pytest.mark.skipif(library.loaded() is None, reason="no library: rotor-fmu core")

RUN = """
sys.modules["numba"] = None  # as if it were not installed
instance = new()
shutil.rmtree(folder)
start(instance, speed=300.0)
instance.doStep(0.0, 0.004)
print(instance.getReal([refs["disc[3].x"], refs["disc[3].y"]]))
"""


@pytest.fixture(autouse=True)
def unforced(monkeypatch):
    """Whatever these tests are run with: the FMU chooses what carries out its kernels."""
    monkeypatch.delenv("ROTOR_FMU_KERNELS", raising=False)


def with_library(fmu, target, content):
    """A copy whose library holds something else, under the name that belongs to it."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as sink:
        for name in source.namelist():
            if "/model/library/linux64." in name:
                *begin, _checksum, suffix = name.split(".")
                checksum = hashlib.sha256(content).hexdigest()[:16]
                sink.writestr(".".join([*begin, checksum, suffix]), content)
            else:
                sink.writestr(name, source.read(name))
    return target


def test_the_fmu_runs_without_numba_from_a_folder_that_is_gone_and_keeps_nothing(fmu, tmp_path):
    done = in_a_process(fmu, RUN + "assert log == []", {"ROTOR_FMU_CACHE": str(tmp_path)})
    assert done.stderr == ""
    assert list(tmp_path.iterdir()) == []


def test_its_numbers_are_those_without_the_library(fmu):
    (machine_code,) = {in_a_process(fmu, RUN).stdout for _ in range(2)}
    assert in_a_process(fmu, RUN, {"ROTOR_FMU_KERNELS": "python"}).stdout == machine_code


def test_where_the_library_does_not_load_it_says_so_once_and_runs(fmu, tmp_path):
    broken = with_library(fmu, tmp_path / "broken.fmu", b"\x7fELF and no more")
    done = in_a_process(broken, RUN)
    said = done.stderr.splitlines()
    assert len(said) == 2
    assert "the library of the solver cannot be loaded" in said[0]
    assert "warning: numba is not installed" in said[1]


def test_an_fmu_built_without_a_library_asks_for_numba(tmp_path, monkeypatch):
    monkeypatch.setattr("rotor_fmu.packing.bundle.find", lambda platform: None)
    with zipfile.ZipFile(build(tmp_path)) as archive:
        assert b"numba" in archive.read("resources/requirements.txt")
        assert not any("/library/" in name for name in archive.namelist())
