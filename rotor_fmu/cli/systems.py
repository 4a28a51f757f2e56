"""`rotor-fmu ssp`."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from ..cosimulation import ALGORITHMS
from ..errors import InputError, check_one_of, writable_folder
from ..model.kernels.library import here
from ..output_options import with_output_options
from ..units import in_si
from .fmus import Native
from .shared import RotorFile, warned
from .speeds import one_speed


@with_output_options
def ssp(
    rotor: RotorFile = None,
    is_native: Native = False,
    tau_max: Annotated[
        str,
        typer.Option(metavar="TORQUE", help="Torque limit of the motor, such as 5kN.m, or in N.m."),
    ] = "0.2",
    target: Annotated[
        str | None,
        typer.Option(
            help="Speed to run up to, in rad/s, or with rpm or Hz added; default: the machine's "
            "rated speed."
        ),
    ] = None,
    step: Annotated[
        str, typer.Option(metavar="TIME", help="Communication step, in s or such as 1ms.")
    ] = "0.002",
    stop: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="End of the run, in s or such as 2min; default: one and a half times the run-up "
            "at the machine's rate.",
        ),
    ] = None,
    algorithm: Annotated[
        str, typer.Option(help=f"How libcosim steps: {' or '.join(ALGORITHMS)}.")
    ] = ALGORITHMS[0],
    out: Annotated[Path, typer.Option(help="Folder for the files.")] = Path("out/system"),
) -> dict[str, Any]:
    """Write a machine and a drive train as one system, for masters: SSP, and OSP with power bonds.

    Writes both FMUs, System.ssp and OspSystemStructure.xml in the folder.
    """
    # imported when it is called: the help needs none of it
    from ..cosimulation.coupling import Coupling
    from ..cosimulation.system import Component, drive_system
    from ..examples import example_folder
    from ..fmi.packing.machine_files import machine_of
    from ..fmi.packing.native_fmu import build_native
    from ..fmi.packing.python_fmu import build as build_python
    from ..machine_file.loading import load_rotor
    from ..operating_speeds import operating_speeds

    toml, machine = load_rotor(rotor)
    speeds = operating_speeds(machine)
    speed = speeds.rated if target is None else one_speed(target, "--target")
    if not abs(speed) <= 1e6:
        raise InputError(f"--target {target}: must be at most 1e+06 rad/s in size")
    if stop is None:  # of a machine that is kept at rest: any
        stop = f"{1.5 * abs(speed) / speeds.run_up_rate or 1.0:.3g}"
    torque, interval = in_si("--tau-max", tau_max, "N.m"), in_si("--step", step, "s")
    end = in_si("--stop", stop, "s")
    for given, value, most, unit in (
        (f"--tau-max {tau_max}", torque, 1e6, "N.m"),
        (f"--step {step}", interval, 1.0, "s"),
        (f"--stop {stop}", end, 1e6, "s"),
    ):
        if not 0 < value <= most:
            raise InputError(f"{given}: must be > 0 and at most {most:g} {unit}")
    if interval > end:
        raise InputError(f"--step {interval:g} s: must be at most --stop = {end:g} s")
    check_one_of(f"--algorithm {algorithm}", algorithm, ALGORITHMS)
    platform = here()
    if is_native and platform is None:
        raise InputError("--native: there is no library for this machine")
    folder, warnings = writable_folder(out), warned(machine)
    coupling = Coupling(example_folder("drive_train") / "drive_train.py")
    fmu = (
        build_native(folder, toml, platforms=[str(platform)])
        if is_native
        else build_python(folder, toml)
    )
    values = {"tau_max": torque, "w_target": speed, "w_start": 0.0, "ramp": speeds.run_up_rate}
    if algorithm == "ecco":  # whose longer steps need a load that goes on
        values["continuation"] = 1.0
    drive = Component("drive", coupling.build(folder), coupling.variables, values)
    system = drive_system(machine_of(toml, False, 0), drive, fmu, interval, end)
    package, structure = replace(system, algorithm=algorithm).write(folder)
    typer.echo(f"{package}\n{structure}")
    return {
        "ssp": package,
        "osp": structure,
        "rotor": fmu,
        "drive": drive.fmu,
        "warnings": warnings,
    }
