"""The reference result in the FMU: its default experiment, as the layered standard FMI-LS-REF lays
out related files. `python -m rotor_fmu.reference` makes it anew after a change of the model."""

from __future__ import annotations

import csv
import io
import tempfile
from importlib.resources import files
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, register_namespace, tostring

import fmpy

from model.rotor import Rotor
from model.rotor_toml import rig

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
_MANIFEST = "http://fmi-standard.org/fmi-ls-manifest"
_DOCUMENT = "fmi-ls-ref.txt"
_TEXT = f"""The result in {FOLDER} is the result of the default experiment: all
inputs and parameters at their start values, communication steps of 0.04 s from 0 to 40 s, every
output in SI units (Booleans as 0 and 1). The rotor starts at rest in its bearings and settles in
a steady motion, so another processor gives the same within 1e-3 of each output's range.
"""


def related_files(rotor: Rotor, name: str) -> dict[str, bytes]:
    """Files of the FMU called `name`, by their path in it; none for a rotor other than the paper's
    rig, and none where no result is stored."""
    result = stored(name)
    if rotor != rig() or not result.is_file():
        return {}
    return {
        f"{FOLDER}/fmi-ls-manifest.xml": _manifest(result.name),
        f"{FOLDER}/{result.name}": result.read_bytes(),
        f"documentation/{_DOCUMENT}": _TEXT.encode(),
    }


def stored(name: str) -> Path:
    """The file that goes into the FMU called `name`."""
    return Path(str(files(__package__).joinpath("pages", f"{name}_out.csv")))


def _manifest(result: str) -> bytes:
    register_namespace("fmi-ls", _MANIFEST)
    root = Element(
        "fmiReferences",
        {
            f"{{{_MANIFEST}}}fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
            f"{{{_MANIFEST}}}fmi-ls-version": "1.0.0-alpha.1",
            f"{{{_MANIFEST}}}fmi-ls-description": "Layered Standard providing information on "
            "related files included in an FMU.",
        },
    )
    for kind, source, role, what in (
        ("text/csv", result, "result", "Output of the default experiment"),
        ("text/plain", f"../../documentation/{_DOCUMENT}", "document", "About that output"),
    ):
        SubElement(root, "Related", type=kind, source=source, role=role, description=what)
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8")


def default_experiment(fmu: Path) -> bytes:
    """CSV of the FMU's default experiment through FMPy: time [s] and every output in SI units."""
    result = fmpy.simulate_fmu(str(fmu))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(result.dtype.names)
    writer.writerows([f"{float(value) + 0.0:.8g}" for value in row] for row in result)
    return text.getvalue().encode()


def main() -> None:
    """Run the default experiment and store its result."""
    from .bundle import build

    with tempfile.TemporaryDirectory() as folder:
        fmu = build(Path(folder))
        target = stored(fmu.stem)
        target.write_bytes(default_experiment(fmu))
    print(target)


if __name__ == "__main__":
    main()
