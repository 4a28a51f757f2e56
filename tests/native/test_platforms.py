"""The library for every platform: what the kernels ask of a system, and what the files hold."""

import re
import struct
import zipfile

import fmpy
import pytest

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.library.build import kernels, library
from rotor_fmu.library.platforms import PLATFORMS

from .emulated import QEMU, bits_of, need

# Of a system's library, what is exact everywhere; what LLVM makes of an intrinsic is exact too.
EXACT = {"sqrt", "ceil", "memset", "memcpy"}
INTRINSICS = {
    "ceil",
    "copysign",
    "fabs",
    "sqrt",
    "floor",
    "rint",
    "trunc",
    "is",
    "memset",
    "memcpy",
}
INTEGERS = {"smin", "smax", "umin", "umax", "uadd", "sadd", "usub", "umul", "smul", "abs", "ctpop"}
ENDINGS = {"assume", "lifetime", "experimental", "vector"}
EXPORTS = (
    "fmi2Instantiate",
    "fmi2DoStep",
    "fmi2GetReal",
    "fmi3InstantiateCoSimulation",
    "fmi3DoStep",
)


def emitted():
    result = list(kernels().glob("*.ll"))
    assert result
    return result


def test_the_kernels_ask_a_system_for_nothing_that_it_may_round_in_its_own_way(fmu):
    """A part that calls another function is named here."""
    for file in emitted():
        for name in re.findall(r"(?m)^declare [^@]*@([^(]+)\(", file.read_text()):
            if name.startswith("llvm."):
                assert name.split(".")[1] in INTRINSICS | INTEGERS | ENDINGS, (file.stem, name)
            else:
                assert name in EXACT, (file.stem, name)


def test_the_kernels_name_no_file_of_the_machine_that_made_them(fmu):
    """Else libraries of equal sources would differ with the folder that numba lies in."""
    for file in emitted():
        assert not re.search(r"\.py\b", file.read_text()), file.stem


def test_the_kernels_contract_no_product_and_sum(fmu):
    for file in emitted():
        text = file.read_text()
        assert "llvm.fma" not in text
        assert " fast " not in text
        assert " contract " not in text


@pytest.fixture(scope="module")
def libraries(make):
    """Of all platforms; the first one for a system takes minutes."""
    return {name: library(platform) for name, platform in PLATFORMS.items()}


def load_commands(data):
    """Commands of a Mach-O file: (kind, what is behind its head)."""
    magic, _, _, _, count, _, _, _ = struct.unpack_from("<8I", data)
    assert magic == 0xFEEDFACF
    at = 32
    for _ in range(count):
        kind, size = struct.unpack_from("<2I", data, at)
        yield kind, data[at + 8 : at + size]
        at += size


@pytest.mark.slow
@pytest.mark.parametrize("name", ["darwin64", "aarch64-darwin"])
def test_a_library_for_macos_has_its_exports_its_name_and_on_arm_a_signature(libraries, name):
    data = libraries[name].read_bytes()
    commands = dict(load_commands(data))
    symbols, count, strings, _ = struct.unpack_from("<4I", commands[2])
    exported = set()
    for i in range(count):
        place, kind = struct.unpack_from("<IB", data, symbols + 16 * i)
        if kind == 0x0F:  # defined here, seen from outside
            end = data.index(b"\0", strings + place)
            exported.add(data[strings + place : end].decode().removeprefix("_"))
    assert set(EXPORTS) <= exported
    linkers = {"__dso_handle", "_mh_dylib_header"}
    ours = ("fmi2", "fmi3", "rotor_")
    assert all(symbol.startswith(ours) for symbol in exported - linkers), exported
    assert b"@rpath/library.dylib" in commands[0x0D]
    assert (0x1D in commands) or name == "darwin64"


@pytest.mark.slow
def test_a_library_for_windows_has_its_exports(libraries):
    names = libraries["win64"].read_bytes()
    assert names[:2] == b"MZ"
    assert all(f"{export}\0".encode() in names for export in EXPORTS)


@pytest.mark.slow
def test_all_five_platforms_fit_into_three_megabytes_and_equal_sources_give_equal_bytes(
    libraries, tmp_path, monkeypatch
):
    monkeypatch.setattr("rotor_fmu.fmi.packing.archive._LEVEL", 6)  # as users build it
    one, other = (build_native(tmp_path / name, machine_of()) for name in ("one", "other"))
    assert one.stat().st_size < 3e6
    assert one.read_bytes() == other.read_bytes()
    with zipfile.ZipFile(one) as archive:
        folders = {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries")}
        universal = archive.read("binaries/darwin64/RotorBearingNative.dylib")
    assert folders == set(PLATFORMS) - {"aarch64-darwin"}  # which is in the file of darwin64
    assert struct.unpack_from(">2I", universal) == (0xCAFEBABE, 2)
    for i in range(2):
        _, _, at, size, _ = struct.unpack_from(">5I", universal, 8 + 20 * i)
        assert at % 0x4000 == 0
        assert list(load_commands(universal[at : at + size]))


EMULATORS = {"win64": ["wine"], "aarch64-linux": QEMU}


@pytest.mark.slow
@pytest.mark.parametrize("name", EMULATORS)
def test_another_system_or_processor_computes_the_same_bits(libraries, tmp_path, name):
    """The outputs of a run, where every contact angle is among them, as the processor has them."""
    need(EMULATORS[name])
    fmu = build_native(tmp_path, machine_of(), platforms=["linux64", name])
    folder = fmpy.extract(str(fmu), str(tmp_path / "fmu"))
    here, there = (
        bits_of(
            f"{folder}/binaries/{of}/RotorBearingNative{PLATFORMS[of].suffix}", folder, of, emulator
        )
        for of, emulator in (("linux64", []), (name, EMULATORS[name]))
    )
    assert len(here.splitlines()) == 150
    assert here == there
