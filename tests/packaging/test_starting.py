"""A process imports what it uses: a run no pictures, the help no numbers."""

import json

import pytest

from ..known import EXAMPLES
from ..processes import run_anew

LOADED = "import json, sys; print(json.dumps(sorted(sys.modules)))"
RUN = """
import rotor_fmu as rf
rf.simulate(rf.load(), speed=185.0, stop=0.001)
"""
UNBALANCE = """
import numpy as np
import rotor_fmu as rf
from rotor_fmu import vibration
rf.load().unbalance_response(np.linspace(50.0, 200.0, 20)).table()
speeds = np.linspace(0.0, 9.0, 50)
vibration.resonances(speeds, np.sin(speeds))
"""
HELP_OF_EACH = """
import contextlib, io, sys
from rotor_fmu.cli import COMMANDS, app
for name in (name for panel in COMMANDS.values() for name in panel):
    with contextlib.redirect_stdout(io.StringIO()) as text:
        with contextlib.suppress(SystemExit):
            app([name, "--help"])
    assert name in text.getvalue()
"""
HELP_AND_COMPLETION = """
import contextlib, io, os, sys
sys.argv = ["rotor-fmu", "--help"]
from rotor_fmu.cli import main
with contextlib.redirect_stdout(io.StringIO()) as text, contextlib.suppress(SystemExit):
    main()
assert "run-down" in text.getvalue()
os.environ |= {
    "_ROTOR_FMU_COMPLETE": "complete_bash", "COMP_WORDS": "rotor-fmu ru", "COMP_CWORD": "1"
}
sys.argv = ["rotor-fmu"]
with contextlib.redirect_stdout(io.StringIO()) as text, contextlib.suppress(SystemExit):
    main()
assert text.getvalue().split() == ["run-down", "run-up"], text.getvalue()
"""
STOPPED_EARLY = """
import sys
class Stopped:
    def find_spec(self, name, *others):
        if name == "typer":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stopped())
from rotor_fmu.command import main
main()
"""


def run(script, *arguments, **environment):
    done = run_anew(script, *arguments, **environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ("script", "unused"),
    [
        (RUN, {"matplotlib", "scipy", "numba", "fmpy", "typer", "rich"}),
        (UNBALANCE, {"scipy.signal"}),
        (HELP_OF_EACH, {"matplotlib", "scipy", "numba", "fmpy", "pandas"}),
        (HELP_AND_COMPLETION, {"numpy", "matplotlib", "scipy", "numba", "fmpy", "rotor_fmu.fmi"}),
    ],
)
def test_a_process_imports_what_it_uses(script, unused):
    loaded = set(json.loads(run(script + LOADED)))
    assert not loaded & unused


THREADS = """
import importlib, sys
import numpy as np, scipy.linalg, threadpoolctl
import rotor_fmu as rf
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.simulation import Simulation
threads = lambda: {library["num_threads"] for library in threadpoolctl.threadpool_info()}
threadpoolctl.threadpool_limits(2)  # of the environment fewer are taken where there is one core
for watched, call in (
    ("scipy.linalg.eig", lambda: rf.load().modes(100.0)),
    ("numpy.linalg.eigvalsh", lambda: Simulation(rig(), speed=100.0)),
    ("numpy.linalg.solve", lambda: rf.response(rf.load(sys.argv[1]), speed=(60.0, 61.0))),
):
    module, _, name = watched.rpartition(".")
    module = importlib.import_module(module)
    counts, whole = set(), getattr(module, name)
    def seen(*arguments, **options):
        counts.update(threads())
        return whole(*arguments, **options)
    setattr(module, name, seen)
    call()
    setattr(module, name, whole)
    print(watched, counts, threads())
"""


def test_linear_algebra_takes_one_thread_and_leaves_as_many_as_there_were():
    said = run(THREADS, EXAMPLES / "jeffcott_rub" / "jeffcott.toml").splitlines()
    assert len(said) == 3
    assert [line for line in said if not line.endswith(" {1} {2}")] == []


def test_the_command_takes_one_thread_for_linear_algebra_unless_it_is_told_another_number():
    script = (
        "import os, sys; sys.argv = ['rotor-fmu', '--version']\n"
        "from rotor_fmu import cli; cli.run = lambda app: None; cli.main()\n"
        "print('numpy' in sys.modules, os.environ['OPENBLAS_NUM_THREADS'])"
    )
    assert run(script, OPENBLAS_NUM_THREADS="3").split() == ["False", "3"]
    bare = f"import os; os.environ.pop('OPENBLAS_NUM_THREADS', None)\n{script}"
    assert run(bare).split() == ["False", "1"]


def test_ctrl_c_during_the_first_imports_ends_the_command_in_one_line():
    done = run_anew(STOPPED_EARLY)
    assert done.returncode == 130
    assert done.stderr == "rotor-fmu: stopped; nothing unfinished was written\n"
