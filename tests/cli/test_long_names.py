"""The names of a machine and of its parts, however long, lie within the pictures."""

import numpy as np
import pytest
from matplotlib.text import Text

import rotor_fmu as rf
from rotor_fmu.balancing.result import Balancing, Vibration
from rotor_fmu.linear.displayed import of_machine
from rotor_fmu.linear.mode_answers import mode_shapes_figure
from rotor_fmu.plotting import figure_style
from rotor_fmu.run_pictures.run_folder import distance_from_start
from rotor_fmu.run_pictures.signal_plots import KINDS

from ..known import EXAMPLES
from ..toml_text import table

MACHINE = "Boiler feed pump 7 of the second unit at Brunsbuettel after its overhaul in 2019"
# the longest that a machine file may give
DISC = "impeller_with_a_name_of_64_characters_which_is_all_that_may_be__"
CONTACT = "wear_ring_with_a_name_of_64_characters_which_is_all_that_may_be"  # and one for a number


def balancing(machine):
    """The picture of a balancing at two speeds."""
    seen = tuple(Vibration(2, "x", speed, 1e-6, 0.0, 0.0) for speed in (30.0, 300.0))
    numbers = {"influence": np.zeros((2, 1)), "rank": 1, "touches": False, "settles": True}
    found = Balancing((), seen, (), service_speed=300.0, messages=(), **numbers)
    return of_machine(found, machine.rotor).figure()


# pictures are laid out
pytestmark = pytest.mark.usefixtures("drawn")


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
    figure's legend or another one."""
    with figure_style.placed(figure):  # as where a picture is saved
        figure.draw_without_rendering()
    named = [
        (text.get_text(), text.get_window_extent())
        for text in figure.findobj(Text)
        if any(name in " ".join(text.get_text().split()) for name in (MACHINE, DISC, CONTACT))
    ]
    assert named
    legends = [legend.get_window_extent() for legend in figure.legends]
    low, high = figure.bbox.min - 1, figure.bbox.max + 1
    return [
        words
        for words, box in named
        if (box.min < low).any()
        or (box.max > high).any()
        or box.count_overlaps(legends)
        or box.count_overlaps([other for _, other in named]) > 1
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_names_lie_within_the_pictures_of_a_run(kind, run):
    assert cut_off(run.plot(kind)) == []


def test_names_lie_within_the_picture_of_a_distance(run):
    assert cut_off(distance_from_start(run.points, DISC, "x", MACHINE)) == []


@pytest.mark.parametrize(
    "figure",
    [
        lambda machine: machine.show(),
        lambda machine: machine.static().figure(),
        lambda machine: machine.modes(100.0).figure(),
        lambda machine: mode_shapes_figure(machine.modes(100.0)),
        lambda machine: machine.campbell((1.0, 400.0)).figure(),
        lambda machine: machine.unbalance_response((1.0, 400.0)).figure(),
        lambda machine: rf.response(machine, speed=(60.0, 90.0), step=3.0).figure(),
        balancing,
    ],
    ids=["show", "static", "modes", "modes_3d", "campbell", "unbalance", "response", "balancing"],
)
def test_names_lie_within_the_pictures_of_a_machine(figure, machine):
    assert cut_off(figure(machine)) == []


def test_a_name_with_dollar_signs_lies_within_a_picture(machine):
    """Which Matplotlib would measure as a formula."""
    dollars = rf.parse(machine.toml.replace(MACHINE, f"{MACHINE} of $x_1$"))
    assert cut_off(dollars.static().figure()) == []


def test_names_of_bearings_lie_within_a_critical_speed_map():
    """Of four with the longest names."""
    text = table("material", young=2.1e11, density=7800.0)
    text += table("shaft", nodes=[0.0, 0.2, 0.4, 0.6], diameters=[0.03] * 3)
    for node in range(1, 5):
        k = {"kxx": 1e6, "kyy": 1e6, "cxx": 0.0, "cyy": 0.0}
        text += table("[linear_bearing]", node=node, name=f"{CONTACT}{node}", **k)
    figure = rf.parse(text).critical_map([1e5, 1e7]).figure()
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert legend.texts[0].get_text().count(CONTACT) == 4
    assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
