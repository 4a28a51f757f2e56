"""Parameters of the machine that change between two steps: the run goes on as that of the machine
with the new value, the ledger counts what it does, what cannot be is refused, all or nothing."""

import math
import re

import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from rotor_fmu.machine_file.loading import machine_text

from ..fmu.skins import Discarded, Extracted, Native, Refused
from ..parts.rings import rigid_in_rings
from .test_coupling_calls import H, Host

OIL = machine_text("", example_folder("oil_film") / "rotor.toml")
DAMPED = machine_text("", example_folder("squeeze_film") / "rotor.toml")
ROLLING = machine_text("", example_folder("rolling_bearing") / "rotor.toml")
BALANCED = re.sub(r"\be = [0-9.e-]+", "e = 0.0", re.sub(r"mu = [0-9.]+", "mu = 0.0", rig_toml()))


@pytest.fixture(scope="module")
def oil(make):
    return Extracted(make(toml=OIL))


@pytest.fixture(scope="module")
def rolling(make):
    return Extracted(make(toml=ROLLING))


def far(host, steps, h=H):
    for _ in range(steps):
        host.step(h)
    return host


FILM = [f"journal_bearing[{i}].{name}" for i in (1, 2) for name in ("eccentricity", "fx", "fy")]


def test_a_lubricant_that_warms_up_is_that_of_a_machine_with_the_warm_one(oil):
    """Once the motion has settled: the journals run deeper in a thinner film."""
    start = {"speed": 100.0, "solver.tolerance": 1e-6, "body[1].e": 0.0}
    start = {name: value for name, value in start.items() if name in oil.refs}
    warm = {f"journal_bearing[{i}].viscosity": 0.01 for i in (1, 2)}
    host, other = far(Host(oil, start), 100), far(Host(oil, start | warm), 300)
    cold = dict(zip(FILM, host.get(*FILM), strict=True))
    state, t = host.fmu.state(), host.t
    host.put(warm)
    again = host.fmu.state()
    host.step()
    first = host.get(*FILM, "energy.residual")
    far(host, 199)
    seen = dict(zip(FILM, host.get(*FILM), strict=True))
    expected = dict(zip(FILM, other.get(*FILM), strict=True))
    for name in ("journal_bearing[1].eccentricity", "journal_bearing[2].eccentricity"):
        assert seen[name] > 1.02 * cold[name]
        assert seen[name] == pytest.approx(expected[name], rel=2e-2)
    # a state goes back before the change, and with it
    host.fmu.restore(state)
    assert host.get("journal_bearing[1].viscosity") == [0.02]
    host.fmu.restore(again)
    host.t = t
    host.step()
    assert host.get(*FILM, "energy.residual") == first


def test_a_bearing_that_is_preloaded_during_a_run_is_worked_on_by_what_does_it(rolling):
    """Its elements are pressed, which the ledger counts as external work."""
    host = far(Host(rolling, {"speed": 100.0, "solver.tolerance": 1e-6}), 50)
    names = ("energy.external_work", "energy.compression", "energy.residual")
    work, stored, residual = host.get(*names)
    host.put({f"{name}.clearance": -5e-6 for name in ("left", "right")})
    host.step(1e-6)
    after = host.get(*names)
    pressed = after[1] - stored
    assert pressed > 2 * stored
    assert after[0] - work == pytest.approx(pressed, rel=1e-2)
    assert abs(after[2] - residual) < 1e-2 * pressed


def said_by(run):
    """Its warnings, with their codes."""
    return sorted((text, text.code) for text in run)


THIN, WIDE = (
    {f"journal_bearing[{i}].{n}": 2e-4 for i in (1, 2)} for n in ("viscosity", "clearance")
)


@pytest.mark.parametrize(
    ("values", "viscosity", "clearance"),
    [({}, 0.02, 5e-5), (THIN, 2e-4, 5e-5), (WIDE, 0.02, 2e-4)],
    ids=["as built", "thin oil", "wide"],
)
def test_a_film_is_laminar_up_to_the_speed_of_the_values_that_were_set(
    oil, values, viscosity, clearance
):
    """Re = density w R c / viscosity up to 41.3 sqrt(R / c), ISO 7902-1."""
    reynolds = 41.3 * math.sqrt(0.01 / clearance)
    speed = reynolds * viscosity / (860.0 * 0.01 * clearance)
    for ratio, count in ((0.99, 0), (1.01, 2)):
        expected, at = [], ratio * speed
        Simulation(parse_rotor(OIL).with_values(values), speed=at, warn=expected.append)
        fmu = Native(oil).put(values | {"speed": at}).initialize()
        assert said_by(fmu.warnings) == said_by(expected)
        not_laminar = [text for text in fmu.warnings if text.code == "not-laminar"]
        assert len(not_laminar) == count
        words = f"above {speed:.4g} rad/s, where the Reynolds number of its film exceeds "
        assert all(f"{words}{reynolds:.4g} " in text for text in not_laminar)


def test_oil_that_becomes_thin_in_a_run_is_warned_of(oil):
    host = far(Host(oil, {"speed": 300.0}), 3, 1e-4)
    assert "not-laminar" not in {text.code for text in host.fmu.warnings}
    host.put(THIN)
    host.step(1e-4)
    assert [text.code for text in host.fmu.warnings].count("not-laminar") == 2


@pytest.mark.parametrize(
    ("toml", "names", "roughness"),
    [
        (OIL, ("journal_bearing[1].clearance",), 1e-6),
        (DAMPED, ("squeeze_film_damper[2].clearance",), 1e-6),
        (
            rigid_in_rings(),
            [f"floating_ring_bearing[1].{n}clearance" for n in ("", "outer_")],
            2e-7,
        ),
    ],
    ids=["journal", "damper", "rings"],
)
def test_a_clearance_below_twice_the_roughness_is_refused_as_in_a_machine_file(
    make, toml, names, roughness
):
    extracted, rotor = Extracted(make(toml=toml)), parse_rotor(toml)
    least = 2.0 * roughness
    for name in names:
        rotor.with_values({name: 1.001 * least})
        with pytest.raises(QuantityError, match="must be below half the"):
            rotor.with_values({name: least})
        (variable,) = (v for v in extracted.description.modelVariables if v.name == name)
        assert float(variable.min) == math.nextafter(least, math.inf)
        fmu = Native(extracted).put({"speed": 100.0, name: least})
        words = re.escape(f"{name} = {least:g} m: must be > {least:g} m, twice the roughness")
        with pytest.raises(Refused, match=words):
            fmu.initialize()


def test_hysteresis_is_warned_of_where_a_host_sets_it(make):
    """A run takes every whirl as slower than the rotation."""
    extracted = Extracted(make())
    for eta_h in (0.0, 1e-3):
        values = {"shaft.eta_h": eta_h, "shaft.rotating_damping": True}
        expected = []
        Simulation(rig().with_values(values), speed=50.0, warn=expected.append)
        fmu = Native(extracted).put(values | {"speed": 50.0}).initialize()
        assert said_by(fmu.warnings) == said_by(expected)
        assert ("hysteretic-as-slower" in {text.code for text in fmu.warnings}) == (eta_h > 0)


def test_of_values_one_of_which_cannot_be_none_is_taken(oil):
    host = far(Host(oil, {"speed": 100.0}), 5)
    before = host.fmu.state()
    refs = [oil.refs[f"journal_bearing[{i}].{n}"] for i in (1, 2) for n in ("viscosity", "mu")]
    for values, sentence in (
        ([0.01, 0.2, 0.0, 0.2], r"journal_bearing\[2\]\.viscosity = 0 Pa\.s: must be > 0"),
        ([0.01, 0.2, 0.01, -0.1], r"journal_bearing\[2\]\.mu = -0\.1: must be >= 0"),
        ([0.01, 0.2, float("nan"), 0.2], r"journal_bearing\[2\]\.viscosity = nan: must be a fin"),
    ):
        with pytest.raises(Refused, match=sentence):
            host.fmu.set("Real", refs, values)
        assert host.fmu.state() == before
    with pytest.raises(Refused, match=r"journal_bearing\[1\]\.clearance: a fixed parameter"):
        host.put({"journal_bearing[1].clearance": 4e-5})


# --- what is asked for and cannot be --------------------------------------------------------------


def test_sensitivities_that_there_are_not_are_refused(make):
    extracted = Extracted(make())
    refs = extracted.refs
    host = Host(extracted, {"speed": 100.0, "solver.sensitivities": True})
    host.step()
    for unknown, known, sentence in (
        ("disc[3].x", "gravity", "gravity: is not an input"),
        ("disc[3].x", "disc[1].x", r"disc\[1\]\.x: is not an input"),
        ("disc[3].r_amp", "speed", r"disc\[3\]\.r_amp: does not follow from the motion"),
        ("solver.preset", "speed", r"solver\.preset: is not a Real that is computed"),
    ):
        with pytest.raises(Refused, match=sentence):
            host.fmu.directional([refs[unknown]], [refs[known]], [1.0])
    off = Host(extracted, {"speed": 100.0})
    off.step()
    with pytest.raises(Refused, match=r"solver\.sensitivities is false; it has to be set before"):
        off.fmu.directional([refs["disc[3].x"]], [refs["speed"]], [1.0])


@pytest.mark.parametrize("impedance", [0.0, -5.0])
def test_a_line_without_an_impedance_is_refused(impedance):
    toml = rig_toml() + f'[[line]]\nnode = 2\nimpedance = {impedance}\nname = "joint"\n'
    with pytest.raises(QuantityError, match=r"joint\.impedance = .*: must be > 0"):
        parse_rotor(toml)


# --- a start at rest ------------------------------------------------------------------------------


def test_a_rotor_that_a_torque_drives_starts_at_rest(make):
    """With nothing that brakes it: w = tau t / J, phi = tau t^2 / 2 J."""
    extracted = Extracted(make(toml=BALANCED, is_free=True))
    host = Host(extracted, {"w_start": 0.0, "tau_drive": 0.1})
    assert host.get("w", "phi") == [0.0, 0.0]
    far(host, 50)
    inertia = float(assemble(parse_rotor(BALANCED)).numbers[0].inertia)
    w, phi, work = host.get("w", "phi", "energy.drive_work")
    assert w == pytest.approx(0.1 * host.t / inertia, rel=1e-9)
    assert phi == pytest.approx(0.05 * host.t**2 / inertia, rel=1e-9)
    assert work == pytest.approx(0.5 * inertia * w**2, rel=1e-8)


def test_it_stays_at_rest_below_the_friction_of_its_bearings(make):
    extracted = Extracted(make(is_free=True))
    host = far(Host(extracted, {"w_start": 0.0, "tau_drive": 0.01}), 100)
    (w,) = host.get("w")
    # what regularized friction lets creep
    assert abs(w) < 0.1
    moved = far(Host(extracted, {"w_start": 0.0, "tau_drive": 0.3}), 100).get("w")[0]
    assert moved > 1.0


# --- the way back with everything on --------------------------------------------------------------


def test_a_step_made_again_is_bit_for_bit_the_same_with_all_that_masters_may_ask_for(make):
    """A line at a node and one that drives, sensitivities, a tuned clearance, energies of steps,
    steps that end at contacts and at a limit."""
    toml = rig_toml() + '[[line]]\nnode = 2\nimpedance = 20.0\nname = "joint"\n'
    toml += "[start]\nx = 0.0\ny = 0.0\n"
    extracted = Extracted(make(toml=toml, is_free=True))
    asked = {"w_start": 100.0, "tau_drive": 40.0, "tau_impedance": 0.4, "limit.force": 60.0}
    asked |= {"limit.contact": True, "solver.sensitivities": True, "joint.fx": 5.0}
    host, ended = Host(extracted, asked), 0
    reals = [v for v in extracted.description.modelVariables if v.type == "Real"]
    refs = [v.valueReference for v in reals]
    knows = [extracted.refs[name] for name in ("tau_drive", "joint.fx", "disc[2].fy")]

    def step(h):
        try:
            host.fmu.step(host.t, h)
        except Discarded:
            return host.fmu.last_successful_time
        return host.t + h

    def all_read():
        along = host.fmu.directional([extracted.refs["disc[3].x"]], knows, [1.0, 2.0, 3.0])
        return [*host.fmu.get("Real", refs), *along]

    for i in range(60):
        if i == 20:
            host.put({"bearing[1].clearance": 45e-6})
        state = host.fmu.state()
        reached = step(H)
        if reached == host.t:  # at the limit from the start on: warned once, and then it goes on
            ended += 1
            continue
        read = all_read()
        host.fmu.restore(state)
        assert step(H) == reached
        assert all_read() == read
        ended += reached < host.t + H
        host.t = reached
    assert ended > 5
    waves = host.get("tau_wave", "joint.wave_x", "step_work", "joint.step_work", "dw_ddrive")
    assert all(waves)
