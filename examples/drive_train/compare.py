"""Ways to couple a motor with the rotor through a stiff shaft, over communication steps: how far
the speed is off, what energy the joint loses, what it costs.

    python compare.py [--stop SECONDS] [--out FOLDER]

The motor is an inertia with a torque, the shaft between it and the rotor a spring with a damper:

    J_motor w_motor' = torque - tau,    tau = k (phi_motor - phi) + c (w_motor - w)

The rotor's FMU takes tau. The reference is a monolithic run, as one program would make it: motor,
shaft and rotor in steps of 20 us, in each of which the torque is linear and its end iterated until
the shaft's law holds. Where libcosim is installed its ECCO is held against its fixed steps, with
the same motor and shaft as an FMU (`motor_on_shaft.py`).
"""

import math
import shutil
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import fmpy
import numpy as np
import typer
from rotor_fmu.examples.drive_train.by_energy import by_energy, motor_and_rotor
from rotor_fmu.examples.drive_train.ways import (
    DAMPING,
    FINE,
    J_MOTOR,
    METHODS,
    START,
    STIFFNESS,
    TORQUE,
    couple,
    reference,
)
from rotor_fmu.model.kernels.library import here
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.errors import InputError, writable_folder
from rotor_fmu.errors import run as run_app
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.output_options import with_output_options, write_json

STEPS = (1e-5, 1e-4, 5e-4, 3e-3, 1.5e-2, 2e-2)  # communication steps [s]
EVERY = 6e-2  # a multiple of each, at which speeds are compared [s]
TOLERANCES = (1e-5, 1e-6)  # of ECCO: energy that a step may lose [J]


@with_output_options
def compare(
    stop: Annotated[float, typer.Option(help="End of the run-up, in seconds.")] = 4.2,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/coupling"),
) -> dict[str, Any]:
    """Compare ways to couple a motor with the rotor over communication steps."""
    if not 0.1 <= stop <= 60:
        raise InputError(f"--stop {stop:g} s: must lie between 0.1 and 60")
    platform = here()
    if platform is None:
        raise InputError("there is no native FMU for this machine")
    stop = EVERY * math.ceil(stop / EVERY - 1e-9)
    fmu = build_native(
        writable_folder(out), machine_of(rig_toml(), is_free=True), platforms=[platform]
    )
    folder = fmpy.extract(str(fmu))
    try:
        expected = reference(folder, stop)
        at = slice(round(EVERY / FINE) - 1, None, round(EVERY / FINE))
        rows = [_row(folder, name, h, stop, expected[at]) for name in METHODS for h in STEPS]
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    frequency = math.sqrt(STIFFNESS * (1.0 / J_MOTOR + 1.0 / 0.00954))
    head = f"{'way':26s} {'step':>8s} {'w H':>6s} {'speed off':>10s} {'lost':>9s}"
    typer.echo(f"{head} {'steps':>8s} {'time':>7s}")
    for row in rows:
        typer.echo(
            f"{row['way']:26s} {1e3 * row['step_s']:5g} ms {frequency * row['step_s']:6.2g} "
            f"{row['speed_error']:10.2g} {row['lost']:9.2g} {row['advances']:8d} "
            f"{row['seconds']:5.1f} s"
        )
    report: dict[str, Any] = {
        "stop_s": stop,
        "ends_at_rad_per_s": float(expected[-1]),
        "rows": rows,
    }
    if find_spec("libcosimpy"):
        report["ecco"] = [_by_energy(out, tolerance, stop, expected) for tolerance in TOLERANCES]
    else:
        typer.echo("ECCO is left out: libcosimpy is not installed")
    write_json(report, out / "coupling.json")
    return report | {"out": str(out)}


def _by_energy(out: Path, tolerance: float, stop: float, expected: np.ndarray) -> dict[str, Any]:
    """Hold ECCO against as many fixed steps, say so, and return the figures."""
    given = {"w_start": START, "torque": TORQUE, "J": J_MOTOR, "k": STIFFNESS, "c": DAMPING}
    ecco, fixed = by_energy(motor_and_rotor(out, given), tolerance, stop)
    result: dict[str, Any] = {"tolerance_J": tolerance}
    for name, run in (("ECCO", ecco), ("fixed steps", fixed)):
        shortest, longest = run.steps
        error = run.error(expected, FINE)
        result[name] = {
            "steps": len(run.t),
            "speed_error": error,
            "lost": run.lost,
            "shortest_s": shortest,
            "longest_s": longest,
            "seconds": run.seconds,
        }
        typer.echo(
            f"libcosim, {name:11s} {len(run.t):7d} steps of {1e3 * shortest:.3g} to "
            f"{1e3 * longest:.3g} ms: speed off {error:.2g}, lost {run.lost:.2g}, "
            f"{run.seconds:.1f} s"
        )
    return result


def _row(folder: str, name: str, h: float, stop: float, expected: np.ndarray) -> dict[str, Any]:
    made = couple(folder, name, h, stop, EVERY)
    error = np.max(np.abs(made.w - expected) / expected)
    return {
        "way": name,
        "step_s": h,
        "speed_error": float(error) if np.isfinite(error) else math.inf,
        "lost": float(made.lost) if np.isfinite(made.lost) else math.inf,
        "advances": made.advances,
        "seconds": made.seconds,
    }


app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
app.command()(compare)


def main() -> None:
    """Run the comparison with the arguments of the command line."""
    run_app(app)


if __name__ == "__main__":
    main()
