"""A response that was stopped goes on where it was, to the points of an undisturbed one."""

import json
import re
import signal
import subprocess
import sys

import numpy as np
import pytest

import rotor_fmu as rf
from rotor_fmu.periodic.saved_events import FILE, saved_journal

from .machines import jeffcott
from .test_command import COMMAND, JEFFCOTT

OPTIONS = {"speed": (100.0, 240.0)}


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
    with saved_journal(folder, machine.toml, asked) as saved:
        return rf.response(machine, **asked, tell=Stopping(stop_at), journal=saved.journal)


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


@pytest.mark.parametrize("stops", [(1,), (2,), (30, 31, 90), (149,)])
def test_a_stopped_response_goes_on_to_the_points_of_an_undisturbed_one(tmp_path, stops):
    machine = jeffcott()
    whole = rf.response(machine, **OPTIONS)
    assert len(whole.points) > 149
    for stop in stops:
        stopped = called(tmp_path, machine, stop)
        assert stopped.is_stopped
        assert len(stopped.points) == stop - 1
        assert any("stopped" in note for note in stopped.notes)
    assert equal(called(tmp_path, machine), whole)


def test_both_ways_from_a_seed_are_gone_on_with_and_a_doubled_period_too(tmp_path):
    from .test_branches import ISOLA, sagging

    for machine, options, stops in (
        (ISOLA, {"seeds": (130.0,)}, (52, 60)),
        (sagging(), {"speed": (240.0, 300.0), "branches": True, "harmonics": 20}, (30,)),
    ):
        folder = tmp_path / str(len(options))
        folder.mkdir()
        whole = rf.response(machine, **OPTIONS | options)
        assert len(whole.branches) > 1
        for stop in stops:
            assert called(folder, machine, stop, **options).is_stopped
        assert equal(called(folder, machine, **options), whole)


def test_a_line_that_was_not_finished_is_computed_again(tmp_path):
    machine = jeffcott()
    whole = called(tmp_path, machine)
    file = tmp_path / FILE
    text = file.read_text()
    file.write_text(text[: len(text) // 2])
    assert equal(called(tmp_path, machine), whole)
    assert file.read_text() == text


def test_what_was_saved_of_another_response_is_not_taken_over(tmp_path):
    machine = jeffcott()
    called(tmp_path, machine, 5)
    other = called(tmp_path, machine, speed=(150.0, 240.0))
    assert equal(other, rf.response(machine, speed=(150.0, 240.0)))


def test_ctrl_c_keeps_points_and_pictures_and_the_same_call_goes_on(tmp_path):
    arguments = ["response", "--rotor", JEFFCOTT, "--speed", "60:240", "--step", "0.002"]
    call = [sys.executable, "-c", COMMAND, *map(str, arguments), "--out", str(tmp_path)]
    with subprocess.Popen(call, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as run:
        file = tmp_path / FILE
        while run.poll() is None and not (file.exists() and file.read_text().count("\n") > 20):
            pass
        run.send_signal(signal.SIGINT)
        _, said = run.communicate()
    assert run.returncode == 130
    assert "the same call continues from there" in said
    before = len(json.loads((tmp_path / "response.json").read_text())["branches"][0]["value"])
    assert before >= 18
    assert (tmp_path / "response.png").exists()
    saved = file.read_text().splitlines()
    with subprocess.Popen(call, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as run:
        while run.poll() is None and file.read_text().count("\n") <= len(saved) + 3:
            pass
        run.send_signal(signal.SIGINT)
        run.communicate()
    assert file.read_text().splitlines()[: len(saved)] == saved


def test_a_second_call_into_the_same_folder_is_refused_while_the_first_is_at_work(tmp_path):
    arguments = ["response", "--rotor", JEFFCOTT, "--speed", "60:240", "--step", "0.002"]
    call = [sys.executable, "-c", COMMAND, *map(str, arguments), "--out", str(tmp_path)]
    with subprocess.Popen(call, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as run:
        file = tmp_path / FILE
        while run.poll() is None and not (file.exists() and file.read_text().count("\n") > 5):
            pass
        before = file.read_text()
        second = subprocess.run(call, capture_output=True, text=True, check=False)
        assert run.poll() is None
        run.send_signal(signal.SIGINT)
        run.communicate()
    assert second.returncode == 2
    assert second.stderr == f"rotor-fmu: --out {tmp_path}: another call is at work in it\n"
    assert second.stdout == ""
    assert file.read_text().startswith(before)
    with saved_journal(tmp_path, "another", {}):
        pass  # the first has left it


def test_the_command_shows_how_far_it_is(tmp_path):
    """Where nobody watches, a line every now and then: the branch, its points and where it is."""
    from rich.console import Console

    from rotor_fmu import screen
    from rotor_fmu.cli import periodic
    from rotor_fmu.display import Display

    said = []

    class Clock:
        now = 0.0

        @classmethod
        def monotonic(cls):
            cls.now += 6.0
            return cls.now

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(screen, "time", Clock)
        patch.setattr(periodic, "_errors", Console(file=Lines(said), width=200))
        with periodic._progress(180.0, before=3, axis=Display().of_si("rad/s")) as tell:
            rf.response(jeffcott(), speed=(60.0, 240.0), tell=tell)
    assert len(said) > 3
    for line in said:
        assert re.fullmatch(r"response: .*branch 1: \d+ points, at [\d.]+ Hz, \d+ harmonics", line)
    counts = [int(re.search(r"(\d+) points", line)[1]) for line in said]
    assert counts == sorted(counts)
    assert counts[0] > 3


class Lines:
    """A file that collects its lines."""

    def __init__(self, lines):
        self.lines = lines

    def write(self, text):
        self.lines += [line for line in text.splitlines() if line.strip()]

    def flush(self):
        pass
