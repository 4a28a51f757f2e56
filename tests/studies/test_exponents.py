"""The largest Lyapunov exponent that a study keeps, against closed forms and against how two runs
of the integrator part."""

import math

import numpy as np
import pytest
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf
from rotor_fmu import studies
from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.studies.runner import run_study

from ..parts.machines import bearings, rigid
from ..periodic.machines import OMEGA, growth, rub
from ..periodic.test_equations import KINDS, MORE
from .functions import conducted, here, quiet

WIDE, HEAVY = 300e-6, 80e-6  # of the rig's bearings, and the eccentricities of its discs [m]
CHANGED = {f"bearing[{i}].clearance": WIDE for i in (1, 2)}
CHANGED |= {f"disc[{i}].e": HEAVY for i in (1, 2, 3)}


def read(folder, machine, run, keep="l = { lyapunov = 'largest' }", values=None, mu=0.05):
    given = {"solver.tolerance": 1e-6} | (values or {})
    lines = "\n".join(f'"{name}" = {value}' for name, value in given.items())
    vary = '"bearing[1].mu"' if machine == "rig" else '"contact[1].mu"'
    value = mu
    path = folder / "study.toml"
    path.write_text(
        f"machine = '{machine}'\n[set]\n{lines}\n[run]\n{run}\n"
        f"[vary]\n{vary} = {{ values = [{value}] }}\n[keep]\n{keep}\n"
    )
    return read_study(path)


def row(folder, *study, **options):
    run_study(read(folder, *study, **options), folder / "out", here, quiet)
    data = studies.open(folder / "out").isel(run=0)
    assert data.status == "ok"
    return data


@pytest.mark.parametrize("turns", [16, 64])
def test_exponents_of_held_speeds_are_those_of_the_closed_form(tmp_path, turns):
    """Of complex multipliers, whose differences turn as they decay, and of others beside them that
    decay twice as fast: over few turns as over many."""
    run = f"kind = 'steps'\nfrom = 120\nto = 195\ncount = 2\nsettle = 2\nturns = {turns}"
    keep = "l = { lyapunov = 'largest' }\nx = { poincare = 'disc.x' }"
    values = {"solver.tolerance": 1e-4}
    data = row(tmp_path, "jeffcott_rub/jeffcott.toml", run, keep, values)
    for i, omega in enumerate((1.2, 1.95)):
        expected = growth(omega, rub(omega))[0] * OMEGA
        assert float(data.l.values[i]) == pytest.approx(expected, rel=1e-4)
    # the Poincare section of each speed is one point
    sections = data.x.values.reshape(2, turns)
    assert np.ptp(sections, axis=1) == pytest.approx([0, 0], abs=1e-7)
    assert abs(sections[0, 0] - sections[1, 0]) > 1e-4


def test_the_spring_of_a_race_that_never_sticks_has_no_exponent(tmp_path):
    """Its elongation stays what it is, an exponent of 0; the largest one is that of the race."""
    race = KINDS["race"] + MORE
    text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + race)
    (tmp_path / "race.toml").write_text(text, encoding="utf-8")
    _, _, data = conducted(
        "machine = 'race.toml'\n[run]\nkind = 'constant'\nspeed = 120\nsettle = 3\nturns = 128\n"
        "[vary]\n'touchdown_bearing[1].mu' = { values = [0.2] }\n"
        "[keep]\nl = { lyapunov = 'largest' }\nf = { mean = 'touchdown_bearing[1].fn' }\n",
        tmp_path,
    )
    (motion,) = rf.response(rf.parse(text), speed=(119.0, 121.0)).at(120.0)
    expected = math.log(abs(motion.multipliers[0])) * 120.0 / math.tau
    assert data.f.values > 1.0
    assert data.l.values == pytest.approx(expected, rel=3e-3)


def parting(speed, turns, settle=60):
    """How fast two runs part, or come together [1/s], brought back together every turn."""
    rotor = rf.load().rotor.with_values(CHANGED)
    settings, period = choose(tolerance=1e-6), 2 * math.pi / speed
    one, other = (
        Simulation(rotor, settings, speed=speed, continues_speed=False, warn=len) for _ in range(2)
    )
    one.advance(settle * period, speed)
    other.advance(settle * period, speed)
    parts = ("q", "v", "a", "v_dot", "internal_state")
    other.motion.q[:-1] += 1e-7 * np.random.default_rng(1).standard_normal(len(one.motion.q) - 1)

    def size():
        q, v = (getattr(other.motion, n) - getattr(one.motion, n) for n in "qv")
        return np.linalg.norm(np.concatenate([q, v / speed]))

    grown, before = [], size()
    for k in range(turns):
        for run in (one, other):
            run.advance((settle + 1 + k) * period, speed)
        after = size()
        grown.append(math.log(after / before) / period)
        apart = [getattr(other.motion, n) - getattr(one.motion, n) for n in parts]
        other.restore(one.snapshot())
        for name, difference in zip(parts, apart, strict=True):
            getattr(other.motion, name)[:] += 1e-7 / after * difference
        before = size()
    s = (np.arange(turns) + 0.5) / turns
    return np.average(grown, weights=np.exp(-1 / (s * (1 - s))))


@pytest.mark.slow
@pytest.mark.parametrize(("speed", "turns", "share"), [(170.0, 400, 2e-4), (195.0, 200, 0.1)])
def test_the_exponent_is_the_rate_at_which_two_runs_part(tmp_path, speed, turns, share):
    """At 170 rad/s a motion of twice the period, whose differences turn as they shrink, so that
    over half as many turns what they began as still shows (0.5 %); at 195 rad/s chaos."""
    settle = 60 * 2 * math.pi / speed
    run = f"kind = 'constant'\nspeed = {speed}\nsettle = {settle}\nturns = {turns}"
    data = row(tmp_path, "rig", run, values=CHANGED)
    expected = parting(speed, turns)
    assert (float(data.l) > 0) == (speed == 195.0)
    assert float(data.l) == pytest.approx(expected, rel=share)


@pytest.mark.parametrize(
    ("run", "keep", "words"),
    [
        ("kind = 'run-down'", "l = { lyapunov = 'largest' }", "needs runs at constant speed"),
        ("kind = 'constant'\nspeed = 120", "l = { lyapunov = 'disc' }", "must be 'largest'"),
        (
            "kind = 'constant'\nspeed = 120\nturns = 8",
            "l = { lyapunov = 'largest' }",
            "lyapunov needs run.turns >= 16, not 8",
        ),
    ],
)
def test_what_has_no_exponent_is_one_line(tmp_path, run, keep, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, "jeffcott_rub/jeffcott.toml", run, keep)
