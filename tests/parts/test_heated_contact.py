"""Bows of the shaft by the heat of a rub: ledger, shape, what they have to be equal to."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.heated_contact import HEATED_CONTACT, HeatedContact
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.quantities import quantities
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import CouplingOptions, Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.bow import bow_shape

import rotor_fmu as rf
from rotor_fmu.errors import InputError

from ..toml_text import refusal_of
from .heated import SPEED, bow, run

# A disc on a flexible shaft that rubs in a hard ring beside it, under gravity.
_RUBBING = """
[material]
young = 2.1e11
density = 7850.0
[shaft]
nodes = [0.0, 0.15, 0.3, 0.4, 0.6]
diameters = [0.03, 0.03, 0.025, 0.025]
eta_v = 1e-5
[[disc]]
node = 3
diameter = 0.25
width = 0.04
e = 5e-5
[[linear_bearing]]
node = 1
kxx = 2e7
kyy = 1e7
cxx = 2000.0
cyy = 2000.0
[[linear_bearing]]
node = 5
kxx = 2e7
kyy = 1e7
cxx = 2000.0
cyy = 2000.0
"""
_RING = """
node = 4
journal_radius = 0.02
clearance = 1e-4
mu = 0.1
k = 2e6
c = 200.0
"""
_HEATED = f"[[heated_contact]]{_RING}bow_per_heat = {{p}}\nbow_decay = {{q}}\n"
_SECOND = "[[heated_contact]]" + _RING.replace("node = 4", "node = 2") + "bow_per_heat = 2e-7\n"
_HOT = _RUBBING + _HEATED.format(p=1e-6, q=2.0)
_TWICE = _HOT + _SECOND + "bow_decay = 1.0\n"


@pytest.mark.parametrize("more", ["", "k_t = 1e6\n"])
def test_without_heat_it_is_a_contact_bit_for_bit(more):
    heated = run(_RUBBING + _HEATED.format(p=0.0, q=0.5) + more, 0.5)
    plain = run(f"{_RUBBING}[[contact]]{_RING}{more}", 0.5)
    assert plain.read("energy.friction_loss") > 0.1
    assert (heated.motion.q == plain.motion.q).all()
    assert (heated.motion.v == plain.motion.v).all()
    same = [name for name in plain.names if name in heated.names]
    assert len(same) > 40
    assert [heated.read(n) for n in same] == [plain.read(n) for n in same]
    assert heated.read("heated_contact[1].bow") == heated.read("energy.bow_loss") == 0.0


def test_the_heat_is_what_friction_loses_and_bows_towards_the_point_of_contact():
    """A journal pressed down in a ring turns a hot spot past it: one side after another; stuck to
    the rotor, by a whirl at its speed, the same side is heated. The bow is p times the heat."""
    p = 1e-9
    sim = run(_RUBBING + _HEATED.format(p=p, q=0.0), 0.3)
    assert sim.read("energy.friction_loss") > 1.0
    before, lost = bow(sim), sim.read("energy.friction_loss")
    # a thousandth of a turn, in which the contact moves on the rotor by no more than that
    duration = 1e-3 * 2.0 * math.pi / SPEED
    assert sim.read("heated_contact[1].contact") == 1.0
    seen = sim.read("heated_contact[1].psi") - sim.read("phi")
    sim.advance(0.3 + duration, SPEED)
    heat = sim.read("energy.friction_loss") - lost
    assert heat > 0.0
    assert bow(sim) - before == pytest.approx(cmath.rect(p * heat, seen), rel=0.02)
    assert sim.read("heated_contact[1].heat") * duration == pytest.approx(heat, rel=0.1)


def test_a_shaft_that_turns_slowly_lies_in_its_bow():
    """The bow is that of the node from the line through the ends, on which bearings leave them; the
    shaft is straight on either side."""
    sensors = "".join(f"[[sensor]]\nnode = {n}\n" for n in range(1, 6))
    text = _RUBBING.replace("e = 5e-5", "e = 0.0").replace("diameter = 0.25", "diameter = 0.05")
    text = "gravity = 0.0\n" + text + _HEATED.format(p=0.0, q=0.0) + sensors
    sim = run(text, 0.0, 0.5, choose(method="radau5"))
    sim.motion.internal_state[1:3] = 3e-5, 4e-5
    sim.advance(30.0, 0.5)
    seen = [complex(*(sim.read(f"sensor[{n}].{a}") for a in "xy")) for n in range(1, 6)]
    turned = cmath.rect(5e-5, math.atan2(4.0, 3.0) + sim.read("phi"))
    shape = bow_shape(np.array([0.0, 0.15, 0.3, 0.4, 0.6]), 4)[::2]
    assert shape[[0, 3, 4]] == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
    assert shape[2] - shape[1] == pytest.approx(shape[1])
    assert np.array(seen) == pytest.approx(turned * shape, rel=1e-4, abs=1e-9)


def test_the_pull_towards_a_bow_is_a_pair_of_moments():
    """The shaft's own forces of an even bend of a cylinder: E I over a radius, at its ends."""
    structure = assemble(parse_rotor(_HOT.replace("0.025, 0.025", "0.03, 0.03")))
    forces = structure.bow_forces[0]
    stiffness = 2.1e11 * math.pi / 64 * 0.03**4
    expected = np.zeros(10)
    expected[5], expected[9] = 1.0, -1.0
    assert forces[::2] == pytest.approx(np.zeros(5), abs=1e-6 * abs(forces).max())
    assert forces / forces[5] == pytest.approx(expected, abs=1e-9)
    shape = bow_shape(np.array([0.0, 0.15, 0.3, 0.4, 0.6]), 4)
    bend = (shape[5] - shape[9]) / 0.3
    assert forces[5] == pytest.approx(stiffness * bend, rel=1e-9)
    assert structure.bow_stiffness[0, 0] == pytest.approx(stiffness * bend**2 * 0.3, rel=1e-9)


@pytest.mark.parametrize("text", [_HOT, _TWICE], ids=["one", "two"])
@pytest.mark.parametrize("settings", [{"tolerance": 1e-4}, {"method": "radau5"}], ids=str)
@pytest.mark.parametrize("drive", [{}, {"drive_torque": 3.0}], ids=["speed", "torque"])
def test_the_ledger_closes(text, settings, drive):
    """Within a hundredth of the bow's own entry, which is itself more than 1e-5 of all losses."""
    sim = run(text, 1.0, settings=choose(**settings), **drive)
    lost = sum(sim.read(n) for n in sim.names if n.endswith("_loss"))
    worked = abs(sim.read("energy.bow_loss"))
    assert worked > 1e-5 * lost
    assert abs(sim.read("energy.residual")) < min(1e-4 * lost, 1e-2 * worked)


@pytest.mark.parametrize("drive", [{}, {"drive_torque": 0.5}], ids=["speed", "torque"])
def test_what_the_ledger_lacks_falls_with_the_step(drive):
    """Of two bows that cool down without any rub."""
    text = _TWICE.replace("clearance = 1e-4", "clearance = 1.0")
    given = drive.get("drive_torque", SPEED)

    def lacks(h):
        sim = Simulation(parse_rotor(text), choose("robust", h=h), speed=SPEED, **drive)
        sim.motion.internal_state[:] = 0.0, 1e-4, 0.0, 0.0, 3e-5, 5e-5
        sim.advance(0.5, given)  # what the jump to these bows has set in motion is gone
        first = sim.observed.copy()
        sim.advance(1.0, given)
        change = dict(zip(sim.names, sim.observed - first, strict=True))
        assert abs(change["energy.bow_loss"]) > 1e-4
        return change["energy.residual"] / change["energy.bow_loss"]

    coarse, fine = abs(lacks(2e-4)), abs(lacks(1e-4))
    assert coarse > 4.0 * fine
    assert fine < 5e-3


def test_a_snapshot_has_the_bow():
    sim = run(_HOT, 0.5)
    state = sim.snapshot()
    ends = []
    for _ in range(2):
        sim.advance(0.7, SPEED)
        ends.append(sim.observed.copy())
        sim.restore(state)
    assert (ends[0] == ends[1]).all()
    other = Simulation(parse_rotor(_HOT), choose(), speed=SPEED, warn=lambda _: None)
    other.restore(state.tobytes())
    other.advance(0.7, SPEED)
    assert (other.observed == ends[0]).all()
    assert bow(other) != 0.0


def test_all_component_modes_bow_as_the_shaft_does():
    whole, reduced = (run(_HOT, 0.2, settings=choose("robust", reduction=n)) for n in (0, 50))
    assert len(reduced.structure.M) == len(whole.structure.M)
    assert bow(reduced) == pytest.approx(bow(whole), rel=1e-6)
    assert reduced.read("disc[1].x") == pytest.approx(whole.read("disc[1].x"), rel=1e-6)


_PART = HEATED_CONTACT.kind(
    journal_radius=0.02, clearance=1e-4, mu=0.1, k=2e6, k_t=1e6, bow_per_heat=1e-6, bow_decay=3.0
)


def test_the_states_meet_their_equations_at_the_end_of_a_step():
    record = np.array(
        [tuple(float(getattr(_PART, name)) for name in quantities(HEATED_CONTACT.kind))],
        HEATED_CONTACT.dtype,
    ).view(np.recarray)[0]
    tangent, rates = interpreted(HEATED_CONTACT.tangent), interpreted(HEATED_CONTACT.rates)
    rng, none = np.random.default_rng(3), np.zeros(0)
    for depth in (3e-6, 3e-6, 3e-6, -1e-6):
        d = cmath.rect(1e-4 + depth, rng.uniform(0, 6))
        v = complex(*rng.normal(0, 1e-3, 2))
        here = Kinematics(d, v, 90.0, 90.0, rng.uniform(0, 1e4))
        free = rng.normal(0, 1.0, 3) * [1e-8 * (depth > 0), 1e-5, 1e-5]
        state, rate = np.zeros(3), np.zeros(3)
        tangent(record, none, here, Weights(1.0, 1.0, 0.02), free, state)
        rates(record, none, here, state, rate)
        assert state == pytest.approx(free + 0.02 * rate, rel=1e-9, abs=1e-15)
        out = np.zeros(len(HEATED_CONTACT.outputs))
        interpreted(HEATED_CONTACT.observe)(record, none, here, state, out)
        heating = complex(*rate[1:]) + 3.0 * complex(*state[1:])
        heat = out[[o.name for o in HEATED_CONTACT.outputs].index("heat")]
        assert heat > 0.0 if depth > 0 else heat == 0.0
        assert heating == pytest.approx(
            1e-6 * heat * d / abs(d) * cmath.exp(-1j * here.angle), rel=1e-9, abs=1e-18
        )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("bow_per_heat = 1e-06", "bow_per_heat = -1e-6"), "bow_per_heat = -1e-06 m/J: must be >="),
        (("bow_decay = 2.0", "bow_decay = -2.0"), "bow_decay = -2 1/s: must be >= 0 and finite"),
        (("bow_decay = 2.0", "bow_decay = nan"), "bow_decay = nan 1/s: must be >= 0 and finite"),
        (("bow_decay = 2.0", ""), "bow_decay"),
        (("bow_decay", "bow_decai"), "bow_decay"),
        (("heated_contact", "heated_contakt"), "heated_contact"),
        (
            ("node = 4", "node = 5"),
            "node = 5: must be between nodes 1 and 5, the ends of the shaft",
        ),
        (
            ("node = 4", "node = 1"),
            "node = 1: must be between nodes 1 and 5, the ends of the shaft",
        ),
    ],
)
def test_what_cannot_be_is_said_in_a_line(change, words):
    assert change[0] in _HOT
    assert words in refusal_of(_HOT.replace(*change))


def test_its_numbers_take_units():
    text = _HOT.replace("1e-06", '"1 um/J"').replace("bow_decay = 2.0", 'bow_decay = "120 1/min"')
    part = rf.parse(text).rotor.of_kind(HeatedContact)[0]
    assert part.bow_per_heat == pytest.approx(1e-6, rel=1e-12)
    assert part.bow_decay == pytest.approx(2.0, rel=1e-12)


def test_linear_answers_are_those_of_a_contact():
    plain, heated = parse_rotor(f"{_RUBBING}[[contact]]{_RING}"), parse_rotor(_HOT)
    assert (modes(heated, 50.0).eigenvalues == modes(plain, 50.0).eigenvalues).all()


def test_a_periodic_motion_is_refused():
    with pytest.raises(InputError, match=r"^heated_contact\[1\]: its thermal bow is slower"):
        rf.response(rf.parse(_HOT), speed=(50.0, 120.0))


def test_sensitivities_see_the_bow():
    """Of the displacement over a step in which a large bow turns on, by the speed."""
    options = CouplingOptions(has_sensitivities=True)
    sim = Simulation(
        parse_rotor(_HOT.replace("clearance = 1e-4", "clearance = 1.0")),
        *(choose("robust"),),
        speed=SPEED,
        coupling=options,
    )
    sim.motion.internal_state[1:3] = 1e-3, 2e-4
    sim.advance(0.01, SPEED)
    start, at = sim.snapshot(), sim.names.index("disc[1].x")

    def end(speed):
        sim.restore(start)
        sim.advance(0.012, speed)
        return sim.observed[at]

    expected = (end(SPEED + 0.01) - end(SPEED - 0.01)) / 0.02
    end(SPEED)
    assert sim.sensitivities(0)[at] == pytest.approx(expected, rel=1e-4)
