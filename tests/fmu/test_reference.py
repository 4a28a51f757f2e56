"""The reference result that the FMU carries is what it gives, laid out as FMI-LS-REF asks."""

import csv
import io
import posixpath
import zipfile
from xml.etree.ElementTree import fromstring

import fmpy
import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.fmi.packing.archive import contents_of
from rotor_fmu.fmi.packing.documents import FOLDER
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.fmi.packing.reference import default_experiment

LS = "{http://fmi-standard.org/fmi-ls-manifest}"


def table(text):
    """Names and columns of a CSV file."""
    names, *rows = csv.reader(io.StringIO(text.decode()))
    return names, np.array(rows, dtype=float)


def test_the_fmu_gives_the_result_that_it_carries(fmu):
    """After a change of the model that is meant to change numbers: make reference."""
    with zipfile.ZipFile(fmu) as archive:
        names, stored = table(archive.read(f"{FOLDER}/RotorBearing_out.csv"))
    again, result = table(default_experiment(fmu))
    assert names == again
    assert stored.shape == result.shape
    for name, old, new in zip(names, stored.T, result.T, strict=True):
        assert np.abs(new - old).max() <= 1e-3 * np.ptp(old), name


def test_it_covers_the_default_experiment_and_every_output(fmu):
    description = fmpy.read_model_description(str(fmu))
    with zipfile.ZipFile(fmu) as archive:
        names, rows = table(archive.read(f"{FOLDER}/RotorBearing_out.csv"))
    outputs = {v.name for v in description.modelVariables if v.causality == "output"}
    assert set(names) == {"time", *outputs}
    experiment = description.defaultExperiment
    start, stop, step = map(float, (experiment.startTime, experiment.stopTime, experiment.stepSize))
    np.testing.assert_allclose(rows[:, 0], np.arange(start, stop + step / 2, step), atol=1e-9)


def test_the_manifest_is_as_the_standard_asks_and_its_files_exist(fmu):
    with zipfile.ZipFile(fmu) as archive:
        root = fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
        files = archive.namelist()
        page = archive.read("documentation/index.html").decode()
    assert root.tag == "fmiReferences"
    assert root.get(f"{LS}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    assert root.get(f"{LS}fmi-ls-version")
    assert root.get(f"{LS}fmi-ls-description").startswith("Layered Standard")
    assert {related.get("role") for related in root} == {"result", "document"}
    for related in root:
        assert posixpath.normpath(f"{FOLDER}/{related.get('source')}") in files
    assert 'href="fmi-ls-ref.txt"' in page


def test_another_rotor_does_not_carry_the_rigs_result(tmp_path):
    other = build(
        tmp_path, machine_of(rig_toml().replace("clearance = 50e-6", "clearance = 60e-6"))
    )
    with zipfile.ZipFile(other) as archive:
        assert not [name for name in archive.namelist() if name.startswith("extra/")]
        assert "fmi-ls-ref" not in archive.read("documentation/index.html").decode()


@pytest.mark.parametrize("attribute", ["author", "version", "license", "copyright", "description"])
def test_the_description_says_whose_it_is(fmu, attribute):
    root = fromstring(contents_of(fmu)["modelDescription.xml"])
    assert root.get(attribute)
