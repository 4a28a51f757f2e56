"""An environment with some of this one's packages: those that a user would have installed."""

import sysconfig
import tomllib
import venv
from importlib.metadata import distribution, distributions
from pathlib import Path

from packaging.markers import default_environment
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tools.checkout import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def closure(extras):
    """Names of the distributions that pip would install with the project and some of its extras, by
    what the packages of this environment say that they require. Raises `PackageNotFoundError` for
    one that is not installed here."""
    waiting = [(PROJECT["name"], frozenset(extras))]
    there = {}
    while waiting:
        package, wanted = waiting.pop()
        if package in there and wanted <= there[package]:
            continue
        there[package] = there.get(package, frozenset()) | wanted
        for required in map(Requirement, _required(package, wanted)):
            if _applies(required, wanted):
                waiting.append((canonicalize_name(required.name), frozenset(required.extras)))
    return set(there) - {PROJECT["name"]}


def _required(package, extras):
    """What a package requires; of the project by its file, which may be newer than what is
    installed."""
    if package != PROJECT["name"]:
        return distribution(package).requires or ()
    options = PROJECT["optional-dependencies"]
    return [*PROJECT["dependencies"], *(line for extra in extras for line in options[extra])]


def _applies(required, extras):
    if required.marker is None:
        return True
    here = default_environment()
    return any(required.marker.evaluate({**here, "extra": extra}) for extra in ("", *extras))


def environment(folder, packages):
    """Make an environment of the project and of packages of this one, by links, with their
    commands; return the folder of its programs."""
    venv.create(folder, with_pip=False)
    paths = sysconfig.get_paths("venv", {"base": str(folder), "platbase": str(folder)})
    programs, site = Path(paths["scripts"]), Path(paths["purelib"])
    commands = dict(PROJECT["scripts"])
    for part in ("rotor_fmu", "rotor_fmu.model", "rotor_fmu.examples"):
        source = ROOT / part.rpartition(".")[2]
        for entry in source.iterdir():
            link(entry, site.joinpath(*part.split("."), entry.name))
    for top in tops(PROJECT["name"]):  # of it, as it is installed here, what is said about it
        if top.suffix == ".dist-info":
            link(top, site / top.name)
    for name in packages:
        for top in tops(name):
            link(top, site / top.name)
        of = distribution(name)
        commands |= {e.name: e.value for e in of.entry_points.select(group="console_scripts")}
    for name, of in commands.items():
        module, _, function = of.partition(":")
        script = programs / name
        script.write_text(
            f"#!{programs / 'python'}\nimport sys\n"
            f"from {module} import {function}\nsys.exit({function}())\n"
        )
        script.chmod(0o755)
    return programs


def tops(name):
    """What a distribution has put beside the others where it is installed; a checkout may describe
    itself besides."""
    for of in distributions(name=name):
        names = {file.parts[0] for file in of.files or ()} - {".."}
        if any(name.endswith(".dist-info") for name in names):
            return [Path(of.locate_file(name)) for name in sorted(names)]
    return []


def link(source, target):
    """Link a file, or a folder's files: packages may share a folder."""
    if source.name == "__pycache__" or target.is_symlink() or not source.exists():
        return
    if not source.is_dir() or (not target.exists() and (source / "__init__.py").exists()):
        target.parent.mkdir(parents=True, exist_ok=True)
        target.symlink_to(source)
    else:
        target.mkdir(parents=True, exist_ok=True)
        for entry in source.iterdir():
            link(entry, target / entry.name)
