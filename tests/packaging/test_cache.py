"""Code that numba compiled is cached for the next process, and whatever is wrong with the folder
costs time and never a result.

A small kernel is compiled, in a process of its own where what is in memory matters.
"""

import os
import pwd
import runpy
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest
from rotor_fmu.model.kernels import cache
from rotor_fmu.model.kernels.cache import check_private, private_folder
from rotor_fmu.model.kernels.jit import jit

import rotor_fmu

KERNEL = """
import sys
from rotor_fmu.model.kernels import dispatching
from rotor_fmu.model.kernels.jit import jit, has_to_compile

@jit
def square(x):
    return x * x

@jit
def cube(x):
    return x * square(x)

def show():
    has_to = has_to_compile(cube)
    print(cube(2.0), "compiled" if cube.stats.cache_misses else "cached", has_to)
"""
COMPILED, CACHED = "8.0 compiled True", "8.0 cached False"


class Kernel:
    """A small kernel in a file, its cache, and processes that call it."""

    def __init__(self, folder):
        self.file = folder / "kernel.py"
        self.file.write_text(KERNEL)
        self.cache = folder / "cache"

    def run(self, script="show()", **environment):
        """The output and the messages of a process that ends well."""
        source = str(Path(rotor_fmu.__file__).parents[1])
        inherited = {k: v for k, v in os.environ.items() if k != "XDG_CACHE_HOME"}
        path = os.pathsep.join([str(self.file.parent), source])
        variables = {"ROTOR_FMU_CACHE": str(self.cache), "PYTHONPATH": path, **environment}
        variables = {k: v for k, v in (inherited | variables).items() if v is not None}
        done = subprocess.run(
            [sys.executable, "-c", f"from kernel import *\n{script}"],
            env=variables,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.strip(), done.stderr.strip()


@pytest.fixture
def kernel(tmp_path):
    return Kernel(tmp_path)


def dispatching():
    """The module that imports numba, which no other test needs."""
    return import_module("rotor_fmu.model.kernels.dispatching")


@pytest.fixture
def here(monkeypatch, tmp_path):
    """Kernels are compiled in this process, and cached in the folder `numba`."""
    folder = private_folder(tmp_path / "numba")
    monkeypatch.setattr(dispatching(), "cache_folder", lambda: folder)
    return monkeypatch


def kernel_in(folder):
    """The small kernels, compiled in this process as they are called."""
    file = folder / "kernel.py"
    file.write_text(KERNEL)
    return SimpleNamespace(**runpy.run_path(str(file)))


@pytest.mark.slow
def test_what_one_process_compiles_the_next_finds_until_a_kernel_changes(kernel):
    assert kernel.run() == (COMPILED, "")
    assert kernel.run() == (CACHED, "")
    # as after a change of any kernel, of those in other files too
    other = "dispatching.kernels_digest = lambda: 'f' * 16\nshow()"
    assert kernel.run(other) == (COMPILED, "")
    assert len(list((kernel.cache / "numba").iterdir())) == 2
    # the folders are their user's alone, and code in one that others can write to is not run
    folder = kernel.cache / "numba"
    for each in (kernel.cache, folder, *folder.iterdir()):
        assert each.stat().st_mode & 0o777 == 0o700
    folder.chmod(0o777)
    out, said = kernel.run()
    assert out == COMPILED
    assert f"{folder} can be written by other users (mode 777)" in said


def test_the_cache_of_the_users_own_numba_functions_stays_where_it_is(here, tmp_path):
    import numba

    own = str(tmp_path / "own")
    here.setenv("NUMBA_CACHE_DIR", own)  # which numba reads again after a change
    here.setattr(numba.config, "CACHE_DIR", own)
    assert kernel_in(tmp_path).cube(2.0) == 8.0
    assert list((tmp_path / "numba").iterdir())
    assert own == numba.config.CACHE_DIR
    assert not Path(own).exists()


NO_PASSWD = """
import pwd
def nobody(number):
    raise KeyError(number)
pwd.getpwuid = nobody
show()
"""


def test_code_of_a_user_without_a_home_is_not_cached(monkeypatch, caplog):
    def nobody(number):
        raise KeyError(number)

    for name in ("HOME", "ROTOR_FMU_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pwd, "getpwuid", nobody)
    monkeypatch.setattr(cache, "_said", set())
    assert dispatching().cache_folder.__wrapped__() is None
    (said,) = caplog.messages
    assert "compiled code is not cached for the next process: this user has no home folder" in said


@pytest.mark.slow
def test_a_user_without_a_home_reads_one_sentence_for_the_libraries_and_one_for_the_code(kernel):
    out, said = kernel.run(NO_PASSWD, HOME=None, ROTOR_FMU_CACHE=None)
    assert out == COMPILED
    assert "compiled code is not cached for the next process: this user has no home folder" in said
    assert not (kernel.file.parent / "~").exists()


@pytest.mark.parametrize("where", ["HOME", "XDG_CACHE_HOME", "ROTOR_FMU_CACHE"])
def test_a_folder_that_may_not_be_entered_is_done_without(tmp_path, monkeypatch, caplog, where):
    locked = tmp_path / "locked"
    locked.write_text("no folder: what even root cannot enter")
    for name in ("ROTOR_FMU_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv(where, str(locked))
    monkeypatch.setattr(cache, "_said", set())
    assert dispatching().cache_folder.__wrapped__() is None
    (said,) = caplog.messages
    assert "compiled code is not cached for the next process: " in said
    assert str(locked) in said


def test_another_users_folder_is_refused(tmp_path, monkeypatch):
    folder = private_folder(tmp_path / "folder")
    check_private(folder)
    if os.geteuid() == 0:  # root's files are anybody's to trust
        os.chown(folder, 4711, -1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: 4711)
    with pytest.raises(PermissionError, match="folder belongs to another user"):
        private_folder(folder)


def test_a_link_to_a_folder_is_refused(tmp_path):
    (tmp_path / "link").symlink_to(private_folder(tmp_path / "folder"))
    with pytest.raises(PermissionError, match="link is not a folder"):
        private_folder(tmp_path / "link")


def test_a_kernel_that_was_typed_in_runs_uncached(here, tmp_path):
    scope = {}
    exec("def add(x):\n    return x + 1.0", scope)
    assert jit(scope["add"])(1.0) == 2.0
    assert not list((tmp_path / "numba").iterdir())


def test_threads_of_one_process_compile_for_each_other(here, tmp_path):
    with ThreadPoolExecutor(4) as pool:
        cubes = pool.map(kernel_in(tmp_path).cube, [1.0, 2.0, 3.0, 4.0])
    assert [*cubes] == [1.0, 8.0, 27.0, 64.0]
