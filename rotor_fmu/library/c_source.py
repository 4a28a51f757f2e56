"""The kernels as C source, for an FMU that a compiler makes a library of: LLVM IR -> WebAssembly ->
`wasm2c`. Made once for each version of the kernels, in the user's cache.
"""

import shutil
import subprocess
from pathlib import Path

from ..errors import InputError
from ..files import scratch_folder
from ..model.kernels.digest import syntax_digest
from .build import (
    C_SOURCES,
    WASM,
    LibraryError,
    emitted_digest,
    fmi_headers,
    kernels,
    link_kernels,
    made_once,
    missing_tool,
    objects,
    sources_digest,
)

_C_SOURCE = C_SOURCES.parent / "c_source"
_TOOL, _VERSION = "wasm2c", "1.0.32"  # whose C `c_source` knows
# That of wabt, beside whose folder the tool lies: where Debian, conda and others put it.
_LICENCES = (
    "share/common-licenses/Apache-2.0",
    "share/licenses/wabt/LICENSE",
    "share/doc/wabt/LICENSE",
    "LICENSE",
)
_NAME = "wasm_kernels"
_LICENCE = "LICENSE-wabt.txt"
# What native libraries have instead, what pages have beside, and what Python has.
_LEFT_OUT = ("memory.c", "from_page.c", "analyses.c")
_OTHER_VERSION = {2: "fmi3.c", 3: "fmi2.c"}
# No system but Linux is sure to have it, and nothing of it is used.
_UNUSED = "#include <alloca.h>\n"
_RETURN = "return w2c__initialize(instance);"  # of a function without a result: no C17
# IEEE 754 is kept: no product is fused into a sum, and there are numbers that are none.
_BEFORE = """\
#if defined(__FAST_MATH__) || __FINITE_MATH_ONLY__ || defined(_M_FP_FAST)
#error "compile without -ffast-math, -Ofast and /fp:fast: the solver needs IEEE 754"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#endif
"""
# More than -O1 takes minutes and gains a tenth.
_BEFORE_KERNELS = """\
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O1")
#endif
"""


def source_files(fmi: int) -> dict[str, bytes]:
    """Return the files of the folder `sources` of an FMU of FMI 2.0 or 3.0 by name: the instance in
    C, the standard's headers, and the kernels.

    Raises `InputError` where a tool that makes C of the kernels is not there, and `LibraryError`
    where it fails.
    """
    version = syntax_digest([Path(__file__)], f"{emitted_digest()} {WASM}")
    folder = made_once("c", version, _write_kernels)
    result = {file.name: file.read_bytes() for file in folder.iterdir()}
    sources = f'#define SOURCES "{sources_digest()}"\n{_BEFORE}'.encode()
    headers = sorted(fmi_headers().glob(f"fmi{fmi}*.h"))
    for file in (*C_SOURCES.iterdir(), *_C_SOURCE.iterdir(), *headers):
        if file.name not in (*_LEFT_OUT, _OTHER_VERSION[fmi]):
            before = sources if file.suffix == ".c" else b""
            result[file.name] = before + file.read_bytes().replace(b"\r\n", b"\n")
    return result


def _write_kernels(folder: Path) -> None:
    tool = _tool()
    licence = _licence(Path(tool))
    emitted = kernels()
    with scratch_folder() as work:
        module = work / "kernels.wasm"
        link_kernels(objects(WASM, emitted, work), module)
        source = work / f"{_NAME}.c"
        command = [tool, str(module), "-o", str(source), "-n", "kernels"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise LibraryError(
                f"{_TOOL} cannot make C of the kernels: {done.stderr.strip()[-200:]}"
            )
        text = source.read_text(encoding="utf-8").replace(_UNUSED, "", 1)
        text = text.replace(_RETURN, _RETURN.replace("return ", ""), 1)
        (folder / source.name).write_text(f"{_BEFORE}{_BEFORE_KERNELS}{text}", encoding="utf-8")
        shutil.copyfile(work / f"{_NAME}.h", folder / f"{_NAME}.h")
        (folder / _LICENCE).write_text(licence, encoding="utf-8")


def _tool() -> str:
    """Return the path of `wasm2c`. Raises `InputError` where there is none, where it is one whose C
    is not known, and where what makes its input is missing."""
    found = shutil.which(_TOOL)
    advice = f"install wabt {_VERSION} (apt-get install wabt)"
    if found is None:
        raise InputError(f"--source: {_TOOL}, which makes C of the kernels, is not there: {advice}")
    done = subprocess.run([found, "--version"], capture_output=True, text=True, check=False)
    if done.stdout.strip() != _VERSION:
        raise InputError(f"--source: {_TOOL} {done.stdout.strip()}: must be {_VERSION}: {advice}")
    if missing := missing_tool():
        raise InputError(f"--source: {missing} is not installed: pip install 'rotor-fmu[build]'")
    return found


def _licence(tool: Path) -> str:
    """Return the text of wabt's licence, and its holders where the package names them."""
    prefix = tool.resolve().parents[1]
    for name in _LICENCES:
        if (prefix / name).is_file():
            holders = prefix / "share/doc/wabt/copyright"
            about = holders.read_text(encoding="utf-8") + "\n" if holders.is_file() else ""
            return about + (prefix / name).read_text(encoding="utf-8")
    raise InputError(
        f"--source: {prefix / _LICENCES[0]}: is not there; {_TOOL}'s licence has to go with the C "
        "that it makes"
    )
