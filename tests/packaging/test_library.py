"""How the solver library is emitted and linked."""

import errno
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from rotor_fmu.model.kernels.library import find, here

from rotor_fmu.library import build, c_source, component
from rotor_fmu.library.build import LibraryError, link, missing_extra, runs_on_old_linux
from rotor_fmu.library.emit import check_size
from rotor_fmu.library.platforms import PLATFORMS, WASM

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="cc links on Linux alone")
OLD, NEW = b"\0GLIBC_2.2.5\0GLIBC_2.14\0", b"\0GLIBC_2.2.5\0GLIBC_2.38\0"


@pytest.mark.parametrize("size", [3_000, 100_000_000])
def test_ir_that_is_a_stub_or_was_never_optimised_is_refused(size):
    with pytest.raises(RuntimeError, match=f"rotor_advance: {size} bytes of IR"):
        check_size("rotor_advance", size)


@pytest.mark.parametrize(
    ("content", "is_old"),
    [
        (OLD, True),
        (NEW, False),
        (b"\0GLIBC_2.17\0", True),
        (b"\0GLIBC_2.17.1\0", True),
        (b"", False),
    ],
)
def test_a_library_runs_where_its_versions_of_the_c_library_are(content, is_old):
    assert runs_on_old_linux(content) == is_old


@ON_LINUX
def test_the_library_of_this_machine_runs_on_every_linux_that_it_is_for():
    file = find(here())
    assert file is not None, "there is no library (rotor-fmu library --platform here)"
    assert runs_on_old_linux(file.read_bytes())


class Compilers:
    """cc and zig, each of which leaves a library of a version of the C library, or fails."""

    def __init__(self, monkeypatch, cc, has_zig=True):
        self.called = []
        self._cc = cc
        monkeypatch.setattr(build, "_run", self.run)
        monkeypatch.setattr(build, "_has_cc", lambda: cc is not None)
        monkeypatch.setattr(build, "find_spec", lambda name: has_zig or name != "ziglang" or None)

    def run(self, command):
        with_zig = "ziglang" in command
        self.called.append("zig" if with_zig else command[0])
        content = OLD if with_zig else self._cc
        target = command[command.index("-o") + 1]
        if content:
            Path(target).write_bytes(content)
        status = 0 if content else 1
        return subprocess.CompletedProcess(command, status, "", "error: no such thing")


@ON_LINUX
@pytest.mark.parametrize(
    ("cc", "called"), [(OLD, ["cc"]), (NEW, ["cc", "zig"]), (b"", ["cc", "zig"]), (None, ["zig"])]
)
def test_cc_links_for_this_machine_and_zig_where_it_cannot(monkeypatch, tmp_path, cc, called):
    compilers = Compilers(monkeypatch, cc)
    link(PLATFORMS[here()], [], tmp_path / "library")
    assert compilers.called == called
    assert runs_on_old_linux((tmp_path / "library").read_bytes())
    compilers.called.clear()
    link(PLATFORMS["win64"], [], tmp_path / "library")
    assert compilers.called == ["zig"]


@ON_LINUX
@pytest.mark.parametrize(("cc", "reason"), [(NEW, ""), (b"", r" \(error: no such thing\)")])
def test_without_zig_a_library_that_cc_cannot_link_says_what_to_install(
    monkeypatch, tmp_path, cc, reason
):
    Compilers(monkeypatch, cc, has_zig=False)
    said = rf"GLIBC 2\.17{reason}, and ziglang .*'rotor-fmu\[build\]'"
    with pytest.raises(LibraryError, match=said):
        link(PLATFORMS[here()], [], tmp_path / "library")


@ON_LINUX
def test_what_is_to_be_installed_is_what_a_platform_takes(monkeypatch):
    mine = PLATFORMS[here()]
    monkeypatch.setattr(build, "find", lambda *_: "a library")
    assert missing_extra(mine) == ""
    monkeypatch.setattr(build, "find", lambda *_: None)
    monkeypatch.setattr(build, "find_spec", lambda name: None)
    monkeypatch.setattr(build, "_has_cc", lambda: True)
    assert missing_extra(mine) == "kernels"
    assert missing_extra(PLATFORMS["win64"]) == "build"
    monkeypatch.setattr(build, "_has_cc", lambda: False)
    assert missing_extra(mine) == "build"


def test_the_package_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr(build, "find", lambda *_: None)
    monkeypatch.setattr(build, "find_spec", lambda name: name != "numba" or None)
    with pytest.raises(LibraryError, match=r"numba is not installed: pip install 'rotor-fmu\[bui"):
        build.library(PLATFORMS["win64"])


@ON_LINUX
@pytest.mark.parametrize("has_zig", [False, True])
def test_a_disk_that_is_full_for_cc_is_no_reason_for_another_linker(monkeypatch, tmp_path, has_zig):
    stderr = "ld: final link failed: No space left on device\ncollect2: error: ld returned 1\n"
    Compilers(monkeypatch, OLD, has_zig)
    done = subprocess.CompletedProcess([], 1, "", stderr)
    monkeypatch.setattr(build, "_run", lambda command: done)
    with pytest.raises(OSError, match=r"\S+ could not be made: No space left on device"):
        link(PLATFORMS[here()], [], tmp_path / "library")


@pytest.mark.skipif(sys.platform == "win32", reason="signals end no process there")
def test_a_linker_that_ended_without_a_word_says_by_which_signal(monkeypatch, tmp_path):
    done = subprocess.CompletedProcess([], -6, "", "")
    monkeypatch.setattr(build, "_run", lambda command: done)
    with pytest.raises(LibraryError, match="win64 could not be made: ended by SIGABRT without a"):
        link(PLATFORMS["win64"], [], tmp_path / "library")


@pytest.mark.parametrize(
    "make",
    [lambda target: build.library(WASM), component.make, c_source._write_kernels],
    ids=["library", "component", "source"],
)
def test_a_full_temporary_folder_is_named(monkeypatch, tmp_path, make):
    """By the process that compiles, Python says of no write in which file it was."""
    emitted, temporary = tmp_path / "kernels", tmp_path / "temporary"
    for folder in (emitted, temporary):
        folder.mkdir()
    (emitted / "rotor_advance.ll").touch()
    stderr = "Traceback\nOSError: [Errno 28] No space left on device\n"
    done = subprocess.CompletedProcess([], 1, "", stderr)
    monkeypatch.setattr(build, "_run", lambda command: done)
    monkeypatch.setattr(build, "find", lambda *given: None)
    for module in (build, component, c_source):
        monkeypatch.setattr(module, "kernels", lambda: emitted)
    monkeypatch.setattr(component, "_tools", list)
    monkeypatch.setattr(c_source, "_tool", lambda: sys.executable)
    monkeypatch.setattr(c_source, "_licence", lambda tool: "")
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    with pytest.raises(OSError, match="could not be made: No space left on device") as full:
        make(tmp_path / "made")
    assert Path(full.value.filename).parent == temporary
    assert not list(temporary.iterdir())


def test_a_full_cache_is_named_and_nothing_is_left_in_it(tmp_path):
    folder = tmp_path / "kernels-1"

    def fill():
        with build.unfinished_folder(folder) as work:
            (work / "begun").touch()
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(OSError, match="No space") as full:
        fill()
    assert full.value.filename == str(folder)
    assert not list(tmp_path.iterdir())


def test_what_a_killed_build_left_in_the_cache_is_taken_away_a_day_later(tmp_path):
    left, begun = tmp_path / "part-old", tmp_path / "part-new"
    for folder in (left, begun):
        folder.mkdir()
    os.utime(left, (0, 0))
    with build.unfinished_folder(tmp_path / "kernels-1"):
        assert begun.is_dir()
    assert {folder.name for folder in tmp_path.iterdir()} == {"part-new", "kernels-1"}


def test_two_processes_may_put_the_same_library_at_once(tmp_path, monkeypatch):
    write = Path.write_bytes

    def the_other_is_quicker(path, content):
        write(path, content)
        monkeypatch.setattr(Path, "write_bytes", write)
        with monkeypatch.context() as other:
            other.setattr("os.getpid", lambda: 1)
            build._put(tmp_path, WASM, content)

    monkeypatch.setattr(build, "CARRIED", tmp_path)
    monkeypatch.setattr(Path, "write_bytes", the_other_is_quicker)
    assert build._put(tmp_path, WASM, b"a library").read_bytes() == b"a library"


REFUSED = """  File "numba/core/dispatcher.py", line 363, in error_rewrite
    raise e.with_traceback(None)
numba.core.errors.TypingError: Failed in nopython mode pipeline (step: nopython frontend)
Failed in nopython mode pipeline (step: nopython frontend)
Unknown attribute 'slip' of type Places(int64 x 4)

File "model/time_loop/observe.py", line 205:
def observe(structure, motion, memory, work, out, has_energies):
    <source elided>

During: resolving callee type: type(CPUDispatcher(<function observe at 0x7f10636b7e20>))
During: typing of call at model/time_loop/entry_points.py (92)

File "model/time_loop/entry_points.py", line 92:
def start(block, speed, drive, rate):
"""


def test_a_kernel_that_numba_refuses_is_named_with_the_reason(monkeypatch, tmp_path):
    failed = subprocess.CompletedProcess([], 1, "", REFUSED)
    monkeypatch.setattr(build, "_run", lambda command: failed)
    monkeypatch.setattr(build, "made_here", lambda: tmp_path)
    expected = "kernels could not be made: model/time_loop/observe.py:205: Unknown attribute 'slip'"
    with pytest.raises(LibraryError, match=expected):
        build.kernels()
