"""A WebAssembly component in an FMU, as the draft of a layered standard of FMI 3.0 lays it out."""

from ...library.component import component
from ...library.platforms import COMPONENT, DRAFT
from .archive import xml_bytes
from .related_files import MANIFEST, manifest

_STANDARD = "org.modelica.fmi-ls-wasm"


def component_files(name: str, table: bytes) -> dict[str, bytes]:
    """Return the component for the machine of a table and its manifest, by their path in the FMU
    called `name`. Raises what `library.component.component` does."""
    return {
        f"binaries/{COMPONENT.fmi3}/{name}{COMPONENT.suffix}": component(table),
        f"extra/{_STANDARD}/manifest.xml": _manifest(),
    }


def _manifest() -> bytes:
    # the version says that the standard is a draft, and of which day
    root = manifest(
        f"{{{MANIFEST}}}fmiLayeredStandardManifest",
        _STANDARD,
        f"0.1.0-draft.{DRAFT:%Y%m%d}",
        "FMI Layered Standard for WebAssembly",
    )
    return xml_bytes(root)
