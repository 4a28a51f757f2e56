"""The page and the schema of machine files say what the reader takes."""

import io
import json
import os
import runpy
import shutil
import tomllib
from pathlib import Path

import jsonschema
import pytest
from matplotlib.text import Text
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.quantities import QuantityError

import rotor_fmu as rf
from rotor_fmu.errors import InputError
from rotor_fmu.machine_file.declared_tables import own_tables, part_tables
from rotor_fmu.machine_file.loading import machine_text
from rotor_fmu.machine_file.schema import schema
from rotor_fmu.plotting.machine_drawing import machine_figure

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
MACHINES = [
    path
    for path in (*ROOT.glob("examples/*/*.toml"), *ROOT.glob("model/machine/rigs/*.toml"))
    if {"shaft", "extends"} & tomllib.loads(path.read_text(encoding="utf-8")).keys()
]
VALIDATOR = jsonschema.Draft202012Validator(schema())


def test_the_schema_is_one_and_is_json():
    of_schemas = jsonschema.Draft202012Validator(jsonschema.Draft202012Validator.META_SCHEMA)
    assert [*of_schemas.iter_errors(json.loads(json.dumps(schema())))] == []


@pytest.mark.parametrize("machine", MACHINES, ids=lambda path: path.stem)
def test_every_machine_of_the_project_fits_the_schema(machine):
    content = tomllib.loads(machine.read_text(encoding="utf-8"))
    assert [error.message for error in VALIDATOR.iter_errors(content)] == []


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("clearance = 50e-6", "clearance = -50e-6"),
        ("clearance = 50e-6", 'clearance = "wide"'),
        ("clearance = 50e-6", "clearence = 50e-6"),
        ("e = 80e-6", "e = -80e-6"),
        ("node = 8\n", ""),
        ("[coupling]", "[cuppling]"),
    ],
)
def test_what_the_schema_refuses_the_reader_refuses_too(before, after):
    text = rig_toml()
    assert before in text
    changed = text.replace(before, after, 1)
    assert not VALIDATOR.is_valid(tomllib.loads(changed))
    with pytest.raises(QuantityError):
        parse_rotor(changed)


def test_every_key_of_the_page_is_known_to_the_reader():
    """The reader names what it knows when it meets what it does not."""
    for table in (*own_tables(), *part_tables()):
        if table.name in ("", "material", "section"):
            continue
        odd = f"[[{table.name}]]\nodd = 1\n" if table.is_list else f"[{table.name}]\nodd = 1\n"
        text = rig_toml()
        if table.name == "shaft":
            text = text.replace("[shaft]\n", "[shaft]\nodd = 1\n")
        elif not table.is_list and f"[{table.name}]" in text:
            text = text.replace(f"[{table.name}]", f"[{table.name}]\nodd = 1")
        else:
            # in the place of the tables of this kind that the rig has
            text = text.replace(f"[[{table.name}]]\n", f"[[{table.name}]]\nodd = 1\n", 1)
            if odd.strip() not in text:
                text += "\n" + odd
        with pytest.raises(QuantityError, match="odd: unknown key") as refused:
            parse_rotor(text)
        known = set(str(refused.value).split("known are ")[1].split(", ")) - {""}
        mine = {key.name for key in table.keys} - {"z"}
        assert known == mine, table.name


@pytest.fixture
def output(process):
    """Status of `rotor-fmu example`, and what it prints or, refused, says."""

    def tell(*arguments):
        done = process("example", *arguments)
        return done.returncode, done.stdout, done.stderr

    return tell


def test_every_example_is_listed_printed_and_copied(output, tmp_path):
    _, listed, _ = output()
    names = [line.split()[0] for line in listed.splitlines()]
    assert {"drive_train", "drop", "from_ross", "jeffcott_rub"} <= set(names)
    assert parse_rotor(output("jeffcott_rub")[1]).name
    for name in names:
        assert output(name, "--out", "mine")[0] == 0
        copied = {path.name for path in (tmp_path / "mine" / name).iterdir()}
        own = {path.name for path in (EXAMPLES / name).iterdir()} - {"__pycache__"}
        assert copied == own
        status, printed, said = output(name)
        if status:
            assert "has no machine file" in said
        else:  # by itself, without the files that it extends in its folder
            assert rf.parse(printed).name


def test_the_script_of_the_copied_response_example_reads_its_machine(tmp_path, monkeypatch):
    """That of another example, which is not beside the copy."""

    class ReadError(Exception):
        pass

    def response(machine, **_):
        raise ReadError(machine.name)

    copy = shutil.copytree(EXAMPLES / "response", tmp_path / "response")
    monkeypatch.setattr(rf, "response", response)
    with pytest.raises(ReadError, match="Jeffcott"):
        runpy.run_path(str(copy / "response_curves.py"))["draw"](tmp_path)


def test_an_example_is_never_copied_over_something(output, tmp_path):
    (tmp_path / "drop").mkdir()
    status, _, said = output("drop", "--out", ".")
    assert (status, said) == (2, "rotor-fmu: --out .: drop is there already\n")


def test_an_unknown_example_is_told_its_neighbour(output):
    status, _, said = output("jefcott")
    assert status == 2
    assert said.endswith("did you mean jeffcott_rub?\n")


POSIX = pytest.mark.skipif(os.name != "posix", reason="devices and named pipes are POSIX")


@pytest.mark.parametrize(
    ("base", "why"),
    [
        pytest.param("/dev/zero", "is not a file", marks=POSIX),
        pytest.param("pipe", "is not a file", marks=POSIX),
        (".", "is a folder"),
        ("missing.toml", "No such file"),
        ("a\\u0000b", "must be the name of a file"),
        ("large", "must have at most"),
    ],
)
def test_what_is_extended_is_a_file_that_a_machine_may_fill(tmp_path, base, why):
    if base == "pipe":
        os.mkfifo(tmp_path / "pipe")
    with (tmp_path / "large").open("wb") as file:
        file.truncate(10**9)
    path = tmp_path / "machine.toml"
    path.write_text(f'extends = "{base}"\n')
    with pytest.raises(InputError, match=why) as error:
        machine_text("--rotor", path)
    assert "\0" not in str(error.value)


def test_a_mark_of_utf_8_before_the_text_is_no_part_of_it(tmp_path):
    file = tmp_path / "machine.toml"
    file.write_text(rig_toml(), encoding="utf-8-sig")
    assert rf.load(file).rotor == rf.load().rotor


def test_a_path_with_a_nul_is_refused_in_one_sentence():
    with pytest.raises(InputError, match=r"cannot be read: .*embedded null"):
        rf.load("a\0b.toml")


@pytest.mark.usefixtures("drawn")
def test_a_name_is_drawn_as_it_is_written_not_as_a_formula():
    machine = rf.parse(rig_toml().replace('name = "zigulic2003"', 'name = "a $\\\\frac{$ b"'))
    assert machine.rotor.name == r"a $\frac{$ b"
    figure = machine_figure(machine.rotor)
    figure.savefig(io.BytesIO(), format="svg")
    assert machine.rotor.name in {text.get_text() for text in figure.findobj(Text)}


@pytest.mark.parametrize("machine", MACHINES, ids=lambda path: path.stem)
def test_the_names_in_a_drawing_cover_neither_each_other_nor_what_is_drawn(machine):
    """Of the rub of a Jeffcott rotor too, whose stator is wider than all else."""
    figure = machine_figure(rf.load(machine).rotor)
    figure.draw_without_rendering()
    axes = figure.axes[0]
    boxes = [Text.get_window_extent(text) for text in axes.texts]
    drawn = [patch.get_window_extent() for patch in axes.patches]
    assert not any(box.count_overlaps([*boxes[:i], *drawn]) for i, box in enumerate(boxes))
