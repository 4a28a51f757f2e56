"""The FMU's documents for people and tools: pages with a table of the variables, picture, licences,
terminals, and a reference result, laid out as FMI-LS-REF asks."""

import html
import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from string import Template
from xml.etree.ElementTree import Element, SubElement, register_namespace

from ...about import __version__
from ...cells import markdown_table
from ...model.machine.rotor import Rotor
from ...model.machine.toml import rig
from ..description import Described, default_experiment, summary
from ..terminals import terminals_element, terminals_of
from ..variables import Variable, unit
from .archive import xml_bytes

_DEPENDENCIES = """This FMU runs in the Python of its host: Python 3.11 or newer, and no
package beside it. The solver is machine code, in a library for each system that it runs on:
resources/*/linux64.so, resources/*/win64.dll.
No network, no licence, no files but these.
"""
_REFERENCE = """<h2>A reference result</h2>
<p>The FMU carries the result of its default experiment, to compare an import with: see
<a href="fmi-ls-ref.txt">fmi-ls-ref.txt</a>.</p>
"""
_RUN_DOWN = """<h2>A run-down</h2>
<p>The test rig of Zigulic et al. (2003) from 400 rad/s to rest in 40 s: blue this FMU's default,
orange the paper's integrator at 4 ms. Outputs are those of the communication points: take some 64 a
turn to see the motion, 0.25 ms at 60 Hz, or look at <tt>disc[3].x_amp</tt>, the largest of a
turn.</p>
<p><img src="run_down.png" alt="horizontal amplitude against speed"></p>
"""
# What the page says of the host.
_START = """<p>$needs
With FMPy, <code>fmpy simulate $name.fmu --show-plot</code>. A warning or an error is one sentence
on standard error, and in the host's log where logging is switched on.</p>
"""
_NEEDS_PYTHON = """The host runs, or can load, Python 3.11 or newer, and needs no package beside it:
the solver comes as machine code."""
_NEEDS_NOTHING = """The host needs nothing but the FMU: its libraries hold the solver as machine
code."""
_NEEDS_COMPILER = """The FMU holds C17 source code and no library: the host, or a C compiler before
it (<code>fmpy compile</code>), makes one."""
# What the page says of the drive, by the input that drives.
_DRIVES = {
    "speed": "the speed of the shaft and the external loads go in; displacements, contact angles "
    "and the torque that the drive must supply come out",
    "tau_drive": "the torque of the drive and the external loads go in; speed and angle of the "
    "shaft, displacements and contact angles come out. Friction, whirl and unbalance slow it",
}
_HEAD = ("variable", "causality", "unit", "start", "what it is")
FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
MANIFEST = "http://fmi-standard.org/fmi-ls-manifest"
_DOCUMENT = "fmi-ls-ref.txt"
_TEXT = f"""The result in {FOLDER} is the result of the default experiment: all
inputs and parameters at their start values, communication steps of $step s from 0 to $stop s, every
output in SI units (Booleans as 0 and 1). The rotor starts at rest in its bearings and settles in
a steady motion, so another processor gives the same within 1e-3 of each output's range.
"""


def documents(of: Described, table: Sequence[Variable], fmi: int) -> dict[str, bytes]:
    """Return the files of an FMU by their path in it; fmi: the version of FMI."""
    from ...plotting.machine_drawing import machine_picture  # with matplotlib, which no run needs

    picture = machine_picture(of.rotor)
    related = related_files(of.rotor, of.identifier)
    pages = files(__package__).joinpath("pages")
    carried = ("rotor-fmu", "pythonfmu") if of.needs_python else ("rotor-fmu",)
    result = {
        # where FMI 3.0 wants it, and FMI 2.0
        "terminalsAndIcons/icon.png" if fmi == 3 else "model.png": picture,
        "documentation/model.png": picture,
        "documentation/index.html": _index(of, table, fmi).encode(),
        "terminalsAndIcons/terminalsAndIcons.xml": terminals(table),
        **{f"documentation/licenses/{project}.txt": _licence(project) for project in carried},
        **related,
    }
    if of.rotor == rig():
        result["documentation/run_down.png"] = pages.joinpath("run_down.png").read_bytes()
    if of.needs_python:
        result["documentation/externalDependencies.txt"] = _DEPENDENCIES.encode()
    return result


def _index(of: Described, table: Sequence[Variable], fmi: int) -> str:
    rotor, name = of.rotor, of.identifier
    needs = _NEEDS_COMPILER if of.sources else _NEEDS_NOTHING
    needs = _NEEDS_PYTHON if of.needs_python else needs
    page = files(__package__).joinpath("pages", "index.html").read_text(encoding="utf-8")
    head, *body = rows(table)
    cells = ["<tr>" + "".join(f"<th>{html.escape(c)}</th>" for c in head) + "</tr>"]
    cells += ["<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>" for row in body]
    variables = "<table>\n" + "\n".join(cells) + "\n</table>"
    return Template(page).substitute(
        name=name,
        machine=html.escape(rotor.name or name),
        summary=html.escape(summary(rotor, table[0].name == "tau_drive")),
        drive=_DRIVES[table[0].name],
        fmi=fmi,
        start=Template(_START).substitute(name=name, needs=needs),
        version=__version__,
        variables=variables,
        run_down=_RUN_DOWN if rotor == rig() else "",
        reference=_REFERENCE if related_files(rotor, name) else "",
    )


def _licence(of: str) -> bytes:
    """Return the licence of an installed distribution."""
    from importlib.metadata import distribution

    carried = distribution(of).files or ()
    result = next(file for file in carried if file.name.upper().startswith("LICEN"))
    return Path(str(result.locate())).read_bytes()


def terminals(table: Sequence[Variable]) -> bytes:
    """Return terminalsAndIcons.xml. FMI 2.0 takes terminals as FMI 3.0 defines them."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    root.append(terminals_element(terminals_of(table)))
    return xml_bytes(root)


def rows(table: Sequence[Variable]) -> list[tuple[str, ...]]:
    """Return the head and rows; variables of parts that there are several of once, as `disc[i]`,
    with the start value of each if they differ, unless some of these parts have none."""
    alike: dict[tuple[str, str], list[Variable]] = {}
    numbers: dict[str, set[str]] = {}
    for variable in table:
        kind, number, rest = _numbered(variable.name)
        alike.setdefault((kind, rest), []).append(variable)
        numbers.setdefault(kind, set()).add(number)
    listed: list[tuple[str, ...]] = [_HEAD]
    for (kind, rest), variables in alike.items():
        is_of_all = bool(kind) and len(variables) == len(numbers[kind])
        for variable in variables[: 1 if is_of_all else None]:
            name, text = variable.name, re.sub(r" at z = \S+ m", "", variable.text)
            if is_of_all:
                number = _numbered(name)[1]
                name, text = f"{kind}[i]{rest}", text.replace(f"{kind} {number}", f"{kind} i")
            starts = [_start(v) for v in (variables if is_of_all else [variable])]
            start = starts[0] if len(set(starts)) == 1 else ", ".join(starts)
            causality = f"{'tunable ' if variable.is_tunable else ''}{variable.causality}"
            listed.append((name, causality, _unit(variable), start, text))
    return listed


def _numbered(name: str) -> tuple[str, str, str]:
    """Return a variable's kind of part, its number and what follows; of other names all is that."""
    found = re.match(r"(\w+)\[(\d+)\]", name)
    return (found[1], found[2], name[found.end() :]) if found else ("", "", name)


def markdown(table: Sequence[Variable]) -> str:
    """Return the table in Markdown."""
    head, *body = rows(table)
    return markdown_table(head, ((f"`{name}`", *rest) for name, *rest in body)) + "\n"


def _unit(variable: Variable) -> str:
    if variable.kind != "Real":
        return variable.kind
    display = unit(variable.unit).display
    return f"{variable.unit} ({display[0]})" if display else variable.unit


def _start(variable: Variable) -> str:
    if variable.start is None:
        return ""
    if variable.kind == "Boolean":
        return str(variable.start).lower()
    if variable.choices:
        return variable.choices[int(variable.start)]
    return f"{variable.start:g}"


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
