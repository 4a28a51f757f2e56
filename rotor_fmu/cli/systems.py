"""`rotor-fmu ssp`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from ..cosimulation import ALGORITHMS
from ..errors import InputError, writable_folder
from ..model.kernels.library import here
from ..output_options import with_output_options
from .fmus import Native
from .shared import RotorFile
from .speeds import one_speed

_DRIVE = "drive_train"


@with_output_options
def ssp(
    rotor: RotorFile = None,
    is_native: Native = False,
    tau_max: Annotated[float, typer.Option(help="Torque limit of the motor, in N.m.")] = 0.2,
    target: Annotated[
        str | None,
        typer.Option(
            help="Speed to run up to, in rad/s, or with rpm or Hz added; default: the machine's "
            "rated speed."
        ),
    ] = None,
    step: Annotated[float, typer.Option(help="Communication step, in seconds.")] = 0.002,
    stop: Annotated[
        float | None,
        typer.Option(
            help="End of the run, in seconds; default: one and a half times the run-up at the "
            "machine's rate."
        ),
    ] = None,
    algorithm: Annotated[
        str, typer.Option(help=f"How libcosim steps: {' or '.join(ALGORITHMS)}.")
    ] = ALGORITHMS[0],
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("out/system"),
) -> dict[str, Any]:
    """Write a machine and a drive train as one system, for masters: SSP, and OSP with power bonds.

    Leaves both FMUs, System.ssp and OspSystemStructure.xml in the folder.
    """
    # imported when it is called: the help needs none of it
    from ..cosimulation.coupling import example_coupling
    from ..cosimulation.system import Component, drive_system
    from ..fmi.packing.machine_files import machine_of
    from ..fmi.packing.native_fmu import build_native
    from ..fmi.packing.python_fmu import build as build_python
    from ..operation import operating_speeds
    from ..runs.job import load_rotor

    toml, machine = load_rotor(rotor)
    speeds = operating_speeds(machine)
    speed = speeds.rated if target is None else one_speed(target, "--target")
    if not abs(speed) <= 1e6:
        raise InputError(f"--target {target}: must be at most 1e+06 rad/s in size")
    if stop is None:  # of a machine that is kept at rest: any
        stop = float(f"{1.5 * abs(speed) / speeds.run_up_rate:.3g}") or 1.0
    for name, value, most in (
        ("--tau-max", tau_max, 1e6),
        ("--step", step, 1.0),
        ("--stop", stop, 1e6),
    ):
        if not 0 < value <= most:
            raise InputError(f"{name} {value:g}: must be > 0 and at most {most:g}")
    if algorithm not in ALGORITHMS:
        raise InputError(f"--algorithm {algorithm}: must be one of {', '.join(ALGORITHMS)}")
    platform = here()
    if is_native and platform is None:
        raise InputError("--native: there is no library for this machine")
    folder = writable_folder(out)
    coupling = example_coupling(_DRIVE)
    fmu = (
        build_native(folder, toml, platforms=[str(platform)])
        if is_native
        else build_python(folder, toml)
    )
    values = {"tau_max": tau_max, "w_target": speed, "w_start": 0.0, "ramp": speeds.run_up_rate}
    if algorithm == "ecco":  # whose longer steps need a load that goes on
        values["continuation"] = 1.0
    drive = Component("drive", coupling.build(folder), coupling.variables, values)
    system = drive_system(machine_of(toml, False, 0), drive, fmu, step, stop)
    package, structure = replace(system, algorithm=algorithm).write(folder)
    typer.echo(f"{package}\n{structure}")
    return {"ssp": package, "osp": structure, "rotor": fmu, "drive": drive.fmu}
