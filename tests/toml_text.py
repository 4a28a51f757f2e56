"""Tables of machine and study files, as text, and what is said of a file that is refused."""

import json

import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.quantities import QuantityError


def refusal_of(toml):
    """The one line with which a machine file is refused."""
    with pytest.raises(QuantityError) as refused:
        parse_rotor(toml)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def table(heading, **keys):
    """A TOML table; heading: its name, in brackets `[name]` where it is one of a list."""
    lines = [f"{_key(key)} = {_value(value)}\n" for key, value in keys.items()]
    return f"[{heading}]\n{''.join(lines)}"


def _key(name):
    return name if name.isidentifier() else json.dumps(name)


def _value(value):
    if isinstance(value, dict):
        pairs = ", ".join(f"{_key(key)} = {_value(each)}" for key, each in value.items())
        return f"{{ {pairs} }}"
    return json.dumps(value)
