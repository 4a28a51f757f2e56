"""A reduction is offered where it pays, with an error that the reduced machine has."""

import re
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.shaft import Section
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.simulation import RotorNote
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.reduction import reduced
from rotor_fmu.model.structure.reduction_offer import reduction_offer

import rotor_fmu as rf


def finer(times):
    """The rig with each of its elements cut into so many."""
    rotor = rig()
    sections = [
        Section.cylinder(s.length / times, s.outer_left, s.material)
        for s in rotor.sections
        for _ in range(times)
    ]
    parts = [
        replace(part, node=times * (part.node - 1) + 1) if hasattr(part, "node") else part
        for part in rotor.parts
    ]
    return replace(rotor, sections=tuple(sections), parts=tuple(parts))


def offered(rotor, speed=400.0):
    offer = reduction_offer(rotor, assemble(rotor), speed)
    return offer and offer.note


@pytest.mark.parametrize("times", [12, 40])
def test_the_error_that_is_said_is_that_of_the_reduced_machine(times):
    """Frequencies of both structures' own matrices, below twice the speed, contacts pinned."""
    rotor = finer(times)
    said = offered(rotor)
    assert said.is_note
    assert said.code == "reduction-pays"
    modes, count, shift = re.search(
        r"reduction = (\d+) .* the (\d+) lowest .* by at most (\S+) of", said
    ).groups()
    whole = assemble(rotor)
    omegas = []
    for structure in (whole, reduced(whole, int(modes))):
        free = np.delete(np.arange(len(structure.static_load)), structure.interfaces.dof)
        K, M = (to_dense(a)[np.ix_(free, free)] for a in (structure.K_shaft, structure.M))
        omegas.append(np.sqrt(scipy.linalg.eigvalsh(K, M)[: int(count)]))
    assert omegas[0][-1] < 800.0
    assert (omegas[1] / omegas[0] - 1).max() <= 1.5 * float(shift)


def test_springs_hold_the_shaft_whose_frequencies_are_counted():
    rotor, stiffness = finer(12), 1e6
    rotor = replace(rotor, parts=(*rotor.parts, Support(43, stiffness)))
    structure = assemble(rotor)
    K, M = to_dense(structure.K_shaft), to_dense(structure.M)
    K[84, 84] += stiffness
    omegas = np.sqrt(np.maximum(scipy.linalg.eigvalsh(K, M), 0.0))
    elastic = omegas[omegas > 1.0]
    offer = reduction_offer(rotor, structure, elastic[2] / 1.999)
    assert offer.excited == 3
    assert offer.shift < 1e-3


def test_a_short_shaft_and_one_in_many_bearings_are_offered_nothing():
    assert offered(rig()) is None
    rotor = finer(12)
    bearings = [replace(rotor.bearings[0], node=node) for node in range(2, 84, 2)]
    assert offered(rotor.with_parts(Bearing, *bearings)) is None


def test_a_run_that_excites_more_modes_is_offered_more_of_them():
    modes = [
        int(re.search(r"reduction = (\d+)", offered(finer(12), speed))[1])
        for speed in (400.0, 12000.0)
    ]
    assert modes[1] > modes[0]


def test_a_run_that_excites_more_modes_than_any_reduction_has_is_offered_none():
    """As of a drill string that turns fast."""
    assert offered(finer(12), 1e6) is None


def test_a_run_says_it_as_a_note_and_a_reduced_one_does_not():
    machine = rf.Machine(finer(12), toml="")
    with pytest.warns(RotorNote, match="would do for this machine of 85 nodes"):
        run = rf.simulate(machine, speed=100.0, stop=0.002)
    assert "reduction-pays" in run.codes
    assert run.status == "ok"
    again = rf.simulate(machine, speed=100.0, stop=0.002, parameters={"solver.reduction": 4.0})
    assert "reduction-pays" not in again.codes
