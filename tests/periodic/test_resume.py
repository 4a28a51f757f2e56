"""A response that was stopped goes on where it was, to the points of an undisturbed one."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import rotor_fmu as rf
from rotor_fmu.periodic import request
from rotor_fmu.periodic.request import compute_response, response_request
from rotor_fmu.periodic.saved_events import FILE, saved_log

from .machines import FAINT_RUB, jeffcott, sagging
from .test_command import COMMAND, JEFFCOTT

# steps as long as they may be, so that the whole has few points
OPTIONS = {"speed": (120.0, 240.0), "step": 0.4}
RUN = ["response", "--rotor", str(JEFFCOTT), "--speed", "60:240", "--step", "0.002"]


class Stopping:
    """Ctrl-C at a point."""

    def __init__(self, at):
        self.left = at

    def __call__(self, label, point):
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def called(folder, machine, stop_at=0, **options):
    asked = OPTIONS | options
    with saved_log(folder, machine.toml, asked) as saved:
        response = response_request(machine.rotor, **asked)
        return compute_response(response, Stopping(stop_at), saved.log)


def equal(one, other):
    """Whether two responses are the same, bit for bit."""
    assert [b.ends for b in one.branches] == [b.ends for b in other.branches]
    assert [(b.kind, b.value, b.behind) for b in one.bifurcations] == [
        (b.kind, b.value, b.behind) for b in other.bifurcations
    ]
    assert len(one.points) == len(other.points)
    for a, b in zip(one.points, other.points, strict=True):
        assert (a.value, a.is_stable, a.orbit.omega) == (b.value, b.is_stable, b.orbit.omega)
        for x, y in ((a.orbit.b, b.orbit.b), (a.motion, b.motion), (a.multipliers, b.multipliers)):
            assert np.array_equal(x, y)
    return True


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """A response stopped again and again, at each count of points, then finished: its folder and
    what each call gave."""
    folder = tmp_path_factory.mktemp("stopped")
    return folder, {at: called(folder, jeffcott(), at) for at in (1, 2, 12, 13, 30, 0)}


@pytest.fixture(scope="module")
def curve():
    """An undisturbed one."""
    return rf.response(jeffcott(), **OPTIONS)


def test_a_stopped_response_goes_on_to_the_points_of_an_undisturbed_one(stopped, curve):
    _, calls = stopped
    assert len(curve.points) > 30
    for at, result in calls.items():
        assert result.is_stopped == (at > 0)
        assert len(result.points) == (at - 1 if at else len(curve.points))
        assert any("stopped" in note for note in result.notes) == (at > 0)
    assert equal(calls[0], curve)


def test_points_stay_where_a_resumed_call_cannot_write(tmp_path):
    """The file of a disk that has become full, begun anew by each call, is not emptied first."""
    resource = pytest.importorskip("resource")
    called(tmp_path, jeffcott(), 12)
    before = (tmp_path / FILE).read_bytes()
    ends = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200, ends[1]))
    try:
        with pytest.raises(OSError, match=FILE):
            called(tmp_path, jeffcott(), 13)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, ends)
    assert (tmp_path / FILE).read_bytes() == before
    assert len(before) > 200


def test_a_line_that_was_not_finished_is_computed_again(stopped, curve):
    file = stopped[0] / FILE
    text = file.read_text()
    file.write_text(text[: 2 * len(text) // 3])
    assert equal(called(stopped[0], jeffcott()), curve)
    assert file.read_text() == text


def goes_on(folder, machine, whole, stops, **options):
    """Whether a response stopped at counts of points goes on to another's."""
    assert len(whole.branches) > 1
    for stop in stops:
        assert called(folder, machine, stop, **options).is_stopped
    return equal(called(folder, machine, **options), whole)


@pytest.mark.slow
def test_both_ways_from_a_seed_are_gone_on_with(tmp_path):
    options = {"speed": (90.0, 155.0), "seeds": (130.0,)}
    isola = rf.response(FAINT_RUB, **OPTIONS | options)
    first = len(isola.branches[0].points)
    assert len(isola.points) > first + 10
    assert goes_on(tmp_path, FAINT_RUB, isola, (first + 2, first + 10), **options)


def test_a_doubled_period_is_gone_on_with(tmp_path):
    options = OPTIONS | {"speed": (245.0, 265.0), "branches": True, "harmonics": 20}
    assert goes_on(tmp_path, sagging(), rf.response(sagging(), **options), (8,), **options)


def test_what_was_saved_of_another_response_is_not_taken_over(tmp_path):
    machine = jeffcott()
    called(tmp_path, machine, 5)
    other = called(tmp_path, machine, speed=(180.0, 240.0))
    assert equal(other, rf.response(machine, **OPTIONS | {"speed": (180.0, 240.0)}))


def test_a_full_disk_is_an_error_of_the_file_with_the_points(tmp_path):
    error = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))  # as of a write: without a name
    with pytest.raises(OSError, match="No space") as full, saved_log(tmp_path, "", {}):
        raise error
    assert full.value.filename == str(tmp_path / FILE)


def started(folder):
    """A call in a process of its own that takes long."""
    call = [sys.executable, "-c", COMMAND, *RUN, "--out", str(folder)]
    return subprocess.Popen(call, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def wait_for(lines, run, file):
    """Until a process has saved so many lines."""
    while run.poll() is None and not (file.exists() and file.read_text().count("\n") >= lines):
        time.sleep(0.02)


def test_ctrl_c_keeps_points_and_pictures_and_the_same_call_goes_on(tmp_path, process, monkeypatch):
    """Which is refused in the same folder while the first is at work."""
    file = tmp_path / FILE
    with started(tmp_path) as run:
        wait_for(22, run, file)
        before = file.read_text()
        second = process(*RUN, "--out", str(tmp_path))
        assert run.poll() is None
        run.send_signal(signal.SIGINT)
        _, said = run.communicate()
    assert second.returncode == 2
    assert second.stderr == f"rotor-fmu: --out {tmp_path}: another call is at work in it\n"
    assert second.stdout == ""
    assert file.read_text().startswith(before)
    assert run.returncode == 130
    assert "the same call continues from there" in said
    count = len(json.loads((tmp_path / "response.json").read_text())["branches"][0]["value"])
    assert count >= 18
    assert (tmp_path / "response.png").exists()
    saved = file.read_text().splitlines()

    def stopped(response, report, log):
        return compute_response(response, Stopping(len(saved) + 4), log)

    monkeypatch.setattr(request, "compute_response", stopped)
    assert process(*RUN, "--out", str(tmp_path)).returncode == 130
    assert file.read_text().splitlines()[: len(saved)] == saved
    assert len(file.read_text().splitlines()) > len(saved) + 3


def test_the_command_shows_how_far_it_is(capsys, monkeypatch):
    """Where nobody watches, a line every now and then: the branch, its points and where it is."""
    from rotor_fmu import screen
    from rotor_fmu.cli import periodic
    from rotor_fmu.display import Display

    class Clock:
        now = 0.0

        @classmethod
        def monotonic(cls):
            cls.now += 6.0
            return cls.now

    monkeypatch.setattr(screen, "time", Clock)
    with periodic._progress(180.0, before=3, axis=Display().of_si("rad/s")) as add:
        compute_response(
            response_request(jeffcott().rotor, speed=(60.0, 110.0)),
            lambda label, point: add(label, point.value, f", {point.orbit.H} harmonics"),
        )
    said = capsys.readouterr().err.splitlines()
    assert len(said) > 3
    for line in said:
        assert re.fullmatch(r"response: .*branch 1: \d+ points, at [\d.]+ Hz, \d+ harmonics", line)
    counts = [int(re.search(r"(\d+) points", line)[1]) for line in said]
    assert counts == sorted(counts)
    assert counts[0] > 3
