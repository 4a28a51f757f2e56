"""Component modes: exact with all of them, closer with each, and the same machine."""

import re
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.settings import SettingsError, choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.reduction import component_modes, reduced

ALL = 10  # fixed-interface modes that the rig has: 16 dofs less 6 deflections kept


def orbit(modes, stop=0.4, rotor=None):
    """Disc 3 through contact near the horizontal resonance, every 10 ms."""
    settings = choose("robust", h=1e-4, reduction=modes)
    sim = Simulation(rotor or rig(), settings, speed=180.0, rate=-10.0)
    seen = []
    for i in range(round(stop / 0.01)):
        sim.advance((i + 1) * 0.01, 180.0 - 0.1 * i)
        seen.append(complex(sim.read("disc[3].x"), sim.read("disc[3].y")))
    return np.array(seen), sim


def test_with_all_modes_it_is_a_change_of_coordinates():
    rotor = replace(rig(), mass_damping=5.0)
    whole, _ = orbit(0, rotor=rotor)
    changed, _ = orbit(ALL, rotor=rotor)
    assert np.abs(changed - whole).max() < 1e-8 * np.abs(whole).max()


def test_every_mode_more_comes_closer():
    whole, _ = orbit(0)
    errors = [np.abs(orbit(modes)[0] - whole).max() for modes in (1, 2, 4)]
    assert errors[0] < 0.035 * np.abs(whole).max()
    assert errors[0] > 3 * errors[1] > 9 * errors[2]


def test_the_energy_closes_in_component_modes():
    _, sim = orbit(2)
    losses = sum(sim.read(f"energy.{n}_loss") for n in ("structure", "housing", "contact"))
    assert losses + sim.read("energy.friction_loss") > 0.5
    # the start, when friction sets in at once, costs the same with all modes
    assert sim.read("energy.residual") == pytest.approx(
        orbit(0)[1].read("energy.residual"), abs=2e-3
    )


HEATED = """
[[heated_contact]]
node = {node}
journal_radius = 0.02
clearance = 1e-5
mu = 0.1
k = 1e6
bow_per_heat = 1e-6
bow_decay = 1.0
"""


@pytest.mark.parametrize("modes", [0, 4, 20])
def test_bows_store_what_they_store_in_the_whole_shaft(modes):
    """They bend short elements, beyond the modes kept; the shaft yields to them at once. Elastic
    energy at rest with bows b, least over q: (b S b - b F K^-1 F b) / 2."""
    nodes = np.linspace(0.0, 0.6, 31).tolist()
    text = f"""
    [material]
    young = 2.1e11
    density = 7800.0
    [shaft]
    nodes = {nodes}
    diameters = {30 * [0.04]}
    """
    for node in (1, 31):
        text += f"[[support]]\nnode = {node}\nstiffness = 1e6\ndamping = 500.0\n"
    whole = assemble(parse_rotor(text + HEATED.format(node=12) + HEATED.format(node=16)))
    stored = []
    for structure in (whole, reduced(whole, modes)):
        F = structure.bow_forces
        yields = F @ np.linalg.solve(to_dense(structure.K), F.T)
        stored.append(structure.bow_stiffness - yields)
    own = np.diag(whole.bow_stiffness).max()
    np.testing.assert_allclose(stored[1], stored[0], rtol=0, atol=1e-9 * own)


def test_masses_and_modes_below_the_cut_are_kept():
    structure = assemble(rig())
    n = len(structure.static_load)
    for modes, closeness in ((1, 1e-2), (3, 1e-4)):
        small = reduced(structure, modes)
        assert small.M.shape == (6 + modes, 6 + modes)
        rigid = np.zeros(len(small.static_load))
        rigid[:6] = 1.0
        assert rigid @ small.static_load == pytest.approx(
            structure.static_load[::2].sum(), rel=1e-9
        )
        w = small.weights
        assert w.weight @ (rigid[w.i] * rigid[w.k]) == pytest.approx(1.0)
        springs = np.zeros((n, n))
        dofs = structure.interfaces.dof
        springs[dofs, dofs] = 1e7
        squares = np.linalg.eigvals(
            np.linalg.solve(to_dense(structure.M), to_dense(structure.K) + springs)
        )
        _, T = component_modes(structure, modes)
        few = np.linalg.eigvals(
            np.linalg.solve(to_dense(small.M), to_dense(small.K) + T.T @ springs @ T)
        )
        assert np.sort(few.real)[:2] == pytest.approx(np.sort(squares.real)[:2], rel=closeness)


def test_more_modes_than_there_are_means_all():
    assert reduced(assemble(rig()), 1000).M.shape == (16, 16)


def test_a_rotor_on_supports_rests_where_it_rested():
    supports = Support(2, 1e6, 10.0), Support(8, 1e6, 10.0)
    rotor = rig().with_parts(Bearing).with_parts(Support, *supports)
    whole = Simulation(rotor, choose("robust")).read("disc[2].y")
    few = Simulation(rotor, choose("robust", reduction=2)).read("disc[2].y")
    assert few == pytest.approx(whole, rel=1e-4)


@pytest.mark.parametrize("value", [-1, 1.5])
def test_a_number_of_modes_that_cannot_be_is_refused(value):
    with pytest.raises(SettingsError, match=r"^reduction = .*integer >= 0"):
        choose(reduction=value)


# --- what a reduction moves is said ---

# A thin shaft on two bearings, a hub amid: three places where something acts, sixty elements.
SLENDER = """
[material]
young = 2.1e11
density = 7800.0
[[section]]
length = 2.0
outer = 0.03
elements = 60
[[body]]
node = 31
mass = 0.1
I_d = 1e-4
I_p = 1e-4
""" + "".join(
    f"[[linear_bearing]]\nnode = {node}\nkxx = 1e7\nkyy = 1e7\ncxx = 1e3\ncyy = 1e3\n"
    for node in (1, 61)
)
LONG = parse_rotor(SLENDER)


def natural(rotor, modes):
    """Frequencies [Hz] of a shaft at rest, by dense matrices of the structure itself."""
    structure = assemble(rotor)
    if modes:
        structure = reduced(structure, modes)
    K = to_dense(structure.K)
    K[structure.interfaces.dof, structure.interfaces.dof] += 1e7
    squares = scipy.linalg.eigh(K, to_dense(structure.M), eigvals_only=True)
    return np.sqrt(squares) / (2 * np.pi)


def warnings_of(rotor, modes, *speeds):
    """What is said of a reduction at the start and after each speed [rad/s]."""
    messages, output = [], []
    sim = Simulation(
        rotor,
        choose("robust", reduction=modes),
        speed=speeds[0],
        continues_speed=False,
        warn=messages.append,
    )
    for i, speed in enumerate((*speeds[1:], speeds[-1])):
        output.append([m for m in messages if m.startswith("solver.reduction")])
        messages.clear()
        sim.advance(1e-3 * (i + 1), speed)
    return output


def test_a_mode_that_a_reduction_moves_is_said_with_both_frequencies():
    full, few = natural(LONG, 0), natural(LONG, 1)
    assert few[2] > 2 * full[2]
    ((output,),) = warnings_of(LONG, 1, 500.0)
    hertz = [float(number) for number in re.findall(r"([\d.]+) Hz", output)]
    np.testing.assert_allclose(hertz, [full[2], few[2]], rtol=1e-3)
    assert "reduction = 1 is too coarse: mode 3 of the shaft, " in output
    enough = int(re.search(r"use at least (\d+), or 0 ", output)[1])
    off = [natural(LONG, modes)[2] / full[2] - 1 for modes in (enough - 1, enough)]
    assert off[0] > 0.02 > off[1]
    assert warnings_of(LONG, enough, 500.0) == [[]]


def test_it_is_said_once_when_the_speed_comes_to_half_of_the_frequency():
    half = np.pi * natural(LONG, 0)[2]
    output = warnings_of(LONG, 1, 0.0, 0.9 * half, -1.1 * half, 1.2 * half, 0.5 * half)
    assert [len(now) for now in output] == [0, 0, 1, 0, 0]


def test_of_the_rig_contacts_open_and_pinned_are_told_apart():
    (output,) = warnings_of(rig(), 1, 2200.0)
    assert [text.partition(" with contacts ")[2].partition(",")[0] for text in output] == [
        *["open"] * 3,
        *["pinned"] * 3,
    ]
    assert warnings_of(rig(), 1, 400.0) == [[]]
    assert warnings_of(rig(), 3, 2200.0) == [[]]
    assert warnings_of(rig(), ALL, 1e4) == [[]]


def test_a_mode_that_is_lost_is_said():
    full, few = natural(LONG, 0), natural(LONG, 1)
    lost = len(few)
    output = warnings_of(LONG, 1, np.pi * full[lost] * 0.99, np.pi * full[lost] * 1.01)
    assert f"mode {lost + 1} of the shaft, {full[lost]:.4g} Hz, is lost, and" in output[1][0]
