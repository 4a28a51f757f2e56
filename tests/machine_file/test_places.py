"""Parameters written at their places make the machine that was asked for."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.base import BodyElement, Part
from rotor_fmu.model.parts.unbalance import Unbalance
from rotor_fmu.model.quantities import QuantityError, quantity
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.parameter_locations import parameter_locations
from rotor_fmu.model.structure.parameters import prepare


def member(structure, path):
    name, _, rest = path.partition("[")
    result = getattr(structure, name)
    return result[int(rest.rstrip("]"))] if rest else result


def differences(one, other):
    """The members in which two structures differ, with the places in them."""
    result = []
    for name, a, b in zip(one._fields, one, other, strict=True):
        pairs = zip(a, b, strict=True) if isinstance(a, tuple) else [(a, b)]
        result += [(name, i) for i, (x, y) in enumerate(pairs) if not np.array_equal(x, y)]
    return result


@pytest.fixture(scope="module")
def machine():
    bare = rig()
    return replace(bare, parts=(*bare.parts, Unbalance(3, 1e-5, 0.5)), rotating_damping=True)


def test_every_parameter_has_a_place(machine):
    assert [*parameter_locations(machine)] == [of.name for of in machine.parameters().values()]
    assert all(parameter_locations(machine).values())


def test_a_value_at_its_place_is_the_machine_with_that_value(machine):
    places = parameter_locations(machine)
    for name, declared, value in machine.parameters().values():
        changed = (not value) if declared.is_switch else 1.25 * value + 0.01
        structure = assemble(machine)
        for place in places[name]:
            member(structure, place.member)[place.row][place.field] = changed
        interpreted(prepare)(structure)
        assert differences(structure, assemble(machine.with_value(str(name), changed))) == [], name


def test_a_parameter_of_a_matrix_is_refused(machine):
    @dataclass(frozen=True)
    class Weight(Part):
        KIND: ClassVar[str] = "weight"
        TEXT: ClassVar[str] = "a mass that a user may change"
        node: int
        mass: float = quantity("kg", "mass", is_parameter=True)

        def elements(self, where, density):
            yield BodyElement(self.node, self.mass, 0.0, 0.0)

    heavier = replace(machine, parts=(*machine.parts, Weight(3, 1.0)))
    with pytest.raises(QuantityError, match=r"mass: cannot be changed after assembly"):
        parameter_locations(heavier)
