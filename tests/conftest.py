"""What is built and compiled once for all workers of pytest-xdist; pictures nobody looks at."""

import gc
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from contextlib import nullcontext
from multiprocessing.util import Finalize
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from rotor_fmu.model.backend import waits_for_compiler

from rotor_fmu.cli import app, main
from rotor_fmu.errors import InputError
from rotor_fmu.fmi.packing import archive
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.linear import mode_answers
from rotor_fmu.plotting import figure_style

from .coarse_report import (  # noqa: F401, fixtures
    coarse_report,
    conclusions_alone,
    without_peaks,
    without_runs,
)
from .documents.browser import driver, silent  # noqa: F401, fixtures

# with this, jsonschema makes 38 parsers of addresses as it is imported, which takes seconds, and no
# schema here has an address
sys.modules["rfc3987_syntax"] = None

TEMPORARY = pytest.StashKey[Path]()
# files whose tests look at the same responses, or open pages in the same browser
TOGETHER = [f"tests/periodic/test_{name}.py" for name in ("page", "branches", "located", "rub")]
TOGETHER += ["tests/documents/test_page.py"]

COMPILE_MODEL = """
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
Simulation(rig(), choose("robust"), speed=400.0, rate=-10.0).advance(0.01, 400.0)
"""


def pytest_configure(config):
    # what a shell starts in the background is deaf to Ctrl-C, and so would be all that it starts
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    # a hundred FMUs are built: in a quarter of the time they are a tenth larger
    archive._LEVEL = 1
    if not hasattr(config, "workerinput"):
        # FMUs that hosts unpack and profiles of browsers go with the session, not so `tmp_path`
        os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", tempfile.gettempdir())
        config.stash[TEMPORARY] = Path(tempfile.mkdtemp(prefix="tests_"))
        os.environ["TMPDIR"] = tempfile.tempdir = str(config.stash[TEMPORARY])
        # at the very end: multiprocessing removes a folder of its own in it at -100
        Finalize(None, shutil.rmtree, (config.stash[TEMPORARY], True), exitpriority=-200)


@pytest.hookimpl(hookwrapper=True)
def pytest_collection():
    """Modules and tests stay to the end: looked through for garbage again and again, they take
    a tenth of the time."""
    gc.disable()
    yield
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000, 10, 10)


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node):
    """Before pytest-xdist starts a worker: tell it where the FMU is that they all drive."""
    folder = node.config.stash[TEMPORARY] / "fmu"
    if not folder.exists():
        build(folder, machine_of())
        _compile()
    node.workerinput["fmu"] = str(next(folder.glob("*.fmu")))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Files that share what takes long to make are one worker's, as the tests of a file are."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid):
            file = super()._split_scope(nodeid)
            return TOGETHER[0] if file in TOGETHER else file

    return Scheduling(config, log) if config.getvalue("dist") == "loadfile" else None


def _compile():
    """Without a library of kernels fill an empty cache, so that no two workers compile the same."""
    if waits_for_compiler():
        subprocess.run([sys.executable, "-c", COMPILE_MODEL], capture_output=True, check=False)


@pytest.fixture
def command(tmp_path, capsys):
    """A command carried out in this process, its files in `out`: what it prints."""

    def run(*arguments):
        app([*arguments, "--out", str(tmp_path / "out")], standalone_mode=False)
        return capsys.readouterr().out

    return run


@pytest.fixture
def process(tmp_path, monkeypatch, capfd):
    """`rotor-fmu` as its own process would run it, in this one, which has loaded what it needs."""

    def run(*arguments):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["rotor-fmu", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        said = capfd.readouterr()
        return subprocess.CompletedProcess(arguments, end.value.code, said.out, said.err)

    return run


@pytest.fixture
def refusal(command, tmp_path):
    """The message of a command that is refused; it must leave nothing behind."""

    def run(*arguments):
        before = set(tmp_path.rglob("*"))
        with pytest.raises((InputError, ValueError)) as refused:
            command(*arguments)
        assert set(tmp_path.rglob("*")) == before
        return str(refused.value)

    return run


@pytest.fixture
def input_error_of(tmp_path, monkeypatch, capsys):
    """`input_error` of another program, whose entry point it takes."""

    def program(main):
        def refuse(*arguments):
            monkeypatch.chdir(tmp_path)
            monkeypatch.setattr(sys, "argv", ["rotor-fmu", *arguments])
            before = set(tmp_path.rglob("*"))
            with pytest.raises(SystemExit) as end:
                main()
            assert end.value.code == 2
            assert set(tmp_path.rglob("*")) == before
            (line,) = capsys.readouterr().err.strip().splitlines()
            assert line.startswith("rotor-fmu: ")
            return line

        return refuse

    return program


@pytest.fixture
def input_error(input_error_of):
    """The one line that a refused command prints; it must leave nothing behind."""
    return input_error_of(main)


@pytest.fixture
def drawn():
    """For a test that looks at pictures in files or pages."""


@pytest.fixture(autouse=True)
def _undrawn(request, monkeypatch):
    """Pictures in files and pages are empty where nobody looks at them: to draw them takes long,
    and so does to place their axes, and to compose those of mode shapes in space."""
    draw = Figure.savefig

    def savefig(figure, file, **options):
        if isinstance(file, Path):
            file.touch()
        elif options.get("format") != "svg":
            draw(figure, file, **options)

    if "drawn" not in request.fixturenames:
        monkeypatch.setattr(Figure, "savefig", savefig)
        monkeypatch.setattr(figure_style, "placed", nullcontext)
        monkeypatch.setattr(figure_style.PlainFigure, "place_axes", lambda self: None)
        monkeypatch.setattr(mode_answers, "mode_shapes_figure", lambda *_: Figure())
