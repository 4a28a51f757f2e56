"""The page on which a machine runs, in one file that needs no network."""

import base64
import hashlib
import zlib
from collections.abc import Mapping
from typing import Any

from ..about import __version__
from ..fmi.machine_table import table_bytes
from ..fmi.packing.machine_files import Machine
from ..library.build import library, sources_digest
from ..library.platforms import WASM
from ..report.run_page import head, json_in_script, machine_html, template
from ..runs.peaks import START_UP
from .controls import MOST_ROWS, course, groups, places, recorded, shown_in

_PACKAGE = __package__
_SCRIPTS = ("plan.js", "chart.js", "panel.js", "pictures.js", "page.js")


def solver_page(machine: Machine, given: Mapping[str, float] | None = None) -> str:
    """Return the page of a machine as HTML; given: values of its controls at the beginning, in SI
    units, where they differ from the machine file's.

    Raises `QuantityError` for an impossible machine and `LibraryError` where there is no library
    for a page and none can be made.
    """
    script = "\n".join(_template(name) for name in _SCRIPTS)
    css = f"{template('page.css').template}\n{_template('page.css')}"
    return template("page.html", _PACKAGE).substitute(
        head=head(machine.rotor.name or "rotor", css, _policy(script, css)),
        machine=machine_html(machine.rotor),
        footer=f"rotor-fmu {__version__}",
        data=json_in_script(page_data(machine) | {"given": given or {}}),
        wasm=_packed(library(WASM).read_bytes()),
        table=_packed(solver_table(machine)),
        solver=_template("solver.js"),
        script=script,
    )


def solver_table(machine: Machine) -> bytes:
    """Return the table of a machine as the page's solver reads it."""
    return table_bytes(machine.rotor, machine.table, machine.is_free, sources_digest(), "")


def page_data(machine: Machine) -> dict[str, Any]:
    """Return what the page's scripts know of a machine: controls, what is recorded, places, and the
    course of the speed, SI units; when a run's start-up is over; and the units of what is shown."""
    index = {variable.name: i for i, variable in enumerate(machine.table)}
    return {
        "name": machine.rotor.name,
        "groups": groups(machine),
        "recorded": recorded(machine),
        "places": places(machine),
        "speed": index["speed"],
        "speed_rate": index["speed_rate"],
        "course": course(machine.rotor),
        "mostRows": MOST_ROWS,
        "startUp": START_UP._asdict(),
        "units": {
            "speed": shown_in("rad/s"),
            "displacement": shown_in("m"),
        },
    }


def _template(name: str) -> str:
    return template(name, _PACKAGE).template


def _policy(script: str, css: str) -> str:
    """Return the policy under which a browser lets the page run its own script and nothing else,
    and lets nothing leave it. The worker is a part of the page."""
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src '{_hash(script)}' 'wasm-unsafe-eval'",
            f"style-src '{_hash(css)}'",
            "img-src data:",
            "worker-src blob:",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )


def _hash(text: str) -> str:
    """Return the hash of what stands between two tags of the page, with the lines about it."""
    digest = hashlib.sha256(f"\n{text}\n".encode()).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"


def _packed(data: bytes) -> str:
    return base64.b64encode(zlib.compress(data, 9)).decode("ascii")
