"""What ends a program while it writes leaves what was there before, and nothing else."""

import errno
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest

from rotor_fmu.errors import InputError, writable_folder
from rotor_fmu.files import unfinished
from rotor_fmu.fmi.packing import python_fmu

from ..recordings import recorded

FULL = Path("/dev/full")


def test_a_file_takes_its_place_when_it_is_whole(tmp_path):
    target = tmp_path / "summary.json"
    with unfinished(target) as part:
        part.write_text("whole")
        assert part.suffix == ".json"  # writers choose a format by it
        assert not target.exists()
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [
        (target.name, "whole")
    ]


@pytest.mark.parametrize("end", [KeyboardInterrupt, OSError])
def test_what_stops_the_writing_leaves_the_old_file_alone(tmp_path, end):
    target = tmp_path / "summary.json"
    target.write_text("old")

    def write():
        with unfinished(target) as part:
            part.write_text("half")
            raise end

    with pytest.raises(end):
        write()
    (left,) = tmp_path.iterdir()
    assert (left, left.read_text()) == (target, "old")


def test_a_full_disk_is_said_with_the_name_of_the_file(tmp_path):
    target = tmp_path / "summary.json"
    with pytest.raises(OSError, match="No space left on device") as caught, unfinished(target):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert caught.value.filename == str(target)


ROSS = Path(__file__).parents[1] / "reference" / "ross" / "rubbing.toml"
FILMS = Path(__file__).parents[2] / "examples" / "oil_film" / "rotor.toml"
RUBBING = ("--rotor", str(ROSS))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with a name are of POSIX")
@pytest.mark.parametrize(
    "command",
    [
        ("import-ross", str(ROSS), "--out"),
        ("page", *RUBBING, "--out"),
        ("report", *RUBBING, "--rated", "100", "--out"),
        ("bearing", "--rotor", str(FILMS), "--speed", "100", "--table"),
    ],
    ids=lambda command: command[0],
)
def test_what_is_no_file_is_not_replaced_by_one(input_error, tmp_path, command):
    """Such as /dev/null, which any program of the machine writes to."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    said = input_error(*command, "pipe")
    assert said == f"rotor-fmu: {command[-1]} pipe: is a device or a pipe, not a file"
    with pytest.raises(InputError, match="pipe: is a device or a pipe, where"), unfinished(pipe):
        pass
    assert pipe.is_fifo()


# What writes, each into a folder of its own, and a file too large for the little that is left.
WRITERS = {
    "run-down": (["run-down", "--direct", "--stop", "0.5"], 30),
    "modes": (["modes"], 30),
    "show": (["show"], 30),
    "plot": (["plot", "bode", "RUN"], 30),
    "report": (["report", "RUN", "--out", "OUT/report.html"], 30),
    "example": (["example", "drop"], 30),
    "build": (["build"], 30),
    "study": (["study", "STUDY", "--jobs", "1"], 1),
    "study --select": (["study", "STUDY", "--select", "0"], 30),
}
STUDY = """machine = "jeffcott_rub/jeffcott.toml"
[run]
kind = "run-up"
from = 50
to = 60
rate = 20
[vary]
"contact[1].mu" = { values = [0.0] }
[keep]
x = { peak = "disc.x" }
"""


@contextmanager
def little_room(kilobytes):
    """No file grows beyond this size: a write fails amid.

    Python would cut off its own compiled modules there, and not notice: none is written.
    """
    import resource

    before, compiled = resource.getrlimit(resource.RLIMIT_FSIZE), sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1024, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        sys.dont_write_bytecode = compiled


@pytest.mark.skipif(not hasattr(os, "fork"), reason="limits of files are POSIX")
def test_a_full_temporary_folder_is_said_with_its_name(process, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(python_fmu, "_WRAPPED", {})  # as of a process that has built none
    with little_room(30):
        done = process("build", "--out", str(tmp_path / "out"))
    (said,) = done.stderr.strip().splitlines()
    assert done.returncode == 1
    assert said.startswith(f"rotor-fmu: {tmp_path}/rotor_fmu_")
    assert said.endswith(": cannot be read or written: File too large")


@pytest.mark.usefixtures("drawn")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="limits of files are POSIX")
@pytest.mark.parametrize("writer", WRITERS)
def test_every_writer_says_a_full_disk_in_one_sentence_and_leaves_nothing_half_written(
    writer, process, tmp_path
):
    """A limit on the size of a file stands for the disk."""
    arguments, limit = WRITERS[writer]
    run, out = tmp_path / "run", tmp_path / "out"
    if "RUN" in arguments:
        run.mkdir()
        recorded(stop=2.0).save(run / "recording.npz")
    (tmp_path / "study.toml").write_text(STUDY)
    names = {"RUN": str(run), "STUDY": str(tmp_path / "study.toml")}
    given = [names.get(word, word).replace("OUT", str(out)) for word in arguments]
    if "--out" not in given:
        given += ["--out", str(out)]
    with little_room(limit):
        done = process(*given)
    said = [line for line in done.stderr.splitlines() if line.startswith("rotor-fmu: ")]
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    assert said[-1].count("File too large") == 1
    assert "Errno" not in said[-1]
    left = [path for path in out.rglob("*") if path.is_file()]
    assert not [path for path in left if ".part" in path.name or ".unfinished" in path.name]
    assert all(path.stat().st_size < limit * 1024 for path in left)


@pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full")
def test_an_output_that_cannot_be_written_is_one_sentence():
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-c", "from rotor_fmu.cli import main; main()", "variables"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 1
    assert done.stderr.strip().count("\n") == 0
    assert "No space left on device" in done.stderr


def test_commands_that_write_into_one_folder_do_not_refuse_it(tmp_path):
    with ThreadPoolExecutor(8) as pool:
        folders = list(pool.map(writable_folder, [tmp_path / "out"] * 400))
    assert set(folders) == {tmp_path / "out"}
    assert not list((tmp_path / "out").iterdir())
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written to"):
        writable_folder(tmp_path / "file")
