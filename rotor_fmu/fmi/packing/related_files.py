"""Files beside the model in the FMU: a reference result, laid out as FMI-LS-REF asks."""

from importlib.resources import files
from pathlib import Path
from string import Template
from xml.etree.ElementTree import Element, SubElement, register_namespace

from ...model.machine.rotor import Rotor
from ...model.machine.toml import rig
from ..description import default_experiment
from .archive import xml_bytes

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
MANIFEST = "http://fmi-standard.org/fmi-ls-manifest"
_DOCUMENT = "fmi-ls-ref.txt"
_TEXT = f"""The result in {FOLDER} is the result of the default experiment: all
inputs and parameters at their start values, communication steps of $step s from 0 to $stop s, every
output in SI units (Booleans as 0 and 1). The rotor starts at rest in its bearings and settles in
a steady motion, so another processor gives the same within 1e-3 of each output's range.
"""


def related_files(rotor: Rotor, name: str) -> dict[str, bytes]:
    """Return the files of the FMU called `name`, by their path in it; none for a rotor other than
    the paper's rig, and none where no result is stored."""
    result = stored(name)
    if rotor != rig() or not result.is_file():
        return {}
    return {
        f"{FOLDER}/fmi-ls-manifest.xml": _manifest(result.name),
        f"{FOLDER}/{result.name}": result.read_bytes(),
        f"documentation/{_DOCUMENT}": Template(_TEXT)
        .substitute(vars(default_experiment(rotor)))
        .encode(),
    }


def stored(name: str) -> Path:
    """Return the file that goes into the FMU called `name`."""
    return Path(str(files(__package__).joinpath("pages", f"{name}_out.csv")))


def manifest(root: str, name: str, version: str, description: str) -> Element:
    """Return the root, so called, of the manifest of a layered standard, with what the standard is
    called, its version and its description."""
    register_namespace("fmi-ls", MANIFEST)
    said = {"name": name, "version": version, "description": description}
    return Element(root, {f"{{{MANIFEST}}}fmi-ls-{key}": value for key, value in said.items()})


def _manifest(result: str) -> bytes:
    root = manifest(
        "fmiReferences",
        "org.fmi-standard.fmi-ls-ref",
        "1.0.0-alpha.1",
        "Layered Standard providing information on related files included in an FMU.",
    )
    for kind, source, role, what in (
        ("text/csv", result, "result", "Output of the default experiment"),
        ("text/plain", f"../../documentation/{_DOCUMENT}", "document", "About that output"),
    ):
        SubElement(root, "Related", type=kind, source=source, role=role, description=what)
    return xml_bytes(root)
