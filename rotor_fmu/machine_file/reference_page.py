"""docs/reference/machine.md: all tables and keys of a machine file."""

from ..cells import markdown_table
from .declared_tables import Key, Table, own_tables, part_tables

_HEAD = """# A machine file

A machine is one TOML file: a material, a shaft, and parts on it and beside it. This
page is made from the declarations that the reader itself uses (`rotor-fmu schema --page`); for
editors that check TOML, `rotor-fmu schema` prints the same as a JSON schema.

```sh
rotor-fmu example drop > machine.toml      # one that comes with it
rotor-fmu show --rotor machine.toml        # a picture, and whether it can be read
rotor-fmu modes --rotor machine.toml       # trust its linear answers first
rotor-fmu run-down --rotor machine.toml    # then let it rub
```

A key marked *FMU* is a parameter of the machine's FMU, called `table[i].key`; a study or a response
may vary any other single number of a part by such a name too. What is missing,
misspelt or impossible is refused in one line with the name, the value and what is allowed.

## Units

A number is in SI units, or has a unit behind it: `"0.1 mm"`, `"3000 rpm"`, `"50 g.mm"`,
`"30e6 psi"`. `units = { speed = "rpm", kxx = "MN/m" }` in a table is for all plain numbers of that
name. Speeds in rpm and Hz are always read, other units by pint (`pip install "rotor-fmu[units]"`).
`units = "us"` at the head of the file, or `"rpm, mil, pp"`, says in which units tables and pictures
are shown.

## Names and places

Every part may have a `name`, which its variables and pictures then have; the variables of a
`[[housing]]` are those of `housing[1]`, `housing[2]` and so on. A part at `z` between two nodes
puts a node there; `node` counts those of the shaft as it is written.

## How it is run

`run-down` begins at the trip speed of `[operation]`, `run-up` ends at the maximum continuous speed,
an FMU starts at the rated speed. Of speeds that are not given the rated one is twice the lowest
natural frequency, to two digits, and the others follow it; a rate that is not given takes 1273
turns.

## Rest and friction

A run begins at rest under gravity and the loads at the start, without friction. Where a bore is
worn opposite the load, the place below the load is a hump, and the machine begins beside it, on
the right if both sides are alike.

The friction of a contact is smoothed below the sliding speed `v_s`, so that a journal at rest
under a side load creeps at a share of `v_s`, however small the load is. With a tangential stiffness
`k_t`, about that of the contact, it sticks: it yields by the load over `k_t` as long as that is
below `mu` times the normal force, and slides beyond. `c_t` damps it while it sticks; `v_s` is not
used. The ledger has the spring's energy in `compression`, and what is lost in `friction`. The race
of a touchdown bearing is stuck to in the same way; its own drag stays smoothed below `race_w_s`.
"""


def page() -> str:
    """Return the page in Markdown."""
    lines = [_HEAD]
    for table in (*own_tables(), *part_tables()):
        lines += _section(table)
    return "\n".join(lines)


def _section(table: Table) -> list[str]:
    heading = f"## `{table.heading}`" if table.heading else "## The machine itself"
    several = " Any number." if table.is_list else ""
    text = f"{table.text[0].upper()}{table.text[1:].rstrip('.')}.{several}"
    lines = [heading, "", text, ""]
    if table.keys:
        heads = ("key", "unit", "default", "what it is", "allowed")
        lines += [markdown_table(heads, map(_row, table.keys)), ""]
    return lines


def _row(key: Key) -> tuple[str, ...]:
    quantity = key.quantity
    unit = "" if quantity is None or quantity.unit == "1" else quantity.unit
    default = "(needed)" if key.is_needed else _default_text(key.default)
    if quantity is not None:
        allowed = (
            "true or false" if quantity.is_switch else quantity.rule.words.removeprefix("must be ")
        )
        allowed += ", or a list of such" if quantity.may_be_list else ""
    else:
        word = "a word of letters, digits and _, no digit first"
        allowed = ", ".join(key.choices) or (word if key.kind == "word" else key.kind)
    mark = " *FMU*" if quantity is not None and quantity.is_parameter else ""
    return f"`{key.name}`", unit, default, f"{key.text}{mark}", allowed


def _default_text(default: object) -> str:
    if default is None or default == ():
        return ""
    if isinstance(default, bool):
        return str(default).lower()
    return f"{default:g}" if isinstance(default, (int, float)) else f"`{default}`"
