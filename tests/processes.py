"""Programs in processes of their own, forked from one that has imported FMPy, as most of them do.

For what a process does and survives, as a host of an FMU. What depends on how a process is started,
or on what it has imported, starts one by `run_anew`.
"""

import multiprocessing
import os
import signal
import sys
import time
from pathlib import Path
from subprocess import CompletedProcess, TimeoutExpired, run
from tempfile import TemporaryDirectory

ROTOR_FMU = "from rotor_fmu.cli import main; main()"  # the program of the command

_FORKS = "forkserver" in multiprocessing.get_all_start_methods()
_CONTEXT = multiprocessing.get_context("forkserver" if _FORKS else "spawn")
if _FORKS:
    _CONTEXT.set_forkserver_preload(["fmpy"])
_STREAMS = ("stdin", "stdout", "stderr")
# before any FMU has put what it carries, such as a pythonfmu without libraries, in front
_SYS_PATH = sys.path.copy()


def run_anew(program, *arguments, cwd=None, seconds=None, **environment):
    """A program's text in a Python that is started for it, with these variables of the environment
    beside those that there are: as `subprocess.run`."""
    return run(
        [sys.executable, "-c", program, *map(str, arguments)],
        env={**os.environ, **environment},
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
        timeout=seconds,
    )


def interrupted(process, is_ready):
    """A process to which Ctrl-C is sent a little after it is ready: its exit status and standard
    error."""
    try:
        while not is_ready():
            assert process.poll() is None
            time.sleep(0.05)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=600)
    finally:
        process.kill()
    return process.returncode, said


def run_python(program, *arguments, cwd=None, given="", seconds=1200):
    """A program, a file's `Path` or text, with arguments and what it reads: its exit status and
    what it printed, as `subprocess.run` gives them."""
    command = [str(each) for each in (program, *arguments)]
    with TemporaryDirectory(prefix="process_") as name:
        streams = [Path(name, stream) for stream in _STREAMS]
        for stream in streams:
            stream.write_text(given if stream.name == "stdin" else "")
        has_file = isinstance(program, Path)
        passed = (command, has_file, str(cwd or Path.cwd()), dict(os.environ), streams, _SYS_PATH)
        process = _CONTEXT.Process(target=_run, args=passed)
        process.start()
        process.join(seconds)
        if process.is_alive():
            process.kill()
            process.join()
            raise TimeoutExpired(command, seconds)
        _, out, said = (stream.read_text(errors="replace") for stream in streams)
        return CompletedProcess(command, process.exitcode, out, said)


def _run(command, has_file, cwd, environment, streams, sys_path):
    """Be the process that a command starts."""
    for number, stream in enumerate(streams):
        opened = os.open(stream, os.O_RDWR | os.O_APPEND)
        os.dup2(opened, number)
        os.close(opened)
    sys.stdin = open(0, closefd=False)  # noqa: SIM115
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(cwd)
    program, *arguments = command
    sys.argv = [program if has_file else "-c", *arguments]
    # that of the tests' process has been handed over
    sys.path[:] = [str(Path(program).parent) if has_file else "", *sys_path]
    text = Path(program).read_bytes() if has_file else program
    names = {"__name__": "__main__", "__file__": program} if has_file else {"__name__": "__main__"}
    exec(compile(text, program if has_file else "<string>", "exec"), names)
