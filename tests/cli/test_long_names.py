"""The names of a machine and of its parts, however long, lie within the pictures."""

import pytest
from matplotlib.text import Text

import rotor_fmu as rf
from rotor_fmu.linear.mode_answers import mode_shapes_figure
from rotor_fmu.run_pictures.signal_plots import KINDS

from ..known import EXAMPLES

MACHINE = "Boiler feed pump 7 of the second unit at Brunsbuettel after its overhaul in 2019"
DISC = "impeller_with_a_name_of_forty_characters"
CONTACT = "wear_ring_with_a_name_of_40_characters_"


@pytest.fixture(scope="module")
def machine():
    text = rf.load(EXAMPLES / "jeffcott_rub" / "jeffcott.toml").toml
    for old, new in (("Jeffcott rotor that rubs", MACHINE), ('"disc"', f'"{DISC}"')):
        text = text.replace(old, new)
    return rf.parse(text.replace("[[contact]]", f'[[contact]]\nname = "{CONTACT}"'))


@pytest.fixture(scope="module")
def run(machine):
    return rf.simulate(machine, speed=([0, 3], [200, 60]), tolerance=1e-2)


def cut_off(figure):
    """The texts that name the machine or a part and are not all within the picture, or beneath the
    figure's legend."""
    figure.draw_without_rendering()
    named = [
        (text.get_text(), text.get_window_extent())
        for text in figure.findobj(Text)
        if any(name in text.get_text() for name in (MACHINE, DISC, CONTACT))
    ]
    assert named
    legends = [legend.get_window_extent() for legend in figure.legends]
    low, high = figure.bbox.min - 1, figure.bbox.max + 1
    return [
        words
        for words, box in named
        if (box.min < low).any() or (box.max > high).any() or box.count_overlaps(legends)
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_names_lie_within_the_pictures_of_a_run(kind, run):
    assert cut_off(run.plot(kind)) == []


@pytest.mark.parametrize(
    "figure",
    [
        lambda machine: machine.show(),
        lambda machine: machine.static().figure(),
        lambda machine: machine.modes(100.0).figure(),
        lambda machine: mode_shapes_figure(machine.modes(100.0)),
        lambda machine: machine.campbell((1.0, 400.0)).figure(),
        lambda machine: machine.unbalance_response((1.0, 400.0)).figure(),
        lambda machine: rf.response(machine, speed=(60.0, 90.0)).figure(),
    ],
    ids=["show", "static", "modes", "modes_3d", "campbell", "unbalance", "response"],
)
def test_names_lie_within_the_pictures_of_a_machine(figure, machine):
    assert cut_off(figure(machine)) == []
