"""Functions in the place of a machine: the same path from a study's file to its rows."""

import contextlib
import math
import os
import signal
import time
from concurrent.futures import Executor, Future
from dataclasses import dataclass

from rotor_fmu import studies
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.studies.executors import Engine
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.study import Column, Result
from rotor_fmu.studies.study_file import read_study_file
from rotor_fmu.units import number

NAMES = ("x1", "x2", "x3")


@dataclass(frozen=True)
class Ishigami:
    """sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 on (-pi, pi)^3, and a curve of it.

    pause: how long a run takes [s]; fails_above: x1 above which it raises; deadly_above: above
    which it kills its process.
    """

    pause: float = 0.0
    fails_above: float = math.inf
    deadly_above: float = math.inf
    identity = "ishigami"
    columns = (
        Column("y", "1", "value"),
        Column("curve", "1", "beside x1", "beside", (-0.1, 0.0, 0.1)),
    )

    def warm(self):
        pass

    def run(self, values):
        if self.pause:
            time.sleep(self.pause)
        x1, x2, x3 = (values[name] for name in NAMES)
        if x1 > self.deadly_above:
            os.kill(os.getpid(), signal.SIGKILL)
        if x1 > self.fails_above:
            raise ValueError(f"x1 = {x1:.3g}: too large")
        y = math.sin(x1) + 7 * math.sin(x2) ** 2 + 0.1 * x3**4 * math.sin(x1)
        return Result("ok", {"y": y, "curve": [y - 0.1, y, y + 0.1]})


class Function:
    """A function as the subject of a study."""

    units = dict.fromkeys(NAMES, "1")
    display_units = ""

    def __init__(self, function):
        self._function = function

    def why_not(self, name):
        return ""

    def value(self, name, where, given):
        return number(where, given, self.units[name])

    def model(self, axes):
        return self._function


def study_text(kind="saltelli", size=16):
    """A study of Ishigami's function."""
    lines = [
        f"{name} = {{ distribution = 'uniform', low = -{math.pi}, high = {math.pi} }}"
        for name in NAMES
    ]
    return "\n".join(
        ["[design]", f"kind = '{kind}'", f"size = {size}", "seed = 3", "[vary]", *lines]
    )


def ishigami_study(folder, model=None, text=None):
    """The study read from a file in a folder."""
    path = folder / "study.toml"
    path.write_text(text or study_text())
    return read_study_file(path, lambda tables, beside: Function(model or Ishigami()))


class SerialExecutor(Executor):
    """An executor that runs in this process, at once."""

    def submit(self, fn, /, *args, **kwargs):
        """Run the function at once."""
        future = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@contextlib.contextmanager
def here():
    """An engine in this process."""
    yield Engine(SerialExecutor(), 1, 0.05)


@contextlib.contextmanager
def one_by_one():
    """An engine in this process whose chunks are single runs."""
    yield Engine(SerialExecutor(), 1, 0.0)


def quiet(progress):
    """No progress."""


def conducted(text, folder):
    """A study written into a folder and run: its file, the folder of its rows, and the rows."""
    path, out = folder / "study.toml", folder / "out"
    path.write_text(text)
    run_study(read_study(path), out, here, quiet)
    return path, out, studies.open(out)
