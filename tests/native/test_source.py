"""The FMU of C source: compiled by cc, by FMPy and for ARM, it gives the native library's bits."""

import os
import shutil
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu

from rotor_fmu.errors import InputError
from rotor_fmu.fmi.machine_table import FILE
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_source
from rotor_fmu.library import build, c_source
from rotor_fmu.library.platforms import PLATFORMS

from ..processes import ROTOR_FMU, run_anew
from .emulated import QEMU, bits_of, need
from .wasm import Native, rows_of

CC, TOOL = shutil.which("cc"), shutil.which("wasm2c")
NEEDED = pytest.mark.skipif(not (CC and TOOL), reason="needs cc and wasm2c")
# what cc is given beside the sources, as the page says it
COMPILE = ("-O1", "-shared", "-fPIC")


def unpacked(folder, fmi):
    """The folder of an FMU of the rig, of FMI 2.0 or 3.0."""
    with zipfile.ZipFile(build_source(folder, machine_of(), fmi=fmi)) as archive:
        archive.extractall(folder / "fmu")
    return folder / "fmu"


def compiled(folder, compiler=("cc",)):
    """The library that a C compiler makes of an unpacked FMU."""
    made = folder / "rotor.so"
    sources = sorted(folder.glob("sources/*.c"))
    subprocess.run([*compiler, *COMPILE, "-o", made, *sources, "-lm"], check=True)
    return made


@NEEDED
@pytest.mark.parametrize(
    ("fmi", "description", "listed"),
    [
        (2, "modelDescription.xml", ".//CoSimulation/SourceFiles/File"),
        (3, "sources/buildDescription.xml", "./BuildConfiguration/SourceFileSet/SourceFile"),
    ],
)
def test_every_file_to_compile_is_named_and_there(tmp_path, fmi, description, listed):
    folder = unpacked(tmp_path, fmi)
    tree = ElementTree.parse(folder / description)
    named = {element.get("name") for element in tree.iterfind(listed)}
    assert named == {file.name for file in folder.glob("sources/*.c")}
    assert {"instance.c", "wasm_kernels.c", "kernels_in_c.c"} <= named
    licence = (folder / "sources" / "LICENSE-wabt.txt").read_text()
    assert "Apache License" in licence
    assert "TERMS AND CONDITIONS" in licence
    assert not (folder / "binaries").exists()
    page = " ".join((folder / "documentation" / "index.html").read_text().split())
    assert "holds C17 source code and no library" in page
    assert "its libraries" not in page
    assert validate_fmu(str(tmp_path / "RotorBearingSource.fmu")) == []


@NEEDED
@pytest.mark.parametrize("fmi", [2, 3])
def test_the_code_is_the_c17_that_it_is_said_to_be(tmp_path, fmi):
    for file in unpacked(tmp_path, fmi).glob("sources/*.c"):
        command = ["cc", "-std=c17", "-pedantic-errors", "-fsyntax-only", file]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


@NEEDED
def test_functions_carry_the_prefix_that_a_program_of_several_fmus_asks_for(tmp_path):
    source = unpacked(tmp_path, 3) / "sources" / "fmi3.c"
    prefix = "-DFMI3_FUNCTION_PREFIX=Machine_"
    subprocess.run(["cc", "-std=c17", "-c", prefix, "-o", tmp_path / "fmi.o", source], check=True)
    listed = subprocess.run(["nm", tmp_path / "fmi.o"], capture_output=True, text=True, check=True)
    names = {line.split()[-1] for line in listed.stdout.splitlines() if " T " in line}
    assert "Machine_fmi3DoStep" in names
    assert all(name.startswith("Machine_fmi3") for name in names)


@NEEDED
@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_a_compiler_that_is_told_not_to_keep_ieee_754_is_refused(tmp_path, flag):
    """No number would be NaN, which is how a parameter that is not set is told."""
    for file in unpacked(tmp_path, 2).glob("sources/[!w]*.c"):
        command = ["cc", flag, "-fsyntax-only", file]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert "compile without -ffast-math" in done.stderr


@NEEDED
@pytest.mark.slow
def test_a_bare_cc_makes_a_library_with_the_same_bits(tmp_path):
    folder = unpacked(tmp_path, 2)
    table = (folder / "resources" / FILE).read_bytes()
    made = compiled(folder)
    plan = {
        "values": [{"reference": 0, "kind": "Real", "value": 400.0}],
        "drive": 0,
        "legs": [{"steps": 500, "step": 1e-3, "from": 400.0, "rate": -10.0}],
        "record": [],
    }
    described = fmpy.read_model_description(str(folder))
    plan["record"] = [v.valueReference for v in described.modelVariables if v.causality == "output"]
    rows = rows_of(Native(table, made), plan)
    assert len(rows) == 501
    assert rows.tobytes() == rows_of(Native(table), plan).tobytes()
    # what a process may have under the same name (libc has `warn`) is not what the library calls
    listed = subprocess.run(["nm", "-D", made], capture_output=True, text=True, check=True).stdout
    names = {line.split()[-1] for line in listed.splitlines() if " T " in line}
    assert {"fmi2DoStep", "rotor_instantiate"} <= names
    assert "fmi3DoStep" not in names
    assert all(name.startswith(("fmi", "rotor_", "Z_kernels")) for name in names)


@NEEDED
@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmpy_compiles_it_and_runs_it_as_the_native_one(make, tmp_path, fmi):
    fmu = build_source(tmp_path, machine_of(), fmi=fmi)
    folder = fmpy.extract(str(fmu), unzipdir=str(tmp_path / "fmu"))
    build_platform_binary(folder)
    options = {"stop_time": 0.2, "output_interval": 1e-3, "start_values": {"speed": 400.0}}
    result = fmpy.simulate_fmu(folder, **options)
    other = fmpy.simulate_fmu(str(make(fmi=fmi)), **options)
    assert len(result) == 201
    assert np.ptp(result["disc[3].x"]) > 0
    assert np.array_equal(result, other)


@NEEDED
@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_compiled_for_arm_it_computes_the_same_bits(make, tmp_path, compiler):
    need(QEMU)
    if compiler == "gcc":
        command = ["aarch64-linux-gnu-gcc"]
        if shutil.which(command[0]) is None:
            pytest.skip(f"{command[0]} is not installed")
    else:
        command = [sys.executable, "-m", "ziglang", "cc", "-target"]
        command.append(PLATFORMS["aarch64-linux"].zig)
    folder = unpacked(tmp_path, 2)
    native = fmpy.extract(str(make()), unzipdir=str(tmp_path / "native"))
    here = bits_of(f"{native}/binaries/linux64/RotorBearingNative.so", native, "linux64", [])
    assert len(here.splitlines()) == 150
    assert here == bits_of(compiled(folder, command), folder, "aarch64-linux", QEMU)


def test_the_c_is_made_once_for_a_version_of_the_kernels(monkeypatch, tmp_path):
    made = []

    def write(folder):
        made.append(folder)
        (folder / "wasm_kernels.c").write_text(f"/* {len(made)} */")

    monkeypatch.setenv("ROTOR_FMU_CACHE", str(tmp_path))
    monkeypatch.setattr(c_source, "_write_kernels", write)
    first = c_source.source_files(2)
    assert c_source.source_files(2) == first
    assert len(made) == 1
    monkeypatch.setattr(c_source, "emitted_digest", lambda: "of other kernels")
    assert c_source.source_files(2)["wasm_kernels.c"] == b"/* 2 */"
    monkeypatch.undo()
    folders = sorted(folder.name for folder in (tmp_path / "native").iterdir())
    assert len(folders) == 2
    assert all(name.startswith("c-") for name in folders)


def tool(folder, script):
    """A `wasm2c` of these lines, where alone it and the shell's tools are found."""
    file = folder / "wasm2c"
    file.write_text(f"#!/bin/sh\n{script}\n")
    file.chmod(0o755)
    return os.pathsep.join((str(folder), "/bin"))


@pytest.mark.parametrize(
    ("script", "said"),
    [
        (None, "wasm2c, which makes C of the kernels, is not there: install wabt 1.0.32"),
        ("echo 1.0.36", "wasm2c 1.0.36: must be 1.0.32"),
        ("echo 1.0.32", "share/common-licenses/Apache-2.0: is not there"),
    ],
)
def test_a_tool_that_is_missing_or_another_is_one_sentence(tmp_path, script, said):
    folder, out = tmp_path / "bin", tmp_path / "out"
    folder.mkdir()
    path = tool(folder, script) if script else str(folder)
    environment = {"PATH": path, "ROTOR_FMU_CACHE": str(tmp_path / "cache")}
    done = run_anew(ROTOR_FMU, "build", "--source", "--out", out, **environment)
    assert done.returncode == 2
    assert done.stderr.startswith("rotor-fmu: --source: ")
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not out.exists()


def test_zig_that_is_missing_is_named(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", tool(tmp_path, "echo 1.0.32"))
    monkeypatch.setattr(build, "find_spec", lambda name: None if name == "ziglang" else name)
    with pytest.raises(
        InputError, match=r"ziglang is not installed: pip install 'rotor-fmu\[build"
    ):
        c_source._tool()


@pytest.mark.parametrize("beside", [["--native"], ["--platform", "here"]])
def test_a_source_fmu_has_no_libraries(beside, tmp_path):
    done = run_anew(ROTOR_FMU, "build", "--source", *beside, "--out", tmp_path)
    assert done.returncode == 2
    assert "leave out --native and --platform" in done.stderr
    assert not list(tmp_path.iterdir())
