"""The solver library for each platform: kernels -> LLVM IR -> objects -> linked with the FMU's
instance in C. Built once for each version of the sources.
"""

import contextlib
import errno
import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from importlib.resources import files
from importlib.util import find_spec
from itertools import chain
from pathlib import Path

from ..errors import RunFailed
from ..files import named, scratch_folder
from ..model.kernels.cache import private_folder
from ..model.kernels.digest import CARRIED, imported, made_here, record, syntax_digest
from ..model.kernels.library import file_name, find, here
from ..model.kernels.signatures import ANALYSES, RUN
from .platforms import PLATFORMS, WASM, Platform

_HERE = Path(__file__).parent
_FMI = _HERE.parent / "fmi"
C_SOURCES = _FMI / "c"
# The table that the instance reads.
_TABLE = _FMI / "machine_table.py"
_LEFT = 86400.0  # after which no build goes on in an unfinished folder [s]
_KEPT_VERSIONS = 8
# Python's alone: no FMU gives linear answers or computes periodic motions.
_OF_ANALYSES = tuple(f"rotor_{name}" for name in ANALYSES)
# What is emitted in one process: two, of about the same work.
_EMITTED_TOGETHER = (
    ("rotor_advance", "rotor_refresh_outputs", "rotor_resolve_settings", "rotor_settings_warning"),
    (
        *(f"rotor_{name}" for name in RUN if name not in ("advance", "refresh_outputs")),
        "rotor_no_rest",
        "rotor_growth",
        "rotor_unstable",
        "rotor_hidden",
        "rotor_outcome",
        *_OF_ANALYSES,
    ),
)
# Of the C library of the oldest Linux that an FMU runs on.
_GLIBC = (2, 17)
# C23 would take functions of a newer C library in the place of the old ones (strtol).
_FLAGS = ("-std=c17", "-O2", "-s", "-fvisibility=hidden", "-ffp-contract=off")
_SHARED = ("-fPIC", "-shared")
# A module without a `main`; it is sent, so that its C is made small, of which nothing takes time.
_MODULE = ("-Os", "-mexec-model=reactor", "-Wl,-z,stack-size=1048576")
# Of a page, which reserves memory for what it hands over.
_EXPORTS = ("-Wl,--export-dynamic", "-Wl,--export=malloc", "-Wl,--export=free")


class LibraryError(RunFailed):
    """A library that cannot be built; the message names what is missing or is the linker's."""


_FULL = os.strerror(errno.ENOSPC)
# What an extra brings: numba for the kernels, zig for platforms other than this machine's.
_TOOLS = {"kernels": ("numba", "platformdirs"), "build": ("numba", "platformdirs", "ziglang")}


def emitted_digest() -> str:
    """Return the digest, 16 characters, of the sources of the kernels' IR and the compilers."""
    from importlib.metadata import version  # which takes as long as a first step

    return syntax_digest(_emitted_sources(), f"{version('numba')} {version('llvmlite')}")


def _emitted_sources() -> list[Path]:
    return [*imported(_HERE / "entry_points.py", __package__), _HERE / "emit.py"]


@cache
def sources_digest() -> str:
    """Return the digest of the library's sources, sixteen characters."""
    digest = hashlib.sha256()
    for file in sorted(C_SOURCES.glob("*.[ch]")):
        digest.update(
            file.name.encode() + b"\0" + file.read_bytes().replace(b"\r\n", b"\n") + b"\0"
        )
    return syntax_digest([*_emitted_sources(), Path(__file__), _TABLE], digest.hexdigest())


def library(platform: Platform) -> Path:
    """Return the library for a platform, made if there is none; which takes a minute or two and is
    reported on standard error.

    It stands beside the kernels in a source tree, for all whatever their cache, and for what is
    built of the tree; else in the user's cache. Raises `LibraryError`.
    """
    result = find(platform.name, sources_digest())
    if result:
        record(result.parent)
        return result
    extra = missing_extra(platform)
    if extra:
        raise LibraryError(
            f"there is no library of the solver for {platform.name}, and none can be made: "
            f"{missing_tool(extra)} is not installed: pip install 'rotor-fmu[{extra}]'"
        )
    print(f"making the library for {platform.name}", file=sys.stderr, flush=True)
    folder = _folder()
    emitted = kernels()
    with scratch_folder() as work:
        made = work / f"library{platform.suffix}"
        link(platform, objects(platform, emitted, work), made)
        return _put(folder, platform, made.read_bytes())


def missing_extra(platform: Platform) -> str:
    """Return the extra that making the library of a platform takes and that is not installed, ""
    for none: nothing where there is such a library, for this machine no linker where it has a C
    compiler."""
    if find(platform.name, sources_digest()):
        return ""
    extra = "kernels" if platform.name == here() and _has_cc() else "build"
    return extra if missing_tool(extra) else ""


def missing_tool(extra: str = "build") -> str:
    """Return the first package of an extra that is not installed, "" for none."""
    return next((name for name in _TOOLS[extra] if find_spec(name) is None), "")


def missing_here() -> str:
    """Return `missing_extra` of this machine's platform; "" where there can be no library."""
    name = here()
    return missing_extra(PLATFORMS[name]) if name else ""


def _folder() -> Path:
    if (CARRIED.parents[1] / "pyproject.toml").is_file():
        CARRIED.mkdir(exist_ok=True)
        return CARRIED
    private_folder(made_here().parent)
    return private_folder(made_here())


def _put(folder: Path, platform: Platform, content: bytes) -> Path:
    """Write a library whole, and take away those of older sources where they lie beside them."""
    target = folder / file_name(platform.name, sources_digest(), platform.suffix, content)
    # called so that another process, which puts its own, does not take it for an old one
    unfinished = folder / f".{target.name}.{os.getpid()}.part"
    unfinished.write_bytes(content)
    unfinished.replace(target)
    record(folder)
    others = [file for file in folder.glob(f"{platform.name}.*") if file != target]
    others.sort(key=lambda file: file.stat().st_mtime, reverse=True)
    for old in others if folder == CARRIED else others[_KEPT_VERSIONS:]:
        with contextlib.suppress(OSError):
            old.unlink()
    return target


def kernels() -> Path:
    """Return the folder with the kernels' LLVM IR, which no platform is in yet."""
    return made_once("kernels", emitted_digest(), _emit)


def _emit(folder: Path) -> None:
    emit = [sys.executable, "-m", f"{__package__}.emit"]
    files = (str(folder / f"{names[0]}.ll") for names in _EMITTED_TOGETHER)
    commands = zip(files, _EMITTED_TOGETHER, strict=True)
    _run_all([[*emit, file, *names] for file, names in commands], "the kernels")


def made_once(kind: str, digest: str, write: Callable[[Path], None]) -> Path:
    """Return the folder of what is made once for each version of its sources, which `write` fills
    where there is none; of each kind few versions stay."""
    versions = made_here()
    folder = versions / f"{kind}-{digest}"
    if folder.is_dir():
        os.utime(folder)
    else:
        _forget_old(versions, f"{kind}-*")
        with unfinished_folder(folder) as work:
            write(work)
    return folder


@contextlib.contextmanager
def unfinished_folder(target: Path) -> Iterator[Path]:
    """A folder that is moved to its place when all in it is done; an `OSError` that names no file,
    as of a full disk, is raised with the name of the place. What killed builds left is
    taken away."""
    target.parent.mkdir(parents=True, exist_ok=True)
    for left in target.parent.glob("part-*"):
        with contextlib.suppress(OSError):  # as where another process takes it away
            if time.time() - left.stat().st_mtime > _LEFT:
                shutil.rmtree(left)
    with named(target):
        work = Path(tempfile.mkdtemp(prefix="part-", dir=target.parent))
        try:
            yield work
            try:
                work.rename(target)
            except OSError:  # another process was faster
                if not target.is_dir():
                    raise
        finally:
            shutil.rmtree(work, ignore_errors=True)


def _forget_old(versions: Path, pattern: str) -> None:
    """Take away the oldest of the folders of a kind, so that few are left with the next."""
    if not versions.is_dir():
        return
    finished = list(versions.glob(pattern))
    by_age = sorted(finished, key=lambda p: p.stat().st_mtime, reverse=True)
    for old in by_age[_KEPT_VERSIONS - 1 :]:
        shutil.rmtree(old, ignore_errors=True)


def objects(platform: Platform, folder: Path, work: Path) -> list[Path]:
    """Return the kernels for a platform as object files."""
    sources = sorted(folder.glob("*.ll"))
    targets = [work / f"{source.stem}.o" for source in sources]
    compiler = [sys.executable, "-m", f"{__package__}.objects"]
    compiler += [platform.triple, platform.processor, platform.features]
    commands = [[*compiler, str(a), str(b)] for a, b in zip(sources, targets, strict=True)]
    _run_all(commands, f"the kernels for {platform.name}")
    return targets


def link(platform: Platform, parts: list[Path], target: Path) -> None:
    """Link object files with the instance in C: for this machine by its C compiler, if the library
    then runs on every Linux that it is for, else by zig. Raises `LibraryError`."""
    of_cc = ""
    if platform.name == here() and _has_cc():
        done = _run(_link_command(["cc", "-static-libgcc"], platform, parts, target))
        if done.returncode == 0 and runs_on_old_linux(target.read_bytes()):
            return
        if _FULL in done.stderr:
            _check(done, f"the library for {platform.name}")
        of_cc = f" ({_reason(done)})" if done.returncode else ""
    if find_spec("ziglang") is None:
        raise LibraryError(
            f"the library for {platform.name} could not be linked by cc for a Linux with GLIBC "
            f"{'.'.join(map(str, _GLIBC))}{of_cc}, and ziglang is not installed: "
            "pip install 'rotor-fmu[build]'"
        )
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", platform.zig]
    _run_all([_link_command(zig, platform, parts, target)], f"the library for {platform.name}")


def link_kernels(parts: list[Path], target: Path) -> None:
    """Link the kernels of an FMU alone, as object files for WebAssembly, into a module that asks
    its surroundings for nothing. Raises `LibraryError`."""
    names = chain.from_iterable(_EMITTED_TOGETHER)
    exports = [f"-Wl,--export={name}_kernel" for name in names if name not in _OF_ANALYSES]
    link_module(parts, target, exports, "the kernels as a module")


def link_module(parts: list[Path], target: Path, options: Sequence[str], what: str) -> None:
    """Link C and object files for WebAssembly into a module, which `what` names. Raises
    `LibraryError`."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", WASM.zig, *_FLAGS, *_MODULE]
    _run_all([[*command, *options, "-o", str(target), *map(str, parts)]], what)


def _has_cc() -> bool:
    """Return whether this is a Linux with a C compiler; a Mac's `cc` asks to install one."""
    return sys.platform == "linux" and shutil.which("cc") is not None


def fmi_headers() -> Path:
    """Return the folder of the standard's headers of FMI 2.0 and 3.0, which FMPy carries."""
    return Path(str(files("fmpy"))) / "c-code"


def runs_on_old_linux(library: bytes) -> bool:
    """Return whether a library takes the GNU C library alone, and nothing newer than 2.17."""
    versions = re.findall(rb"\0GLIBC_(\d+)\.(\d+)[.\d]*(?=\0)", library)
    return bool(versions) and max((int(a), int(b)) for a, b in versions) <= _GLIBC


def _link_command(
    compiler: list[str], platform: Platform, parts: list[Path], target: Path
) -> list[str]:
    command = [*compiler, *_FLAGS, *((*_MODULE, *_EXPORTS) if platform is WASM else _SHARED)]
    command += [f"-I{fmi_headers()}", f'-DSOURCES="{sources_digest()}"', "-o", str(target)]
    if platform.suffix == ".dylib":
        command.append(f"-Wl,-install_name,@rpath/{target.name}")
    command += [str(file) for file in (*sorted(C_SOURCES.glob("*.c")), *parts)]
    if platform.suffix == ".so":
        # of libm what is exact on every system: sqrt, ceil; its own functions are called directly,
        # whatever else of their names a process has loaded
        command += ["-lm", "-Wl,-Bsymbolic"]
    return command


def _run_all(commands: list[list[str]], what: str) -> None:
    """Run commands at the same time. Raises as `_check` does if one fails."""
    with ThreadPoolExecutor(len(commands)) as pool:
        for done in pool.map(_run, commands):
            _check(done, what)


def _check(done: subprocess.CompletedProcess[str], what: str) -> None:
    """Raise `LibraryError` for a program that failed, `OSError` where it says why a file cannot be
    written: Python by a number, but not which file, others that the disk is full."""
    if not done.returncode:
        return
    reason = _reason(done)
    if of_system := re.search(r"\[Errno (\d+)\] (.*)", reason):
        raise OSError(int(of_system[1]), f"{what} could not be made: {of_system[2]}")
    if _FULL in done.stderr:
        raise OSError(errno.ENOSPC, f"{what} could not be made: {_FULL}")
    raise LibraryError(f"{what} could not be made: {reason}")


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    """Return what a program's standard error gives as the reason of its failure: the last error, or
    numba's, with the place in the kernels. numba begins with where it was in its own work."""
    said = done.stderr
    _, of_numba, text = said.rpartition("numba.core.errors.")
    lines = [line.strip() for line in text.splitlines()[1:] if "in nopython mode" not in line]
    place = re.search(r'^File "(.+)", line (\d+)', text, re.M)
    if of_numba and place and any(lines):
        return f"{place[1]}:{place[2]}: {next(filter(None, lines))}"
    lines = [line.strip() for line in said.splitlines() if "rror" in line]
    if done.returncode < 0 and not lines:  # zig says nothing of a full disk
        name = signal.Signals(-done.returncode).name
        return f"ended by {name} without a reason, as where the disk or the memory is full"
    return lines[-1] if lines else "no reason given"


def _run(command: list[str]) -> subprocess.CompletedProcess[str]:
    english = {**os.environ, "LC_ALL": "C"}  # of which errors are read
    return subprocess.run(command, capture_output=True, text=True, check=False, env=english)
