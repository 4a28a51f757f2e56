"""Unbalances placed by a mode shape on bodies whose centre lies beyond their node."""

from dataclasses import replace

import pytest
from rotor_fmu.model.linear import placed_unbalances, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.body import Body
from rotor_fmu.model.parts.shaft import Material, Section

from rotor_fmu.machine_report.unbalanced import with_unbalances
from tests.linear.api_617 import SHAFT, support


@pytest.mark.parametrize("last", [5, 7])
def test_the_unbalance_of_a_body_beyond_its_node_stands_at_its_centre(last):
    """Also beyond a bearing at the shaft's end: as on a stub, stiff and without mass, up to it."""
    body = "[[body]]\nnode = 7\nmass = 20.0\nI_d = 0.1\nI_p = 0.1\noffset = 0.2\n"
    shaft = SHAFT[: SHAFT.index("[[")] + support(1, 1e7) + support(last, 1e7)
    offset = parse_rotor(shaft + body)
    stub = Section(0.2, 0.05, 0.05, Material(young=2e15, density=1e-6))
    on_stub = parse_rotor(shaft + body.replace("node = 7", "node = 6").replace("0.2", "0.0"))
    on_stub = replace(
        on_stub,
        sections=(*on_stub.sections, stub),
        parts=tuple(replace(p, node=8) if isinstance(p, Body) else p for p in on_stub.parts),
    )
    (placed,), (expected,) = (placed_unbalances(each, 1, 300.0) for each in (offset, on_stub))
    assert (placed.node, placed.offset, expected.node) == (7, 0.2, 8)
    assert placed.mass == pytest.approx(expected.mass, rel=1e-6)
    seen, wanted = (
        unbalance_response(each, [100.0], unbalances=[unbalance.acting])
        for each, unbalance in ((offset, placed), (on_stub, expected))
    )
    assert seen.major[0] == pytest.approx(wanted.major[0, :7], rel=1e-3)
    run = with_unbalances(offset, [placed.acting], 1.0)
    assert unbalance_response(run, [100.0]).major == pytest.approx(seen.major, rel=1e-9)


@pytest.mark.parametrize("given", [[(3, 1e-4, 0.5)], None])
def test_a_run_has_the_bow_that_the_linear_response_has(given):
    """None where unbalances are given; with its own it is part of what is scaled."""
    bow = "[[bow]]\nnode = 4\namplitude = 1e-4\n[[unbalance]]\nnode = 3\namount = 1e-4\n"
    rotor = parse_rotor(SHAFT + support(1, 1e7) + support(7, 1e7) + bow)
    linear = unbalance_response(rotor, [100.0], unbalances=given)
    run = unbalance_response(with_unbalances(rotor, given, 2.0), [100.0])
    assert run.major == pytest.approx(2.0 * linear.major, rel=1e-9)
