"""Tables of machine and study files, as text."""

import json


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
