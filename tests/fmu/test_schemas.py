"""Every XML file that is written, against the schema of its standard."""

import zipfile
from importlib.util import find_spec
from pathlib import Path

import fmpy
import pytest
from lxml import etree
from rotor_fmu.examples import example_folder
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.machine_file.loading import machine_text

from .test_hosts import needs

SCHEMAS = Path(fmpy.__file__).parent
FMI2 = SCHEMAS / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
FMI3 = SCHEMAS / "schema" / "fmi3"
SSP = SCHEMAS / "ssp" / "schema" / "SystemStructureDescription.xsd"
# Of FMI-LS-REF, which no package has.
MANIFEST = Path(__file__).parents[1] / "reference" / "fmi3LayeredStandardReferenceManifest.xsd"
EXAMPLES = Path(__file__).parents[2] / "examples"
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
SYSTEMS = sorted(EXAMPLES.glob("*/SystemStructure.ssd"))
OSP_SYSTEMS = sorted(EXAMPLES.glob("*/OspSystemStructure.xml"))
MACHINES = [None, *(EXAMPLES / name for name in ("drop/compressor.toml", "from_ross/rubbing.toml"))]


def described_by(schema):
    """A schema, its parts from the folder that has them."""
    text = schema.read_text(encoding="utf-8")
    text = text.replace("https://raw.githubusercontent.com/modelica/fmi-standard/main/schema", ".")
    folder = FMI3 if schema == MANIFEST else schema.parent
    return etree.XMLSchema(etree.fromstring(text.encode(), base_url=f"{folder}/schema.xsd"))


def mistakes(content, schema):
    """What a file's text has that its schema does not allow, by line."""
    described = described_by(schema) if isinstance(schema, Path) else schema
    described.validate(etree.fromstring(content))
    return [f"line {error.line}: {error.message}" for error in described.error_log]


def osp_schema():
    """OSP's schema, which stands in libcosim's library."""
    folder = Path(find_spec("libcosimpy").origin).parent
    content = next(folder.rglob("*libcosimc*.so")).read_bytes()
    begin, end = content.index(b"<xs:schema"), content.index(b"</xs:schema>")
    return etree.XMLSchema(etree.fromstring(content[begin : end + len(b"</xs:schema>")]))


def xml_of(fmu):
    """The XML files of an FMU by their path in it."""
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name.endswith(".xml")}


# of each machine one drive, which every machine has alike
@pytest.mark.parametrize(
    ("machine", "is_free"),
    [
        pytest.param(
            machine,
            is_free,
            id=f"{machine.name if machine else 'rig'}-{is_free}",
            marks=() if is_free == (machine is None) else pytest.mark.slow,
        )
        for machine in MACHINES
        for is_free in (False, True)
    ],
)
@pytest.mark.parametrize("kind", ["python", 2, 3])
def test_all_of_an_fmu_is_valid(tmp_path, kind, machine, is_free):
    toml = machine_text("", machine) if machine else rig_toml()
    if kind == "python":
        fmu = build(tmp_path, machine_of(toml, is_free))
    else:
        fmu = build_native(tmp_path, machine_of(toml, is_free), kind, ["linux64"])
    result = xml_of(fmu)
    description = FMI3 / "fmi3ModelDescription.xsd" if kind == 3 else FMI2
    assert mistakes(result.pop("modelDescription.xml"), description) == []
    assert mistakes(result.pop(TERMINALS), FMI3 / "fmi3TerminalsAndIcons.xsd") == []
    for path in [path for path in result if path.endswith("fmi-ls-manifest.xml")]:
        assert mistakes(result.pop(path), MANIFEST) == []
    assert not result


def test_partners_are_described_as_their_schema_wants(tmp_path):
    for name in ("drive_train", "magnetic_bearing"):
        fmu = Coupling(example_folder(name) / f"{name}.py").build(tmp_path)
        (content,) = xml_of(fmu).values()
        assert mistakes(content, FMI2) == []


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda path: path.parent.name)
def test_systems_are_valid_as_ssp(system):
    assert mistakes(system.read_bytes(), SSP) == []


@needs("libcosimpy", "pip install libcosimpy")
@pytest.mark.parametrize("system", OSP_SYSTEMS, ids=lambda path: path.parent.name)
def test_systems_are_valid_for_osp(system):
    assert mistakes(system.read_bytes(), osp_schema()) == []


def test_the_examples_have_systems():
    assert SYSTEMS
    assert OSP_SYSTEMS
