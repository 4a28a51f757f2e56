"""Friction of a rub by contact angle: the closed form, ours, and that of ROSS' own file.

    python -m benchmarks.rub_laws [--file .../ross/faults/rubbing.py]

A journal pressed against its stator turns from x towards y. Its friction is mu N against the motion
of its surface, the same at every angle. Of ROSS the function that computes the force is taken out
of its file and run as it is, so that none of its dependencies is needed.
"""

import ast
import math
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts import LAWS
from rotor_fmu.model.parts.clearance_contact import CLEARANCE_CONTACT
from rotor_fmu.model.parts.law import Kinematics
from rotor_fmu.model.structure.assembly import assemble

_ANGLES = tuple(range(0, 360, 45))
_FILE, _FUNCTION = "ross/faults/rubbing.py", "compute_rubbing_force"
_OMEGA, _PRESSED = 100.0, 1e-5  # rad/s; m beyond the clearance


class Friction(NamedTuple):
    """Friction at an angle [deg], along the surface's motion and outward, over mu N [1]."""

    angle: float
    tangential: float
    radial: float


def closed_form() -> list[Friction]:
    """Coulomb's law: against the motion, nothing outward."""
    return [Friction(angle, -1.0, 0.0) for angle in _ANGLES]


def ours() -> list[Friction]:
    """The force of the rig's first bearing, without its normal part."""
    machine = rig()
    part = machine.bearings[0]
    record = assemble(machine).laws[LAWS.index(CLEARANCE_CONTACT)][0]
    result = []
    for angle in _ANGLES:
        outward = complex(math.cos(math.radians(angle)), math.sin(math.radians(angle)))
        at = (part.clearance + _PRESSED) * outward
        force = interpreted(CLEARANCE_CONTACT.force)(
            record, np.zeros(0), Kinematics(at, 0j, _OMEGA, _OMEGA, 0.0), np.zeros(0)
        )
        along = force / outward
        normal = part.k * _PRESSED
        friction = part.mu * normal
        result.append(Friction(angle, along.imag / friction, (along.real + normal) / friction))
    return result


def of_ross(file: Path) -> list[Friction]:
    """The friction that ROSS' function gives."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    function = next(
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.name == _FUNCTION
    )
    known: dict[str, Any] = {"np": np}
    exec(compile(ast.Module([function], []), str(file), "exec"), known)
    k, mu, clearance = 1e7, 0.1, 1e-4
    fault = SimpleNamespace(
        shaft_elem=SimpleNamespace(odl=0.02), delta=clearance, contact_stiffness=k,
        contact_damping=0.0, friction_coeff=mu, torque=False,
    )  # fmt: skip
    result = []
    for angle in _ANGLES:
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        at = np.zeros(12)
        at[:2] = (clearance + _PRESSED) * c, (clearance + _PRESSED) * s
        moving = np.zeros(12)
        moving[:2] = 1e-15 * c, 1e-15 * s  # it divides by the velocity
        x, y = known[_FUNCTION](fault, at, moving, _OMEGA)[:2]
        normal = k * _PRESSED
        along, outward = (y * c - x * s) / (mu * normal), (x * c + y * s + normal) / (mu * normal)
        result.append(Friction(angle, along, outward))
    return result


def installed() -> tuple[Path, str] | None:
    """ROSS' file and version, if it is installed."""
    try:
        found = distribution("ross-rotordynamics")
    except PackageNotFoundError:
        return None
    return Path(str(found.locate_file(_FILE))), found.version


def table(columns: dict[str, list[Friction]]) -> str:
    """The comparison as Markdown, over mu N."""
    heads = [f"{name}, {part}" for name in columns for part in ("tangential", "radial")]
    lines = [f"| angle [deg] | {' | '.join(heads)} |", "| ---" * (1 + len(heads)) + " |"]
    for i, angle in enumerate(_ANGLES):
        each = [of[i] for of in columns.values()]
        values = (value for friction in each for value in friction[1:])
        cells = [f"{round(value, 9) + 0.0:.2f}" for value in values]
        lines.append(f"| {angle} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main(
    file: Annotated[
        Path | None, typer.Option(help="ROSS' rubbing.py, where it is not installed.")
    ] = None,
) -> None:
    """Print the friction by angle, in the closed form, here, and of ROSS."""
    columns = {"closed form": closed_form(), "rotor-fmu": ours()}
    there = (file, "of the file given") if file else installed()
    if there:
        columns[f"ROSS {there[1]}"] = of_ross(there[0])
    typer.echo(table(columns))
    if not there:
        typer.echo("ROSS is not installed: pip install --no-deps ross-rotordynamics==2.3.0")


if __name__ == "__main__":
    typer.run(main)
