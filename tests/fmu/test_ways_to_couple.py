"""The comparison of ways to couple a motor with the rotor through a stiff shaft."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.examples.drive_train import by_energy, compare, ways
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.structure.assembly import assemble

from rotor_fmu.cli.fmus import ssp
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import RunFailed
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

from ..processes import run_python
from .test_hosts import needs
from .test_schemas import FMI2, mistakes, xml_of

PAGES = Path(__file__).parents[2] / "docs"
STOP, RUN_UP, LONG, SHORT = 0.3, 4.2, 1.5e-2, 1e-4


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    fmu = build_native(
        tmp_path_factory.mktemp("free"), machine_of(is_free=True), platforms=["linux64"]
    )
    return fmpy.extract(str(fmu))


@pytest.fixture(scope="module")
def reference(folder):
    return ways.couple(folder, ways.monolithic, SHORT, STOP).w


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    """The rig without friction and unbalance: its FMU, extracted, and its inertia."""
    toml = re.sub(r"mu = [0-9.]+", "mu = 0.0", rig_toml())
    toml = re.sub(r"\be = [0-9.e-]+", "e = 0.0", toml)
    machine = machine_of(toml, is_free=True)
    fmu = build_native(tmp_path_factory.mktemp("smooth"), machine, platforms=["linux64"])
    return fmpy.extract(str(fmu)), float(assemble(parse_rotor(toml)).numbers[0].inertia)


def test_at_ten_radians_of_the_joint_a_step_one_newton_iteration_holds(folder, reference):
    """Where explicit coupling, with derivatives and iterated too, diverges."""
    frequency = np.sqrt(ways.STIFFNESS * (1 / ways.J_MOTOR + 1 / 0.00954))
    assert frequency * LONG == pytest.approx(10.0, rel=0.01)
    for way in ("explicit", "explicit with derivatives", "iterated"):
        assert not np.isfinite(ways.couple(folder, way, LONG, STOP).w).all(), way
    newton = ways.couple(folder, "one Newton iteration", LONG, STOP)
    assert np.max(np.abs(newton.w / reference - 1)) < 1e-3
    assert newton.lost < 1e-4


def test_derivatives_take_most_of_an_explicit_couplings_error_away(folder, reference):
    plain = ways.couple(folder, "explicit", SHORT, STOP)
    better = ways.couple(folder, "explicit with derivatives", SHORT, STOP)
    assert better.lost < 0.1 * plain.lost


@pytest.mark.parametrize(
    "h",
    [
        pytest.param(SHORT, marks=pytest.mark.slow),
        pytest.param(5e-4, marks=pytest.mark.slow),
        3e-3,
        LONG,
        2e-2,
    ],
)
def test_a_line_is_stable_at_every_step_and_loses_next_to_nothing(folder, h):
    """Over a run-up with a motor that is switched on, through both resonances."""
    run = ways.couple(folder, "transmission line", h, RUN_UP, 6e-2)
    assert run.w[-1] > 200.0
    assert run.lost < 1e-4


def test_a_line_that_passes_on_means_alone_loses_what_oscillates_within_a_step(folder, monkeypatch):
    """As the page says: 2e-4 of the energy instead of 4e-7."""
    whole = ways.couple(folder, "transmission line", 2e-2, RUN_UP, 6e-2)
    line = ways.line

    def of_means(rotor, t, h, at):
        return replace(line(rotor, t, h, at), tau_slope=0.0, back_slope=0.0)

    monkeypatch.setattr(ways, "line", of_means)
    means = ways.couple(folder, of_means, 2e-2, RUN_UP, 6e-2)
    assert whole.lost == pytest.approx(4e-7, rel=0.1)
    assert means.lost == pytest.approx(2e-4, rel=0.1)


@pytest.mark.slow
def test_the_comparison_holds_every_way_against_one_run_of_all(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "STEPS", (SHORT, LONG))
    monkeypatch.setattr(compare, "TOLERANCES", (1e-5,))
    compare.compare(stop=0.1, out=tmp_path)
    report = json.loads((tmp_path / "coupling.json").read_text())
    rows = {(row["way"], row["step_s"]): row for row in report["rows"]}
    assert len(rows) == 2 * len(ways.METHODS)
    assert all(rows[way, SHORT]["speed_error"] < 2e-3 for way in ways.METHODS)
    assert rows["explicit", LONG]["speed_error"] is None
    assert rows["one Newton iteration", LONG]["speed_error"] < 1e-3
    said = capsys.readouterr().out.splitlines()
    assert all(any(line.startswith(way) for line in said) for way in ways.METHODS)
    for run in report.get("ecco", [{}])[0].values():
        assert isinstance(run, float) or run["seconds"] > 0.0


def two_masses(t, inertia):
    """Speed [rad/s] of the rotor as an inertia on the shaft, and the amplitude of its oscillation,
    from the closed form of two masses on a spring with a damper."""
    one, stiffness, damping = ways.J_MOTOR, ways.STIFFNESS, ways.DAMPING
    reduced = one * inertia / (one + inertia)
    decay = damping / (2 * reduced)
    frequency = np.sqrt(stiffness / reduced - decay**2)
    slip = ways.TORQUE / (one * frequency) * np.exp(-decay * t) * np.sin(frequency * t)
    share = one / (one + inertia)
    steady = ways.START + ways.TORQUE * t / (one + inertia)
    return steady - share * slip, share * ways.TORQUE / (one * frequency)


def test_the_monolithic_run_is_the_closed_form_where_nothing_rubs_and_nothing_is_unbalanced(
    smooth,
):
    """To second order in its step."""
    folder, inertia = smooth
    stop, every = 0.03, 1e-3
    t = every * np.arange(1, 1 + round(stop / every))
    expected, amplitude = two_masses(t, inertia)
    errors = [
        np.max(np.abs(ways.couple(folder, ways.monolithic, h, stop, every).w - expected))
        for h in (1e-4, 5e-5, 2.5e-5)
    ]
    assert errors[-1] < 2e-4 * amplitude
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


def test_one_newton_iteration_nears_the_monolithic_run_with_its_step(folder, reference):
    errors = [
        np.max(np.abs(ways.couple(folder, "one Newton iteration", h, STOP).w / reference - 1))
        for h in (LONG, SHORT)
    ]
    assert errors[1] < 0.5 * errors[0] < 5e-4


def test_two_rotors_on_a_line_take_what_the_other_reflects_with_its_sign_reversed(smooth):
    """As two inertias on the line's stiffness, each with half of its inertia."""
    folder, inertia = smooth
    h, impedance, speeds = 1e-4, 0.04, (100.0, 110.0)
    total = inertia + 0.5 * impedance * h
    frequency = np.sqrt(2 * impedance / h / total)
    waves = [(impedance * w, 0.0) for w in speeds]
    slips, given = [], {"tau_impedance": impedance}
    with (
        Member(Path(folder), given | {"w_start": speeds[0]}, [], name="one") as one,
        Member(Path(folder), given | {"w_start": speeds[1]}, [], name="other") as other,
    ):
        ends = ways.Rotor(one), ways.Rotor(other)
        for i in range(300):
            reflected = []
            for end, (wave, slope) in zip(ends, waves, strict=True):
                before = np.array(end.read("phi", "w"))
                end.step(i * h, h, wave - 0.5 * h * slope, slope)
                turned, faster = (end.read("phi", "w") - before) / h
                mean, rate = wave - 2 * impedance * turned, slope - 2 * impedance * faster
                reflected.append((-mean, -rate))
            waves = reflected[::-1]
            slips.append(ends[1].read("w")[0] - ends[0].read("w")[0])
    t = h * np.arange(1, 301)
    expected = 10.0 * np.cos(frequency * t)
    assert np.max(np.abs(slips - expected)) < 0.05 * 10.0


@pytest.mark.slow
@needs("libcosimpy", "pip install libcosimpy")
def test_libcosims_ecco_has_a_fifth_of_the_error_of_as_many_fixed_steps(folder, tmp_path):
    """Of a motor that is switched on, whose shaft rings for a while."""
    stop, every = 1.8, ways.FINE
    expected = ways.couple(folder, ways.monolithic, SHORT, stop, every).w
    given = {"torque": ways.TORQUE, "J": ways.J_MOTOR, "k": ways.STIFFNESS}
    given |= {"c": ways.DAMPING, "w_start": ways.START}
    system = by_energy.motor_and_rotor(tmp_path, given)
    ecco, fixed = by_energy.by_energy(system, 1e-5, stop)
    assert len(fixed.t) == pytest.approx(len(ecco.t), rel=1e-3)
    assert ecco.error(expected, every) < fixed.error(expected, every) / 5
    assert ecco.lost < 1e-4
    (description,) = xml_of(tmp_path / "MotorOnShaft.fmu").values()
    assert mistakes(description, FMI2) == []


def test_the_rotor_is_one_of_the_masters_members(folder, tmp_path, monkeypatch, capfd):
    """It had no name in its messages, and where its library could not be loaded the process stayed
    in the library's folder."""

    def refused(rotor, t, h, at):
        rotor.step(t, -h, at.tau)

    run = ways.couple(folder, refused, SHORT, STOP)
    assert np.isnan(run.w).all()
    assert not np.isfinite(run.lost)
    assert "rotor: error: " in capfd.readouterr().err
    shutil.copytree(folder, tmp_path / "broken")
    for library in (tmp_path / "broken").rglob("*.so"):
        library.write_bytes(b"")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RunFailed, match=r"^rotor: broken: "):
        ways.couple(str(tmp_path / "broken"), "explicit", SHORT, STOP)
    assert Path.cwd() == tmp_path


@pytest.mark.slow
@needs("libcosimpy", "pip install libcosimpy")
def test_where_the_exchange_is_steady_ecco_gains_what_the_page_says(tmp_path):
    """On the drive train of the rig, over three seconds; the reference is of steps of 0.2 ms."""
    ssp.__wrapped__(algorithm="ecco", is_native=True, out=tmp_path)
    file = tmp_path / "OspSystemStructure.xml"
    text = file.read_text()

    def speeds(step=None):
        """By libcosim's ECCO, or in equal steps [s]."""
        if step is not None:
            fixed = re.sub(r"(?<=StepSize>)[^<]+(?=</BaseStepSize)", repr(step), text)
            fixed = re.sub(r'(?<=stepSize=")[^"]+', repr(step), fixed)
            file.write_text(fixed.replace("<Algorithm>ecco<", "<Algorithm>fixedStep<"))
        script = example_folder() / "with_libcosim.py"
        done = run_python(script, str(file), "3", "0", "drive.w")
        assert done.returncode == 0, done.stderr
        return np.array([row.split(",") for row in done.stdout.split()[1:]], dtype=float).T

    by_ecco = speeds()
    steps = by_ecco.shape[1]
    equal, fine = speeds(round(3e9 / steps) * 1e-9), speeds(2e-4)
    errors = [np.max(np.abs(w - np.interp(t, *fine))[t < fine[0, -1]]) for t, w in (by_ecco, equal)]
    page = (PAGES / "how_to" / "choose_a_coupling.md").read_text(encoding="utf-8")
    assert f"{steps}\n  steps have errors of {errors[0]:.1e} rad/s".replace("e-0", "e-") in page
    assert f"of {errors[1]:.1e} rad/s with equal".replace("e-0", "e-") in page
