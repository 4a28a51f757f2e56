"""Answers say where a steady response is no small motion in the oil films that are linearized."""

import math
from dataclasses import dataclass, fields, replace

import pytest
from rotor_fmu.model.linear import unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.base import InterfaceElement
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper

from rotor_fmu.linear.where_linearized import where_films_are_left
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.machine_report.report_page import ReportOptions, machine_report

from ..known import EXAMPLES
from ..toml_text import table

FILM = {"journal_radius": 0.05, "length": 0.01, "clearance": 2e-4, "viscosity": 0.004}


def ringed(e):
    """A rotor in stiff bearings, one of them in a ring on a cage, with a damper between the ring
    and a pedestal: the damper's motion is that of the ring less that of the pedestal."""
    text = "gravity = 0.0\n" + table("material", young=2.1e11, density=7850.0)
    text += table("shaft", nodes=[0.0, 0.1, 0.2], diameters=[0.08, 0.08])
    text += table("[disc]", node=2, diameter=0.2, width=0.03, e=e)
    for name, k in (("ring", 3e5), ("pedestal", 3e4)):
        text += table("[housing]", name=name, mass=1.0, kx=k, ky=k, cx=50.0, cy=50.0)
    stiff = {"kxx": 1e9, "kyy": 1e9, "cxx": 0.0, "cyy": 0.0}
    text += table("[linear_bearing]", node=1, housing="ring", **stiff)
    text += table("[linear_bearing]", node=3, **stiff)
    film = table("[squeeze_film_damper]", node=1, ring="ring", housing="pedestal", **FILM, k=1e8)
    return parse_rotor(text + film)


def test_the_motion_in_a_film_is_that_of_its_ring_against_its_housing():
    response = unbalance_response(ringed(1e-4), [200.0, 300.0, 400.0])
    moved = abs(response.housing_x[:, 0] - response.housing_x[:, 1])
    share, speed = max(zip(moved / FILM["clearance"], (200.0, 300.0, 400.0), strict=True))
    assert share > 0.5
    (said,) = where_films_are_left(ringed(1e-4), response)
    hz = speed / (2 * math.pi)
    assert f"oil films: squeeze_film_damper[1] {100 * share:.3g} % at {hz:.5g} Hz;" in said
    smaller = unbalance_response(ringed(0.45e-4 / share), [speed])
    assert where_films_are_left(ringed(0.45e-4 / share), smaller) == []


@dataclass(frozen=True, kw_only=True)
class Fixed(SqueezeFilmDamper):
    """A kind of damper that stands in one place: it declares ring and housing in its element."""

    def elements(self, where, density):
        yield InterfaceElement(self.node, self.LAWS[0], self, "pedestal", "ring")


def test_ring_and_housing_are_those_of_the_element_that_a_part_declares():
    rotor = ringed(1e-4)
    *others, damper = rotor.parts
    assert (damper.ring, damper.housing) == ("ring", "pedestal")
    same = {of.name: getattr(damper, of.name) for of in fields(damper)}
    fixed = replace(rotor, parts=(*others, Fixed(**same | {"ring": "", "housing": ""})))
    response = unbalance_response(rotor, [200.0, 300.0, 400.0])
    assert where_films_are_left(fixed, response) == where_films_are_left(rotor, response)


FILE = EXAMPLES / "squeeze_film" / "rotor.toml"
SAID = "squeeze_film_damper[1] 637 % at 39.7"


@pytest.mark.usefixtures("without_peaks")
def test_the_command_says_so(command):
    """The linear response of the example is six times the clearance of its dampers."""
    assert SAID in command("unbalance", "--rotor", str(FILE), "--speed", "250")


@pytest.mark.usefixtures("conclusions_alone", "without_runs")
def test_a_report_concludes_so():
    first = machine_report(load_rotor(FILE)[1], ReportOptions(400.0, 450.0)).conclusions[0]
    assert SAID in first.text
    assert not first.is_met
