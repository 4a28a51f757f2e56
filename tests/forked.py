"""Processes that begin with numba imported and nothing else, in the time of a fork."""

import multiprocessing
import os
import sys
from pathlib import Path
from tempfile import mkdtemp

FROM = multiprocessing.get_context("forkserver")
FROM.set_forkserver_preload(["numba"])


def carry_out(script, environment, out, err):
    """What the process does: as `python -c` would, with this environment."""
    for number, name in ((1, out), (2, err)):
        pipe = os.open(name, os.O_WRONLY)
        os.dup2(pipe, number)
        os.close(pipe)
    os.environ.clear()
    os.environ.update(environment)
    sys.path[:0] = environment["PYTHONPATH"].split(os.pathsep)
    exec(compile(script, "<script>", "exec"), {"__name__": "__main__"})


class Forked:
    """A script in a process of its own, with what these tests use of `subprocess.Popen`."""

    def __init__(self, script, environment):
        folder = Path(mkdtemp(prefix="rotor_fmu_tests_"))
        out, err = folder / "out", folder / "err"
        os.mkfifo(out)
        os.mkfifo(err)
        arguments = script, environment, str(out), str(err)
        self._process = FROM.Process(target=carry_out, args=arguments)
        self._process.start()
        self.stdout, self.stderr = out.open(), err.open()  # waits for the process to write
        for name in (out, err):
            name.unlink()
        folder.rmdir()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.communicate()

    @property
    def returncode(self):
        return self._process.exitcode

    def communicate(self, timeout=None):
        """Output and messages; `TimeoutError` if the process does not end."""
        self._process.join(timeout)
        if self._process.is_alive():
            self._process.kill()
            raise TimeoutError(f"still running after {timeout} s")
        said = [self._rest_of(pipe) for pipe in (self.stdout, self.stderr)]
        return tuple(said)

    @staticmethod
    def _rest_of(pipe):
        if pipe.closed:
            return ""
        with pipe:
            return pipe.read()
