"""What is wrong with the folder of compiled code costs time and never a result.

A small kernel is compiled in processes of their own, so that each begins with nothing in memory.
"""

import os
import pickle
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from rotor_fmu.model.kernels.code_cache import WAITING
from rotor_fmu.model.kernels.process_lock import ProcessLock
from rotor_fmu.model.kernels.sealed_folder import SealedFolder, make_private

import rotor_fmu

from .forked import Forked

KERNEL = """
import sys
from rotor_fmu.model.kernels import code_cache, kept_overloads
from rotor_fmu.model.kernels.compiled import compiled, has_to_compile

FACTOR = 1.0

@compiled
def square(x):
    return x * x

@compiled
def cube(x):
    return FACTOR * x * square(x)

def show():
    has_to = has_to_compile(cube)
    print(cube(2.0), "compiled" if cube.stats.cache_misses else "kept", has_to)
"""


class Kernel:
    """A small kernel in a file, its cache, and processes that call it."""

    def __init__(self, folder):
        self.file = folder / "kernel.py"
        self.file.write_text(KERNEL)
        self.cache = folder / "cache"

    def start(self, script="show()", **environment):
        source = str(Path(rotor_fmu.__file__).parents[1])
        inherited = {k: v for k, v in os.environ.items() if k != "XDG_CACHE_HOME"}
        path = os.pathsep.join([str(self.file.parent), source])
        variables = {"ROTOR_FMU_CACHE": str(self.cache), "PYTHONPATH": path, **environment}
        variables = {k: v for k, v in (inherited | variables).items() if v is not None}
        return Forked(f"from kernel import *\n{script}", variables)

    def run(self, script="show()", **environment):
        """Output lines and messages of a process that ends well."""
        process = self.start(script, **environment)
        out, said = process.communicate(timeout=120)
        assert process.returncode == 0, f"exit {process.returncode}\n{said}"
        return out.splitlines(), said.splitlines()

    @property
    def folder(self):
        (folder,) = (self.cache / "code").iterdir()
        return folder

    @property
    def file_of_cube(self):
        (file,) = self.folder.glob("kernel.cube-*")
        return file


COMPILED, KEPT = ["8.0 compiled True"], ["8.0 kept False"]


@pytest.fixture
def kernel(tmp_path):
    return Kernel(tmp_path)


@pytest.fixture(scope="module")
def warm_cache(tmp_path_factory):
    first = Kernel(tmp_path_factory.mktemp("warm"))
    assert first.run() == (COMPILED, [])
    return first.cache


@pytest.fixture
def warm(kernel, warm_cache):
    """A kernel whose code is kept."""
    shutil.copytree(warm_cache, kernel.cache)
    return kernel


def test_what_one_process_compiles_the_next_finds(warm):
    assert warm.run() == (KEPT, [])


def emptied(file):
    file.write_bytes(b"")


def truncated(file):
    file.write_bytes(file.read_bytes()[:-1])


def changed(file):
    """Four bytes in the middle, which as machine code would end the process."""
    content = bytearray(file.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 4] = bytes(255 - b for b in content[middle : middle + 4])
    file.write_bytes(content)


def exchanged(file):
    """Another file's sound content."""
    file.write_bytes(file.with_name("other").read_bytes())


def opened(file):
    file.chmod(0o666)


def linked(file):
    file.symlink_to(file.rename(file.with_name("elsewhere")))


def a_pipe(file):
    file.unlink()
    os.mkfifo(file)


@pytest.mark.parametrize("harm", [emptied, truncated, changed, exchanged, opened, linked, a_pipe])
def test_a_file_is_read_as_it_was_written_or_not_at_all(tmp_path, harm):
    folder = SealedFolder(tmp_path)
    folder.write("name", bytes(1000))
    folder.write("other", bytes(1000))
    assert folder.read("name") == bytes(1000)
    harm(tmp_path / "name")
    assert folder.read("name") is None
    folder.write("name", b"again")
    assert folder.read("name") == b"again"


def test_damaged_code_is_compiled_again_and_mended(warm):
    changed(warm.file_of_cube)
    truncated(next(warm.folder.glob("kernel.square-*")))
    assert warm.run() == (COMPILED, [])
    assert warm.run() == (KEPT, [])


def test_senseless_code_is_compiled_again_and_mended(warm):
    SealedFolder(warm.folder).write(warm.file_of_cube.name, pickle.dumps((1, 2, 3)))
    out, said = warm.run()
    assert out == ["8.0 compiled False"]
    assert len(said) == 1
    assert said[0].startswith("kept code cannot be used, so it is made again: ")
    assert warm.run() == (KEPT, [])


@pytest.mark.parametrize("gone", ["_reduce", "_rebuild"])
def test_a_numba_with_other_insides_costs_the_kept_code_alone(warm, gone):
    if gone == "_reduce":
        warm.file_of_cube.unlink()
    out, said = warm.run(f"import numba\ndel numba.core.compiler.CompileResult.{gone}\nshow()")
    assert out[0].startswith("8.0 compiled")
    assert len(said) == 1
    assert gone in said[0]


def test_changed_sources_are_compiled_again(warm, tmp_path):
    warm.file.write_text(KERNEL.replace("FACTOR = 1.0", "FACTOR = 3.0"))
    assert warm.run()[0] == ["24.0 compiled True"]
    registered = tmp_path / "part.py"
    registered.write_text("stiffness = 1.0")
    with_part = f"from pathlib import Path\ncode_cache.include(Path({str(registered)!r}))\nshow()"
    assert warm.run(with_part)[0] == ["24.0 compiled True"]
    assert warm.run(with_part)[0] == ["24.0 kept False"]
    registered.write_text("stiffness = 2.0")
    assert warm.run(with_part)[0] == ["24.0 compiled True"]


# --- no folder ---------------------------------------------------------------------------------

NO_PASSWD = """
import pwd
def nobody(number):
    raise KeyError(number)
pwd.getpwuid = nobody
show()
"""


def test_a_user_without_a_home_runs_and_reads_one_sentence(kernel):
    out, said = kernel.run(NO_PASSWD, HOME=None, ROTOR_FMU_CACHE=None)
    assert out == COMPILED
    assert said == ["compiled code is not kept for the next process: this user has no home folder"]


@pytest.mark.parametrize("where", ["HOME", "XDG_CACHE_HOME", "ROTOR_FMU_CACHE"])
def test_a_folder_that_may_not_be_entered_is_done_without(kernel, tmp_path, where):
    locked = tmp_path / "locked"
    locked.write_text("no folder: what even root cannot enter")
    out, said = kernel.run(**{"ROTOR_FMU_CACHE": None, where: str(locked)})
    assert out == COMPILED
    assert len(said) == 1
    assert said[0].startswith("compiled code is not kept for the next process: ")
    assert str(locked) in said[0]


def test_a_full_disk_leaves_nothing_half_written(kernel):
    limit = "import resource\nresource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\nshow()"
    out, said = kernel.run(limit)
    assert out == COMPILED
    assert len(said) == 1
    assert [file.name for file in kernel.folder.iterdir()] == ["lock"]


def test_the_folder_is_the_chosen_one_or_the_platforms(kernel, tmp_path):
    script = "from rotor_fmu.model.kernels.user_cache import user_cache\nprint(user_cache())"
    assert kernel.run(script)[0] == [str(kernel.cache)]
    home = str(tmp_path)
    usual = kernel.run(script, ROTOR_FMU_CACHE=None, HOME=home, LOCALAPPDATA=home)[0]
    assert usual[0].startswith(home)
    assert usual[0].endswith("rotor-fmu")


# --- whose folder ------------------------------------------------------------------------------


def test_the_folder_is_made_for_its_user_alone(warm):
    for folder in (warm.cache / "code", warm.folder):
        assert folder.stat().st_mode & 0o777 == 0o700
    assert warm.file_of_cube.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("which", ["code", "version"])
def test_code_in_a_folder_that_others_can_write_is_not_run(warm, which):
    folder = warm.folder if which == "version" else warm.cache / "code"
    folder.chmod(0o777)
    out, said = warm.run()
    assert out == COMPILED
    assert len(said) == 1
    assert f"{folder} can be written by other users (mode 777)" in said[0]


def test_another_users_folder_and_files_are_refused(tmp_path, monkeypatch):
    folder = SealedFolder(tmp_path / "folder")
    folder.write("name", b"content")
    assert folder.read("name") == b"content"
    if os.geteuid() == 0:  # root's files are anybody's to trust
        os.chown(tmp_path / "folder", 4711, -1)
        os.chown(tmp_path / "folder" / "name", 4711, -1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: 4711)
    assert folder.read("name") is None
    with pytest.raises(PermissionError, match="folder belongs to another user"):
        make_private(tmp_path / "folder")


# --- several processes -------------------------------------------------------------------------


def test_four_processes_on_an_empty_cache_compile_once(kernel):
    processes = [kernel.start() for _ in range(4)]
    lines = sorted(process.communicate(timeout=120)[0].split()[1] for process in processes)
    assert lines == ["compiled", "kept", "kept", "kept"]


def test_a_process_says_that_it_waits_for_another_and_then_takes_its_code(warm):
    warm.file_of_cube.unlink()
    lock = ProcessLock(warm.folder / "lock")
    assert lock.take()
    with warm.start() as process:
        assert process.stderr.readline().strip() == WAITING
        # what the other process would do: code that is whole, and later the lock
        kept = warm.start("kept_overloads.CACHE.wait_or_lock = lambda name: None\nshow()")
        assert kept.communicate(timeout=60)[0].split()[1] == "compiled"
        assert process.communicate(timeout=60)[0].split()[1] == "kept"
    lock.release()


def test_the_wait_has_an_end(warm):
    warm.file_of_cube.unlink()
    lock = ProcessLock(warm.folder / "lock")
    assert lock.take()
    out, said = warm.run("code_cache.WAIT_AT_MOST = 0.2\nshow()")
    assert out == COMPILED
    assert said == [WAITING]


def test_a_compilation_that_fails_gives_the_lock_back(kernel):
    out, _ = kernel.run(
        """
import numba
try:
    cube("text")
except numba.TypingError:
    print(kept_overloads.CACHE._lock.is_held)
show()
print(kept_overloads.CACHE._lock.is_held)
"""
    )
    assert out == ["False", *COMPILED, "False"]


def test_the_lock_of_a_killed_process_is_free(tmp_path):
    file = tmp_path / "lock"
    script = f"""
from pathlib import Path
from rotor_fmu.model.kernels.process_lock import ProcessLock
lock = ProcessLock(Path({str(file)!r}))
print(lock.take(), flush=True)
input()
"""
    command = [sys.executable, "-c", script]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, **pipes, text=True) as holder:
        assert holder.stdout.readline().strip() == "True"
        lock = ProcessLock(file)
        assert not lock.take()
        holder.send_signal(signal.SIGKILL)
        holder.wait()
    assert lock.take()


def test_threads_of_one_process_do_not_wait_for_each_other(kernel):
    out, said = kernel.run(
        """
from concurrent.futures import ThreadPoolExecutor
with ThreadPoolExecutor(4) as pool:
    print(*pool.map(cube, [1.0, 2.0, 3.0, 4.0]))
"""
    )
    assert out == ["1.0 8.0 27.0 64.0"]
    assert said == []
