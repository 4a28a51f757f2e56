"""Help and completion of the command line."""

import re

import numpy as np
import pytest
from typer.testing import CliRunner

import rotor_fmu as rf
from rotor_fmu.cli import COMMANDS, _loaded, app
from rotor_fmu.vibration import synchronous

NAMES = [name for panel in COMMANDS.values() for name in panel]


@pytest.mark.parametrize("name", NAMES)
def test_help_shows_no_type_beside_a_flag_and_loses_no_word(name):
    text = CliRunner(env={"COLUMNS": "400"}).invoke(app, [name, "--help"]).output
    assert "--help" in text
    assert "<bool>" not in text
    command = _loaded(name)
    helps = [command.help or "", *(getattr(p, "help", None) or "" for p in command.params)]
    shown = set(re.sub("│", " ", text).split())
    assert not {word for sentence in helps for word in sentence.split()} - shown


@pytest.mark.parametrize("name", NAMES)
def test_every_option_has_a_help_and_a_flag_none_that_denies_it(name):
    command = _loaded(name)
    options = [p for p in command.params if p.name != "help"]
    assert [p.name for p in options if not p.help] == []
    assert [p.name for p in options if p.secondary_opts] == []
    assert not re.search(r"^\w+: ", command.help, flags=re.M)


def test_help_of_all_commands_shows_no_type_beside_a_flag():
    text = CliRunner(env={"COLUMNS": "400"}).invoke(app, ["--help"]).output
    assert "--version" in text
    assert "<bool>" not in text


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("plot or", ["orbit"]),
        ("run-down --preset pap", ["paper", "paper-adaptive"]),
        ("run-up --set bearing[1].cl", ["bearing[1].clearance="]),
        ("example dro", ["drop"]),
    ],
)
def test_the_shell_completes_kinds_presets_names_and_examples(words, expected):
    given = {
        "_ROTOR_FMU_COMPLETE": "complete_bash",
        "COMP_WORDS": f"rotor-fmu {words}",
        "COMP_CWORD": str(len(words.split())),
    }
    result = CliRunner().invoke(app, [], prog_name="rotor-fmu", env=given)
    assert result.output.split() == expected


def test_what_holds_arrays_is_a_line_in_a_console():
    result = rf.simulate(rf.load(), speed=185.0, stop=0.3)
    turns = synchronous(result.t, result["phi"], result["disc[3].x"])
    for shown in (result, result.points, result.recording, result.orbit(turns=2), turns):
        assert "\n" not in repr(shown)
        assert len(repr(shown)) < 300
    assert f"t: {len(np.asarray(result.t))} numbers" in repr(result.recording)
