"""Rotors in oil films that move: threshold, limit cycle, touching; ledger and backends."""

import math

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.linear import modes
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation, StepFailure

from rotor_fmu.machine_file.loading import machine_text

from ..known import EXAMPLES
from ..toml_text import table
from .driven import of_both
from .films import DAMPER, OF_A_FILM, THRESHOLDS, film, heavy_shaft, in_films, run_of
from .machines import shaft


def _size(run, seconds, speed, rest):
    """The largest distance of the disc from its rest over some time [m]."""
    end, largest = run.time + seconds, 0.0
    while run.time < end:
        run.advance(run.time + 2e-4, speed)
        z = complex(run.read("body[1].x"), run.read("body[1].y"))
        largest = max(largest, abs(z - rest))
    return largest


def test_linear_threshold_is_bracketed_by_integration():
    rotor = in_films()
    threshold = bearing_curves(rotor, np.linspace(400.0, 1200.0, 5)).threshold
    assert modes(rotor, 0.99 * threshold).eigenvalues.real.max() < 0
    assert modes(rotor, 1.01 * threshold).eigenvalues.real.max() > 0
    for factor, grows in ((0.98, False), (1.02, True)):
        speed = factor * threshold
        at = bearing_curves(rotor, [speed])
        rest = complex(at.x[0], at.y[0])
        # half a per cent of the clearance off
        run = run_of(in_films(start=table("start", x=rest.real + 5e-7, y=rest.imag)), speed)
        run.advance(0.1, speed)
        before = _size(run, 0.05, speed, rest)
        run.advance(run.time + 0.5, speed)
        assert (_size(run, 0.05, speed, rest) > before) == grows


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "grows"), [(0.99, False), (1.01, True)])
@pytest.mark.parametrize(("e", "threshold", "_whirl"), THRESHOLDS[1:])
def test_the_fmu_brackets_the_thresholds_of_a_rigid_rotor_by_one_per_cent(
    machine_of, e, threshold, _whirl, factor, grows
):
    """Begun 1 % of the clearance off its rest, the whirl decays or grows, slowly at the largest
    eccentricity, near which no whirl grows any more. The viscosity is that at which the rotor rests
    at the eccentricity e at its threshold, and without an end where e vanishes."""
    clearance, rotor = OF_A_FILM["clearance"], heavy_shaft(young=2.1e13)
    at_threshold = threshold * math.sqrt(9.81 / clearance)
    thin = JournalBearing(node=1, length=0.03, short=True, **(OF_A_FILM | {"viscosity": 1.0}))
    carried = abs(BearingAlone(thin, at_threshold).force(e * clearance))
    load = 0.5 * 9.81 * (40.0 + 100.0 * math.pi / 4 * 0.1**2 * 0.2)
    oil = {"short": True, "viscosity": load / carried}
    text, speed = rotor + film(1, **oil) + film(3, **oil), factor * at_threshold
    at = bearing_curves(parse_rotor(text), [speed])
    start = table("start", x=at.x[0] + 1e-6, y=at.y[0])
    with machine_of(text + start).start(speed=speed, tolerance=1e-4) as run:
        sizes = []
        for end in (0.3, 1.8):  # of two windows of some whirls each
            run.advance(end)
            places = []
            for _ in range(250):
                run.advance(run.time + 2e-4)
                places.append(complex(*run.read("body[1].x", "body[1].y")))
            sizes.append(np.abs(places - np.mean(places)).max())
    assert (sizes[1] > 1.02 * sizes[0]) if grows else (sizes[1] < sizes[0] / 1.02)
    assert sizes[1] < 0.5e-4


def test_ledger_closes_through_a_threshold():
    rotor = in_films(e=2e-6)
    run = run_of(rotor, 400.0, 1e-3)
    run.advance(2.0, 400.0, rate=500.0)
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert run.read("energy.film_loss") > 0
    assert abs(run.read("energy.residual")) < 1e-4 * lost
    # past the threshold the journals whirl in most of their clearance
    assert (
        max(_size(run, 0.05, 1400.0, complex(run.read("body[1].x"), run.read("body[1].y"))), 0)
        > 5e-5
    )


def test_a_start_at_standstill_lies_on_its_wall_and_lifts_off():
    rotor = in_films(k=1e8)
    run = run_of(rotor, 0.0, 1e-2)
    assert run.read("journal_bearing[1].contact") == 1.0
    assert run.read("journal_bearing[1].film") < 1e-6
    run.advance(0.5, 0.0, rate=600.0)
    assert run.read("journal_bearing[1].contact") == 0.0
    assert run.read("energy.friction_loss") > 0
    lost = run.read("energy.film_loss") + run.read("energy.friction_loss")
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_fixed_steps_start_up_on_a_wall_behind_little_oil():
    """Its film is thinner than its roughness over a few elements only."""
    text = machine_text("--rotor", EXAMPLES / "oil_film" / "rotor.toml")
    for old, new in (("viscosity = 0.02", "viscosity = 0.0005"), ("k = 1e8", "k = 1e7")):
        text = text.replace(old, new)
    run = Simulation(parse_rotor(text), choose("robust"), rate=300.0, warn=lambda _: None)
    for i in range(25):
        run.advance(2e-3 * (i + 1), 0.6 * i, rate=300.0)
    assert run.read("solver.newton") < 10 * run.read("solver.steps")


def test_ledger_closes_through_a_threshold_and_a_rub():
    """So far out of balance that past the threshold the journals press through their films."""
    run = run_of(in_films(e=1e-3, k=1e8, roughness=1e-5), 400.0, 1e-3)
    touched = 0.0
    for i in range(20):
        run.advance(0.03 * (i + 1), 400.0 + 45.0 * i, rate=1500.0)
        touched = max(touched, run.read("journal_bearing[1].contact"))
    assert touched == 1.0
    assert run.read("energy.friction_loss") > 0
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_a_film_that_does_not_carry_is_said():
    with pytest.raises(
        EquilibriumError, match=r"oil film at node . does not carry them at 0 rad/s"
    ):
        run_of(in_films(), 0.0)
    run = run_of(in_films(), 600.0)
    with pytest.raises(StepFailure, match=r"oil film at node . is thinner than its roughness"):
        run.advance(1.0, 600.0, np.array([-1e8j]))


@pytest.mark.parametrize("what", ["plain", "damper", "tilting pads"])
def test_a_start_through_a_film_is_refused(what):
    part = {
        "plain": film(1),
        "damper": table("[squeeze_film_damper]", **{**DAMPER, "node": 1}),
        "tilting pads": film(1, pads=[0.8, 2.4, 4.0, 5.5], arc=1.3, tilting=True),
    }[what]

    def begin(x):
        text = f"gravity = 0.0\n{heavy_shaft()}{part}{table('start', x=x)}"
        return run_of(parse_rotor(text), 600.0)

    with pytest.raises(EquilibriumError) as raised:
        begin(1.2e-4)
    assert str(raised.value).startswith(
        "[start]: node 1 lies 0.00012 m from the middle of its oil film, of a clearance of 0.0001 m"
    )
    assert "\n" not in str(raised.value)
    assert begin(0.5e-4).read(f"{part.split(']')[0].strip('[')}[1].film") > 1e-6


def _pressed(run):
    """Load a rotor ever harder, until no film of the thickness of its roughness carries it."""
    for i in range(1, 41):
        run.advance(2.5e-3 * i, 600.0, np.array([-2e5j * i]))


@pytest.mark.parametrize("settings", [{}, {"method": "radau5"}], ids=["default", "radau5"])
def test_a_run_ends_where_a_film_without_contact_breaks(settings):
    settings = choose("controlled", tolerance=1e-3, **settings)
    run = Simulation(in_films(), settings, speed=600.0, warn=lambda _: None)
    with pytest.raises(StepFailure, match=r"oil film at node . is thinner than its roughness"):
        _pressed(run)
    # the last good state
    assert 1e-6 <= run.read("journal_bearing[1].film") < 2e-6


def _coast(run):
    """Let a rotor turn on without a torque, in communication steps of 2 ms."""
    for i in range(1, 51):
        run.advance(2e-3 * i, 0.0)


def test_the_film_that_breaks_is_named_where_pads_tilt():
    """It is that of the step which was tried, with its pads as they are tilted then."""
    journals = {"journal_radius": 0.02, "length": 0.02, "clearance": 5e-5, "viscosity": 0.01}
    pads = {"pads": [0.8, 2.4, 4.0, 5.5], "arc": 1.3, "tilting": True, "points": 8}
    text = shaft(0.0, 0.2, 0.4)
    text += table("[body]", node=2, mass=2.0, I_d=0.01, I_p=0.015, e=2e-5)
    text += table("[journal_bearing]", node=1, **journals, **pads)
    text += table("[journal_bearing]", node=3, **journals, short=True)
    run = run_of(parse_rotor(text), 1400.0, 1e-3, drive_torque=0.0)
    with pytest.raises(StepFailure, match=r"oil film at node 1 is thinner than its roughness"):
        _coast(run)
    assert run.read("journal_bearing[1].film") < 1.1e-6 < run.read("journal_bearing[2].film")


def test_a_free_rotor_is_braked_by_its_films():
    rotor = in_films()
    run = run_of(rotor, 600.0, drive_torque=0.0)
    torque = 2 * run.read("journal_bearing[1].torque")
    inertia = 2 * run.read("energy.kinetic") / 600.0**2
    run.advance(1e-3, 0.0)
    seen = (600.0 - run.read("w")) / 1e-3
    assert seen == pytest.approx(torque / inertia, rel=5e-3)


# --- FMUs ---


def test_fmu_has_the_bits_of_the_simulation(machine_of):
    """The FMU in Python and the native one, with a film in lobes and a damper."""
    lobes = {"pads": [1.570796, 4.712389], "arc": 2.8, "preload": 0.4}
    damper = table("[squeeze_film_damper]", **{**DAMPER, "node": 3}, stiffness=1e7)
    text = heavy_shaft(1e-5) + film(1, **lobes, k=1e8) + damper
    names = ("journal_bearing[1].fx", "journal_bearing[1].film", "squeeze_film_damper[1].fy")
    of_fmu, of_simulation = of_both(machine_of, text, names, 500.0)
    assert of_fmu == of_simulation
