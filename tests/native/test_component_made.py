"""How an FMU's WebAssembly component is made: its archive, interfaces, data, and what cannot be."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from rotor_fmu.errors import InputError
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.library import build
from rotor_fmu.library import component as making
from rotor_fmu.library.build import LibraryError
from rotor_fmu.library.platforms import COMPONENT, DRAFT, PLATFORMS
from rotor_fmu.library.wasm_memory import with_data

from ..processes import ROTOR_FMU, run_anew

wasmtime = pytest.importorskip("wasmtime", reason="wasmtime is not installed")
from .component import BINARY, CO_SIMULATION, JCO, NEEDED, RESOURCE, Component, table_of  # noqa: E402

MANIFEST = "extra/org.modelica.fmi-ls-wasm/manifest.xml"
INTERFACES = Path(making.__file__).parents[1] / "fmi" / "c_component" / "fmi3.wit"


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    folder = tmp_path_factory.mktemp("component")
    return build_native(folder, machine_of(), fmi=3, platforms=["linux64", COMPONENT.name])


@pytest.fixture(scope="module")
def rig(fmu):
    return Component(fmu)


@NEEDED
def test_the_archive_is_laid_out_as_the_draft_wants_it(fmu):
    with zipfile.ZipFile(fmu) as archive:
        names = set(archive.namelist())
        manifest, binary = archive.read(MANIFEST), archive.read(BINARY)
    assert {name for name in names if name.startswith("binaries/")} == {
        BINARY,
        "binaries/x86_64-linux/RotorBearingNative.so",
    }
    assert binary.startswith(b"\0asm\x0d\0\x01\0")  # a component, no module
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3LayeredStandardManifest.xsd"
    rules = etree.XMLSchema(etree.parse(schema))
    assert rules.validate(etree.fromstring(manifest)), rules.error_log
    said = {key.split("}")[1]: text for key, text in ElementTree.fromstring(manifest).items()}
    assert said["fmi-ls-name"] == "org.modelica.fmi-ls-wasm"
    assert re.fullmatch(r"\d+\.\d+\.\d+-draft\.\d{8}", said["fmi-ls-version"])
    assert said["fmi-ls-version"].endswith(f"{DRAFT:%Y%m%d}")
    assert said["fmi-ls-description"] == "FMI Layered Standard for WebAssembly"
    assert validate_fmu(str(fmu)) == []


@NEEDED
def test_its_exports_are_the_worlds_and_it_asks_for_the_logger_alone(fmu, rig, tmp_path):
    text = re.sub(r"//.*", "", INTERFACES.read_text())
    named = re.findall(r"([a-z0-9-]+): (static )?func", text)
    for name, is_static in named:
        if name not in ("log-message", "get-version"):
            kind = "static" if is_static else "method"
            assert rig.function(f"[{kind}]{RESOURCE}.{name}") is not None, name
    assert len(named) == 59
    assert rig.version() == "3.0"
    with zipfile.ZipFile(fmu) as archive:
        (tmp_path / "component.wasm").write_bytes(archive.read(BINARY))
    command = [JCO, "wit", tmp_path / "component.wasm"]
    world = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert set(re.findall(r"export (\S+);", world)) == {"fmi:fmi3/common@3.0.0", CO_SIMULATION}
    assert set(re.findall(r"import (\S+);", world)) == {
        "fmi:fmi3/types@3.0.0",
        "fmi:fmi3/callbacks@3.0.0",
    }


@pytest.fixture(scope="module")
def bare():
    return making.empty_component()


@NEEDED
def test_a_table_that_is_missing_or_damaged_is_refused(fmu, bare):
    table = table_of(fmu)
    damaged = bytearray(table)
    damaged[1000] ^= 1
    stranger = table.replace(b"ROTORFMU", b"ANOTHER!", 1)
    for content, why in (
        (bare, "is not the table of a machine, or is truncated"),
        (with_data(bare, stranger), "is not the table of a machine, or is truncated"),
        (with_data(bare, bytes(damaged)), "is damaged"),
    ):
        machine = Component.__new__(Component)
        machine._load(content)
        assert machine.instantiate("{}") is None
        assert machine.heard[-1][-1] == f"machine.table: {why}"


@NEEDED
@pytest.mark.parametrize("size", [1, 65535, 65536, 65537, 5_000_000])
def test_data_of_any_size_leave_a_valid_component(bare, size):
    data = os.urandom(size)
    made = with_data(bare, data)
    assert data in made
    # compiled, which raises where it is not valid
    assert wasmtime.component.Component(wasmtime.Engine(), made).serialize()


def refused(*arguments, path=None, cache=None):
    """The one sentence of a build that fails, and nothing is written."""
    environment = {"PATH": path} if path else {}
    environment |= {"ROTOR_FMU_CACHE": str(cache)} if cache else {}
    out = Path(arguments[-1])
    done = run_anew(ROTOR_FMU, "build", *arguments, cwd="/", **environment)
    assert done.returncode == 2
    assert not out.exists() or not list(out.iterdir())
    (sentence,) = done.stderr.splitlines()
    return sentence


WANTED = ("--native", "--platform", COMPONENT.name)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (WANTED, "--platform wasm32-wasip2: needs FMI 3.0, not --fmi 2"),
        (("--platform", COMPONENT.name), "must be one of linux64, win64"),
        (("--source", "--platform", COMPONENT.name), "leave out --native and --platform"),
        (("--native", "--platform", "wasm32"), f"{', '.join(PLATFORMS)}, wasm32-wasip2"),
    ],
)
def test_what_cannot_be_is_one_sentence(tmp_path, arguments, sentence):
    assert sentence in refused(*arguments, "--out", tmp_path / "out")


@pytest.mark.parametrize("there", ["node", "jco"])
def test_a_tool_that_is_missing_is_named_and_how_it_is_installed(tmp_path, there):
    folder = tmp_path / "bin"
    folder.mkdir()
    (folder / there).write_text("#!/bin/sh\nexit 1\n")
    (folder / there).chmod(0o755)
    options = {"path": str(folder), "cache": tmp_path / "cache"}
    sentence = refused(*WANTED, "--fmi", 3, "--out", tmp_path / "out", **options)
    missing = "jco" if there == "node" else "node"
    assert f"--platform wasm32-wasip2: {missing}, which makes components, is not there" in sentence
    assert "npm install -g @bytecodealliance/jco" in sentence


def test_zig_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr(making.shutil, "which", lambda name, path=None: name)
    monkeypatch.setattr(build, "find_spec", lambda name: None if name == "ziglang" else name)
    with pytest.raises(InputError, match=r"ziglang is not installed: pip install 'rotor-fmu\[bui"):
        making._tools()


def test_the_module_is_linked_also_where_no_jco_makes_a_component_of_it(monkeypatch, tmp_path):
    copies = "import shutil, sys; shutil.copyfile(sys.argv[1], sys.argv[4])"
    monkeypatch.setattr(making, "_tools", lambda: [sys.executable, "-c", copies])
    making.make(tmp_path / "module.wasm")
    module = (tmp_path / "module.wasm").read_bytes()
    assert module.startswith(b"\0asm")
    assert CO_SIMULATION.encode() in module


@NEEDED
def test_what_jco_refuses_is_one_sentence(monkeypatch, tmp_path):
    """A module that lacks what the interfaces ask for does not validate."""
    empty = b"\0asm\x01\0\0\0"
    monkeypatch.setattr(making, "objects", lambda *_: [])
    monkeypatch.setattr(making, "kernels", lambda: tmp_path)
    monkeypatch.setattr(making, "link_module", lambda _, target, *rest: target.write_bytes(empty))
    with pytest.raises(LibraryError, match=r"^jco cannot make a component for wasm32-wasip2: .+"):
        making.make(tmp_path / "core.wasm")
    assert not list(tmp_path.iterdir())


def test_it_is_made_once_for_a_version_of_the_sources(monkeypatch, tmp_path):
    made = []
    monkeypatch.setenv("ROTOR_FMU_CACHE", str(tmp_path))
    monkeypatch.setattr(making, "make", lambda target: (made.append(target), target.touch()))
    monkeypatch.setattr(making, "with_data", lambda content, table: table)
    assert making.component(b"one") == b"one"
    assert making.component(b"other") == b"other"
    assert len(made) == 1
    monkeypatch.setattr(making, "sources_digest", lambda: "of other sources")
    making.component(b"one")
    assert len(made) == 2
    monkeypatch.undo()
    assert all(folder.name.startswith("component-") for folder in (tmp_path / "native").iterdir())
