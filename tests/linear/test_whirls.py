"""Growing whirls: found where closed forms have them, named where the steps hide them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.linear.modes import modes as modes_of_machine
from rotor_fmu.model.linear.modes import modes_of
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.settings import PRESETS, choose
from rotor_fmu.model.simulation import Simulation, StepFailure
from rotor_fmu.model.stability import resolution, survey_block

from benchmarks.growth import refined, with_bearings
from papers.integrators.members import chung_hulbert, hht, newmark

from ..growing_whirls import found_last
from ..known import EXAMPLES
from ..machines import jeffcott, jeffcott_stiffness
from ..toml_text import table
from ..validation.whip import OVERHUNG, overhung_machine, run_down
from ..validation.windows import rig
from .test_subsynchronous import on_pads

resolving_step, seen_growth = (
    interpreted(resolution.resolving_step),
    interpreted(resolution.seen_growth),
)
README = EXAMPLES.parent / "README.md"
SPEED, CLEARANCE = 400.0, 1e-4
ZETA, BETA = 0.05, 20.0
MASS = 7800.0 * math.pi / 4 * 0.3**2 * 0.05  # of the Jeffcott rotor's disc [kg]


def rubbing_jeffcott(ratio):
    """Jeffcott's rotor in a stator of stiffness beta k, mu being `ratio` times that from which it
    may whip, mu_c = 2 zeta sqrt(1 + beta) / beta (Black 1968)."""
    k = jeffcott_stiffness()
    mu_c = 2 * ZETA * math.sqrt(1 + BETA) / BETA
    stator = ClearanceContact(
        node=2, journal_radius=0.5, clearance=CLEARANCE, k=BETA * k, mu=ratio * mu_c, c=0.0
    )
    rotor = jeffcott(damping=2 * ZETA * math.sqrt(k * MASS))
    return rotor.with_parts(ClearanceContact, stator)


def whirls(rotor, settings=PRESETS["controlled"], speed=SPEED):
    return found_last(Simulation(rotor, settings, speed=speed, warn=lambda message: None))


@pytest.mark.parametrize(("ratio", "is_growing"), [(0.97, False), (1.03, True), (1.15, True)])
def test_a_jeffcott_rotor_may_whip_above_blacks_coefficient_of_friction(ratio, is_growing):
    result = whirls(rubbing_jeffcott(ratio))
    assert bool(result) == is_growing
    for whirl in result:
        k = jeffcott_stiffness()
        frequency = math.sqrt((1 + BETA) * k / MASS)
        assert whirl.is_backward
        assert whirl.root.imag == pytest.approx(frequency, rel=0.03)  # the shaft has a mass too
        growth = ZETA * (ratio - 1) * math.sqrt(k / MASS)
        assert whirl.root.real == pytest.approx(growth, rel=0.5 if ratio < 1.1 else 0.15)


def test_against_the_rotation_means_the_same_for_a_shaft_that_turns_the_other_way():
    one, other = (whirls(rubbing_jeffcott(1.15), speed=speed) for speed in (SPEED, -SPEED))
    assert [w.is_backward for w in other] == [w.is_backward for w in one]
    np.testing.assert_allclose([w.root for w in other], [w.root for w in one], rtol=1e-9)


def test_of_many_bearings_each_alone_is_surveyed_by_fewer_dofs_and_has_the_same_whirls(monkeypatch):
    rotor = with_bearings(refined(rig(), 60), 14)
    rotor = rotor.with_parts(Bearing, *(replace(b, mu=0.6) for b in rotor.bearings))
    few = Simulation(rotor, speed=SPEED, warn=lambda message: None)
    monkeypatch.setattr(survey_block, "_PAYS", 0.0)
    all_of_them = Simulation(rotor, speed=SPEED, warn=lambda message: None)
    n, coarse = all_of_them._run.survey.basis.shape
    assert all_of_them._run.survey.single_contact_basis.shape[0] == 0
    assert few._run.survey.single_contact_basis.shape[:2] == (14, n)
    assert few._run.survey.single_contact_basis.shape[2] < 0.75 * coarse
    by_place = [
        {(w.closed, w.speed): w for w in reversed(found_last(sim))} for sim in (few, all_of_them)
    ]
    assert by_place[0].keys() == by_place[1].keys()
    assert sum(len(closed) == 1 for closed, _ in by_place[0]) >= 12
    for place, whirl in by_place[0].items():
        assert whirl.root == pytest.approx(by_place[1][place].root, rel=2e-4)
        assert whirl.is_backward == by_place[1][place].is_backward
    steps = [sim._run.memory.record[0].h_in_contact for sim in (few, all_of_them)]
    assert steps[0] == pytest.approx(steps[1], rel=1e-3)


def test_the_overhung_machine_has_the_root_that_an_eigenvalue_solver_finds():
    """11.37 + 7976i at 400 rad/s: dense matrices of the machine with F = -k (1 + i mu) d at the
    journal, written out and solved apart from this code."""
    result = [w for w in whirls(overhung_machine()) if w.speed == SPEED]
    assert result[0].root == pytest.approx(11.3704 + 7976.255j, rel=1e-5)
    assert result[0].is_backward
    assert whirls(overhung_machine(mu=0.02)) == ()


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("k_yy", "c_yy", "k_xy", "speed", "said"),
    [
        (2e6, 500.0, 0.0, 100.0, "a planar motion"),  # x alone grows
        (1e6, -200.0, 0.0, 1e-3, "a planar motion"),  # x and y alike: a circle either way, or none
        (1e6, -200.0, 0.0, 100.0, "a forward whirl"),  # gyroscopic moments tell them apart
        (1e6, 500.0, 1e6, 100.0, "a forward whirl"),
        (1e6, 500.0, -1e6, 100.0, "a backward whirl"),
    ],
)
def test_what_grows_has_the_sense_that_modes_give_it(k_yy, c_yy, k_xy, speed, said, way):
    speed, k_xy = way * speed, way * k_xy
    c_xx = c_yy if k_xy else -200.0
    bearing = {"kxx": 1e6, "kyy": k_yy, "cxx": c_xx, "cyy": c_yy, "kxy": k_xy, "kyx": -k_xy}
    text = table("material", young=2.1e11, density=7800.0)
    text += table("shaft", nodes=[0.0, 0.2, 0.4, 0.6], diameters=[0.03, 0.03, 0.03])
    text += table("[point_mass]", node=3, mass=5.0)
    text += "".join(table("[linear_bearing]", node=node, **bearing) for node in (1, 4))
    rotor = parse_rotor(text)
    messages = []
    simulation = Simulation(rotor, choose(), speed=speed, warn=messages.append)
    (unstable,) = (text for text in messages if text.code == "unstable")
    assert f"with no contacts {said} of " in unstable
    root = next(w.root for w in found_last(simulation) if w.speed == speed)
    found = modes_of_machine(rotor, speed, count=40)
    at = np.argmin(np.abs(found.eigenvalues - root))
    assert found.eigenvalues[at] == pytest.approx(root, rel=1e-4)
    assert found.whirl[at] in said
    if k_yy > 1e6:
        # at the frequency along the line, not the rate at which it happens to turn
        with pytest.raises(StepFailure, match=r"planar motion .* seen to move in a plane at"):
            simulation.advance(5.0, speed)


def test_a_whirl_either_way_along_the_shaft_says_which_way_it_is_as_a_whole():
    """A fan on an overhung shaft: the part that turns against the rotation is 1.7 times as large as
    the one that turns with it at the wheel, and smaller at a node between the bearings."""
    text = README.read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]
    rotor = parse_rotor(text).with_values({"bearing[1].clearance": 2e-4})
    messages = []
    whirl = found_last(Simulation(rotor, choose(), speed=300.0, warn=messages.append))[0]
    (unstable,) = (text for text in messages if text.code == "unstable")
    assert " a mixed whirl, mainly backward, of " in unstable
    assert whirl.is_backward


PADS = {
    "massless": {},
    "with inertia": {"pad_inertia": 1e-4},
    "on elastic pivots": {"pivot_stiffness": 2e8},
    "both": {"pad_inertia": 1e-4, "pivot_stiffness": 2e8},
}
TURBOCHARGER = EXAMPLES / "turbocharger" / "rotor.toml"
OWN_WHIRLS = {
    "rings, at the first threshold": (TURBOCHARGER.read_text(encoding="utf-8"), 500.0, 1),
    "rings": (TURBOCHARGER.read_text(encoding="utf-8"), 1e4, 3),
} | {f"pads, {name}": (on_pads(2e6, **kind), 1000.0, 1) for name, kind in PADS.items()}
# The upper pads bear so little that only the damping of their pivots says how fast these return.
IDLE = {"preload": 0.0, "pads": [math.radians(270 + 72 * i) for i in range(5)], "arc": 1.0}
OWN_WHIRLS["pads that hardly bear"] = (on_pads(0.0, pivot_stiffness=1e9, **IDLE), 50.0, 0)


# what has neither, and what has one, beside the pads that have both
SLOW = ("pads, massless", "pads, with inertia", "pads, on elastic pivots")


@pytest.mark.parametrize(
    "machine",
    [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in OWN_WHIRLS],
)
def test_rings_and_pads_follow_each_whirl_at_its_own_frequency(machine):
    """A run's own whirls are those of `modes`, which `test_campbell` has from dense matrices."""
    text, speed, count = OWN_WHIRLS[machine]
    rotor = parse_rotor(text)
    found = [w.root for w in whirls(rotor, speed=speed) if w.speed == speed]
    linear = LinearMachine(rotor)
    roots = modes_of(linear, linear.at(speed), 12, pads_whirl=True).eigenvalues
    growing = sorted(roots[roots.real > 0.0], key=lambda root: -root.real)
    assert len(growing) == count
    np.testing.assert_allclose(found, growing, rtol=1e-6)


@pytest.mark.parametrize("machine", ["rings", "pads, with inertia"])
def test_what_oil_films_alone_carry_is_not_looked_at_at_standstill(machine):
    """Where it turns is no equilibrium then; in the middle of its bearings, without weight, is."""
    text, speed, _ = OWN_WHIRLS[machine]
    for gravity in (9.81, 0.0):
        rotor = replace(parse_rotor(text), gravity=gravity)
        sim = Simulation(rotor, speed=speed, warn=lambda message: None)
        grows = sim._run.survey.rest[0].real > 0.0
        assert grows == (gravity == 0.0 and "seal" in text)


def test_a_pad_that_bears_nothing_does_not_make_a_machine_free():
    """Its tilt stays anywhere, but the pads hold the rotor with its wall open."""
    lying = table("[contact]", node=2, journal_radius=0.05, clearance=5e-6, k=1e7, mu=0.1)
    rotor = parse_rotor(on_pads(5e6, preload=0.0) + lying)
    sim = Simulation(rotor, speed=SPEED, warn=lambda message: None)
    assert any(sim._run.memory.seats)
    assert () in {w.closed for w in found_last(sim) if w.speed == SPEED}


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_the_rig_has_no_growing_whirl_and_no_preset_warns_of_one(preset):
    said = []
    sim = Simulation(rig(), PRESETS[preset], speed=SPEED, warn=said.append)
    assert found_last(sim) == ()
    assert said == []


def test_a_machine_that_starts_at_rest_is_looked_at_anew_when_it_turns():
    said = []
    rotor = overhung_machine(mu=0.02)
    sim = Simulation(rotor, choose("robust"), speed=0.0, warn=said.append)
    before = float(sim._surveyed_to[0])
    sim.advance(0.01, 0.0)
    sim.advance(0.02, 2 * before)
    assert sim._surveyed_to[0] > before


@pytest.mark.parametrize("scheme", [chung_hulbert(0.2), chung_hulbert(0.3), hht(0.3)])
def test_the_resolving_step_leaves_the_growth_its_share_and_one_a_little_longer_does_not(scheme):
    root = 11.4 + 7976j
    h = resolving_step(scheme, root, 0.9)
    assert seen_growth(scheme, h, root) == pytest.approx(0.9 * root.real, rel=1e-3)
    assert seen_growth(scheme, 1.1 * h, root) < 0.9 * root.real
    assert seen_growth(scheme, 5e-4, root) < 0.0


def test_newmark_hides_no_growth():
    assert seen_growth(newmark(), 5e-4, 11.4 + 7976j) > 0.0


@pytest.mark.parametrize("preset", ["robust", "moderate", "paper", "paper-adaptive"])
def test_steps_that_hide_a_whirl_are_named_before_the_run(preset):
    said = []
    Simulation(overhung_machine(), choose(preset), speed=SPEED, warn=said.append)
    assert len(said) == 1
    for part in ("bearing[1] in contact and slipping", "backward whirl of 1270 Hz", "at most"):
        assert part in said[0]


def test_the_step_that_the_warning_advises_finds_the_whirl():
    said = []
    Simulation(overhung_machine(), choose("robust"), speed=SPEED, warn=said.append)
    h = float(said[0].split("steps of at most ")[1].split(" s")[0])
    after = []
    with pytest.raises(StepFailure, match="diverged by an instability of the machine"):
        run_down(overhung_machine(), choose("robust", h=h), 5.0, after.append)
    assert after == []


def kicked(ratio, settings, share):
    """Growth of the whirl's radius over 60 cycles [1], begun at `share` of the separatrix's."""
    mu = ratio * 2 * ZETA * math.sqrt(1 + BETA) / BETA
    omega = ZETA / mu + math.sqrt(1 + (ZETA / mu) ** 2)
    radius = CLEARANCE * BETA / (BETA - 2 * ZETA * omega / mu) if ratio > 1 else 20 * CLEARANCE
    unit = math.sqrt(jeffcott_stiffness() / MASS)
    sim = Simulation(rubbing_jeffcott(ratio), settings, speed=SPEED, warn=lambda message: None)
    r = share * radius
    stiffness = 1 + BETA * (1 - CLEARANCE / r)
    sim.motion.q[2] = r
    sim.motion.v[2] = -1j * r * math.sqrt(stiffness) * unit
    seen = []
    for k in range(60):
        sim.advance((k + 1) * 2 * math.pi / (math.sqrt(stiffness) * unit), SPEED)
        seen.append(abs(sim.motion.q[2]))
    return np.mean(seen[-10:]) / np.mean(seen[:10])


def test_a_motion_that_its_loads_drive_apart_is_not_laid_to_a_whirl():
    """A partner's spring whose force comes a communication step late drives what it holds."""
    sim = Simulation(rubbing_jeffcott(1.15), speed=SPEED, warn=lambda message: None)
    assert found_last(sim)
    sim.motion.q[2] = CLEARANCE
    k = jeffcott_stiffness()
    h = 0.2 / math.sqrt(k / MASS)

    def couple():
        for step in range(1, 1001):
            sim.advance(step * h, SPEED, np.array([-5.0 * k * sim.motion.q[2]]))

    with pytest.raises(StepFailure, match=r"the solution diverged .* under its loads"):
        couple()


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_a_kicked_jeffcott_rotor_whips_above_the_separatrix_and_above_mu_c_alone(tolerance):
    settings = choose(tolerance=tolerance)
    assert kicked(0.97, settings, 1.0) < 1.0
    assert kicked(1.15, settings, 0.7) < 1.0 < kicked(1.15, settings, 1.5)
    assert kicked(1.03, settings, 0.5) < 1.0 < kicked(1.03, settings, 1.5)


def test_the_machine_of_the_examples_is_that_of_these_tests():
    assert OVERHUNG.is_file()


@pytest.mark.parametrize("wear_angle", [0.5 * math.pi, 1.1])
def test_whirls_along_a_worn_wall_do_not_depend_on_where_it_is_worn(wear_angle):
    rotor = rubbing_jeffcott(1.15)
    (stator,) = (part for part in rotor.parts if isinstance(part, ClearanceContact))
    one, other = (
        whirls(
            rotor.with_parts(
                ClearanceContact, replace(stator, wear=0.5 * CLEARANCE, wear_angle=angle)
            )
        )
        for angle in (0.0, wear_angle)
    )
    assert len(one) == len(other) > 0
    for a, b in zip(one, other, strict=True):
        assert a.root == pytest.approx(b.root, rel=1e-3)
