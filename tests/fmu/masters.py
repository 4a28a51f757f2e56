"""Two masters that take the same commands: FMPy (commands.py) and a plain C program (host.c)."""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import fmpy
import pytest

from rotor_fmu.cli.runs import host_environment
from rotor_fmu.errors import InputError

from ..processes import run_python

HERE = Path(__file__).parent
COMPILER = shutil.which("cc") or shutil.which("gcc")
NO_COMPILER = "neither cc nor gcc is installed, which compile the C programs"
NEEDS_COMPILER = pytest.mark.skipif(COMPILER is None, reason=NO_COMPILER)
try:
    ENVIRONMENT = host_environment()
except InputError as reason:
    ENVIRONMENT, NO_C_HOST = None, str(reason)
else:
    NO_C_HOST = "" if COMPILER else NO_COMPILER


@dataclass(frozen=True)
class Answer:
    """What a call gave: its name, status, value (of `get`), and the log that came with it."""

    name: str
    status: int
    value: float | None
    log: tuple[str, ...]

    @property
    def is_error(self) -> bool:
        return self.status in (3, 4)


@dataclass(frozen=True)
class Talk:
    """All answers of a master, what was printed on standard error, and the exit status."""

    answers: list[Answer]
    stderr: str
    status: int

    def named(self, name: str) -> list[Answer]:
        return [answer for answer in self.answers if answer.name == name]


class Master:
    """A program that carries out commands on an FMU; is_alone: with no environment at all."""

    def __init__(self, fmu: Path, c_program: Path | None = None, is_alone: bool = False):
        self.fmu = fmu
        self.c_program = c_program
        self.is_alone = is_alone
        self.folder = Path(fmpy.extract(str(fmu)))
        self.description = fmpy.read_model_description(str(self.folder))
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def tell(self, commands, environment=None) -> Talk:
        """Carry out commands, `real speed 300` and the like, in one process."""
        script = self.script(commands)
        if self.c_program is None:
            done = run_python(HERE / "commands.py", self.fmu, given=script)
            return Talk(list(_answers(done.stdout)), done.stderr, done.returncode)
        if not self.is_alone:
            environment = environment or expanded(ENVIRONMENT)
        done = subprocess.run(
            self.program(),
            input=script,
            capture_output=True,
            text=True,
            check=False,
            timeout=1200,
            env={} if self.is_alone else {**os.environ, **(environment or {})},
        )
        return Talk(list(_answers(done.stdout)), done.stderr, done.returncode)

    def program(self) -> list[str]:
        """The command line of the master in C."""
        name = self.description.coSimulation.modelIdentifier
        library = self.folder / "binaries" / "linux64" / f"{name}.so"
        resources = f"file://{self.folder}/resources"
        return [str(self.c_program), str(library), resources, self.description.guid]

    def script(self, commands) -> str:
        """What the master reads: variables by their references."""
        return "".join(f"{self._by_reference(command)}\n" for command in commands)

    def _by_reference(self, command: str) -> str:
        name, *arguments = command.split()
        if name in ("real", "integer", "get"):
            arguments[0] = str(self.refs[arguments[0]])
        return " ".join((name, *arguments))


def expanded(environment):
    """An environment with what a shell would put for $PATH."""
    return {name: os.path.expandvars(value) for name, value in environment.items()}


def _answers(text):
    log = []
    for line in text.splitlines():
        name, status, *rest = line.split(maxsplit=2)
        if name == "log":
            log.append(rest[0] if rest else "")
        else:
            yield Answer(name, int(status), float(rest[0]) if rest else None, tuple(log))
            log = []


def compile_c_host(folder: Path) -> Path:
    """The program of host.c, made by this system's compiler."""
    program = folder / "host"
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-o", program, HERE / "host.c", "-ldl"]
    subprocess.run([COMPILER, *options], check=True)
    return program
