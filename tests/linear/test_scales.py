"""A machine of other size: with masses, lengths and times that are each another multiple, every
answer is that multiple, so that no threshold, bound or tolerance is a number of some unit."""

import math
import re
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from rotor_fmu.model.linear import (
    campbell,
    critical_map,
    level_1,
    mean_stiffness,
    modes,
    static,
)
from rotor_fmu.model.quantities import quantities

from tests.linear.api_617 import example

_POWERS = {
    **{"kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "Pa": (1, -1, -2)},
    **{"J": (1, 2, -2), "rad": (0, 0, 0), "K": (0, 0, 0)},
}
_SMALLER = (1e-6, 1e-3, 1e-2)  # a rotor of some milligrams and thousandths of a millimetre


def _factor(unit, by):
    """What a quantity of a unit such as N.s/m is multiplied by."""
    result = 1.0
    above, _, below = unit.partition("/")
    for text, sign in ((above, 1), (below, -1)):
        for name, power in re.findall(r"([A-Za-z]+)\^?(-?\d*)", text):
            for times, own in zip(by, _POWERS.get(name, (0, 0, 0)), strict=True):
                result *= times ** (sign * own * int(power or 1))
    return result


def _scaled(item, by):
    """The item with all of its quantities, and those of what it consists of, scaled."""
    changed, declared = {}, quantities(item)
    has_heat = getattr(item, "temperature", ()) != ()
    for field in fields(item):
        value = getattr(item, field.name)
        if field.name in declared:
            is_of_heat = field.name in ("density", "specific_heat") and hasattr(item, "temperature")
            if isinstance(value, (float, tuple)) and (has_heat or not is_of_heat):
                times = _factor(declared[field.name].unit, by)
                is_list = isinstance(value, tuple)
                changed[field.name] = tuple(times * v for v in value) if is_list else times * value
        elif is_dataclass(value):
            changed[field.name] = _scaled(value, by)
        elif isinstance(value, tuple) and value and is_dataclass(value[0]):
            changed[field.name] = tuple(_scaled(part, by) for part in value)
    return replace(item, **changed)


def _answers(rotor, by):
    """Answers, each in the units of a machine that is not scaled."""
    mass, length, time = by
    speed, stiffness = 400.0 / time, mean_stiffness(rotor)
    rest = static(rotor, speed)
    stable = level_1(rotor, speed, stiffness=[0.0])
    diagram = campbell(rotor, [0.5 * speed, speed, 1.5 * speed], count=2)
    shown = critical_map(rotor, stiffness * np.array([0.1, 1.0, 10.0]), count=2)
    return {
        "deflection": rest.y / length,
        "load": rest.load_y * time**2 / (mass * length),
        "eigenvalues": modes(rotor, speed, count=4).eigenvalues * time,
        "whirl": [c.speed * time for c in diagram.critical],
        "threshold": diagram.threshold and diagram.threshold * time,
        "map": shown.speeds * time,
        "stiffness": stiffness * time**2 / mass,
        "log dec": stable.log_dec_alone,
        "q": stable.threshold and stable.threshold * time**2 / mass,
    }


@pytest.mark.parametrize("name", [pytest.param("oil_film", marks=pytest.mark.slow), "newkirk"])
def test_answers_do_not_depend_on_the_size_of_a_machine(name):
    rotor = example(name)
    expected, found = _answers(rotor, (1, 1, 1)), _answers(_scaled(rotor, _SMALLER), _SMALLER)
    for key, value in expected.items():
        if value is None:
            assert found[key] is None, key
        else:
            scale = np.nanmax(np.abs(value), initial=math.ulp(1.0))
            np.testing.assert_allclose(found[key], value, rtol=1e-6, atol=1e-9 * scale, err_msg=key)
