"""Linear answers, which take contacts as open, say where the shaft lies in them at rest."""

import pytest

from ..toml_text import table

STIFFNESS, MASS, GRAVITY = 1e5, 20.0, 9.81
SAG = MASS * GRAVITY / (2.0 * STIFFNESS)  # [m] of a short shaft on two springs


def machine(clearance, **wall):
    support = {"stiffness": STIFFNESS, "damping": 10.0}
    tables = (
        table("material", young=2.1e14, density=1e-3),
        table("shaft", nodes=[0.0, 0.1, 0.2], diameters=[0.1, 0.1]),
        table("[body]", node=2, mass=MASS, I_d=0.1, I_p=0.2, e=1e-5),
        *(table("[support]", node=node, **support) for node in (1, 3)),
        table("[contact]", node=2, journal_radius=0.05, clearance=clearance, mu=0.1, k=1e7, **wall),
    )
    return "\n".join(tables)


@pytest.mark.parametrize(
    ("arguments", "share", "wall", "lies"),
    [
        (["static"], 0.99, {}, True),
        (["static"], 1.01, {}, False),
        (["static"], 0.99, {"wear": 1e-4}, False),
        (["modes"], 0.99, {}, True),
        (["modes", "--contacts", "pinned"], 0.99, {}, False),
    ],
)
def test_the_command_says_so(arguments, share, wall, lies, command, tmp_path):
    path = tmp_path / "machine.toml"
    path.write_text(machine(share * SAG, **wall))
    said = command(*arguments, "--rotor", str(path))
    sizes = f"{1e6 * SAG:.5g} um", f"{1e6 * share * SAG:.5g} um"
    assert ("lies in contacts" in said) == lies
    assert not lies or (f"contact[1] with a sag of {sizes[0]}" in said and sizes[1] in said)
