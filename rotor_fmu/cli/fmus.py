"""`rotor-fmu build`, `ssp` and `library`."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..cosimulation import ALGORITHMS, check_steps
from ..errors import InputError, check_one_of, writable_folder
from ..fmi.packing.python_fmu import SYSTEMS
from ..library.build import library
from ..library.platforms import COMPONENT, DRAFT, LIBRARIES, PLATFORMS, WASM
from ..model.kernels.library import here
from ..model.settings.table import BY_NAME, Number
from ..output_options import with_output_options
from ..units import in_si
from .shared import Free, RotorFile, warned

if TYPE_CHECKING:
    from ..fmi.packing.machine_files import Machine

_CARRIED = 1.05  # of the lowest speed at which films carry a machine, which is known to percents
_ONE_OF = f"One of {', '.join(PLATFORMS)}, or here: this machine's"
Platforms = Annotated[
    list[str] | None,
    typer.Option(
        "--platform",
        help=f"One of {', '.join(LIBRARIES)}, or here: this machine's; default: all. "
        f"{WASM.name} is what a page carries.",
    ),
]
Carried = Annotated[
    list[str] | None,
    typer.Option(
        "--platform",
        help=f"{_ONE_OF}. Default: all with --native, otherwise those of "
        f"{' and '.join(SYSTEMS)} whose library exists. With --native --fmi 3 also "
        f"{COMPONENT.name}, a WebAssembly component, experimental: as the working draft of "
        f"FMI-LS-WASM of {DRAFT.day} {DRAFT:%B %Y} has it.",
    ),
]
Native = Annotated[
    bool,
    typer.Option("--native", help="Build the FMU that needs no Python, RotorBearingNative.fmu."),
]


@with_output_options
def build(
    rotor: RotorFile = None,
    is_free: Free = False,
    is_native: Native = False,
    is_source: Annotated[bool, typer.Option("--source")] = False,
    fmi: int = 2,
    platforms: Carried = None,
    reduction: Annotated[int, typer.Option(min=0)] = 0,
    realtime: str | None = None,
    sets: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE")] = None,
    out: Path = Path(),
) -> dict[str, Any]:
    """Build the FMU of a machine, driven by its speed or by a torque, with or without Python.

    is_source: Build the FMU of C source, RotorBearingSource.fmu, which its host compiles.
    fmi: Version of FMI: 2, or, with --native or --source, 3.
    reduction: Component modes of the shaft (solver.reduction, fixed in the FMU); 0: no reduction.
    realtime: With --native or --source: an FMU for real time with this fixed step, such as 0.05ms
        (preset realtime, solver.h); a number without unit is in s.
    sets: Start value of a solver parameter or of a choice in the FMU, such as
        solver.preset=robust, for hosts that cannot set it; repeatable.
    out: Folder for the FMU.
    """
    # imported when it is called: the help needs none of it
    from ..fmi.packing.fmu_kinds import FmuKind
    from ..fmi.packing.machine_files import machine_of
    from ..machine_file.loading import load_rotor
    from ..runs.settings_text import parse_starts

    toml, machine = load_rotor(rotor)
    kind = FmuKind(is_native, is_source, fmi)
    chosen_step = None if realtime is None else f"--realtime {realtime}"
    options = ("--native", "--source", "--platform")
    kind.check(f"--fmi {fmi}", chosen_step, platforms or (), options)
    step = None if realtime is None else _step(realtime)
    starts = parse_starts(machine, is_free, sets or ())
    names = _known(platforms, kind.platforms)
    chosen = machine_of(toml, is_free, reduction, step, starts)
    folder, result = writable_folder(out), warned(machine, is_free)
    fmu = kind.build(folder, chosen, names)
    typer.echo(fmu)
    return {"fmu": fmu, "bytes": fmu.stat().st_size, "warnings": result}


@with_output_options
def ssp(
    rotor: RotorFile = None,
    is_native: Native = False,
    tau_max: Annotated[str | None, typer.Option(metavar="TORQUE")] = None,
    target: str | None = None,
    step: Annotated[str, typer.Option(metavar="TIME")] = "0.002",
    stop: Annotated[str | None, typer.Option(metavar="TIME")] = None,
    algorithm: Annotated[
        str, typer.Option(help=f"How libcosim steps: {' or '.join(ALGORITHMS)}.")
    ] = ALGORITHMS[0],
    out: Path = Path("out/system"),
) -> dict[str, Any]:
    """Write a machine and a drive train as one system, for masters: SSP, and OSP with power bonds.

    Writes both FMUs, System.ssp and OspSystemStructure.xml in the folder.

    tau_max: Torque limit of the motor, such as 5kN.m, or in N.m; default: 1.9 times what the
        machine's rate of run-up takes without load.
    target: Speed to run up to, in rad/s, or with rpm or Hz added; default: the machine's rated
        speed.
    step: Communication step, in s or such as 1ms.
    stop: End of the run, in s or such as 2min; default: one and a half times the run-up at the
        machine's rate.
    out: Folder for the files.
    """
    # imported when it is called: the help needs none of it
    from ..cosimulation.coupling import Coupling
    from ..cosimulation.system import Component, drive_system, falls_short
    from ..examples import example_folder
    from ..fmi.packing.machine_files import NATIVE, machine_of
    from ..fmi.packing.native_fmu import build_native
    from ..fmi.packing.python_fmu import build as build_python
    from ..machine_file.loading import load_rotor
    from ..operating_speeds import operating_speeds

    toml, _ = load_rotor(rotor)
    machine = machine_of(toml)
    speeds = operating_speeds(machine.rotor)
    speed = speeds.rated if target is None else in_si("--target", target, "rad/s")
    if not abs(speed) <= 1e6:
        given = target or f"= {speed:g} rad/s, the machine's rated speed"
        raise InputError(f"--target {given}: must be at most 1e+06 rad/s in size")
    whose = "" if stop else ", one and a half times the run-up at the machine's rate"
    if stop is None:  # of a machine that is kept at rest: any
        stop = f"{1.5 * abs(speed) / speeds.run_up_rate or 1.0:.3g}"
    interval, end = in_si("--step", step, "s"), in_si("--stop", stop, "s")
    start, no_rest = _start(machine, speed)
    values = {"w_target": speed, "w_start": start, "ramp": speeds.run_up_rate}
    if tau_max is not None:
        values["tau_max"] = in_si("--tau-max", tau_max, "N.m")
    for given, value, most, unit in (
        (f"--tau-max {tau_max}", values.get("tau_max", 1.0), 1e6, "N.m"),
        (f"--step {step}", interval, 1.0, "s"),
        (f"--stop {stop}{whose}", end, 1e6, "s"),
    ):
        if not 0 < value <= most:
            raise InputError(f"{given}: must be > 0 and at most {most:g} {unit}")
    if interval > end:
        raise InputError(f"--step {interval:g} s: must be at most --stop = {end:g} s{whose}")
    check_steps(f"--step {step}", f"--stop = {end:g} s{whose}", end / interval)
    check_one_of(f"--algorithm {algorithm}", algorithm, ALGORITHMS)
    platform = here()
    if is_native and platform is None:
        raise InputError("--native: there is no library for this machine")
    coupling = Coupling(example_folder("drive_train") / "drive_train.py")
    own = f"{machine.identifier(NATIVE if is_native else '')}.fmu"
    if own.lower() == coupling.fmu_name.lower():  # some file systems know no capitals
        raise InputError(f"{own}: is the drive's FMU; give the machine another name or identifier")
    folder, warnings = writable_folder(out), warned(machine.rotor, is_free=True)
    fmu = (
        build_native(folder, machine, platforms=[str(platform)])
        if is_native
        else build_python(folder, machine)
    )
    if algorithm == "ecco":  # whose longer steps need a load that goes on
        values["continuation"] = 1.0
    drive = Component("drive", coupling.build(folder), coupling.variables, values)
    system = drive_system(machine, drive, fmu, interval, end)
    for doubt in filter(None, (no_rest, falls_short(system.components[0], end))):
        typer.echo(f"warning: {doubt}", err=True)
        warnings.append(doubt)
    package, structure = replace(system, algorithm=algorithm).write(folder)
    typer.echo(f"{package}\n{structure}")
    return {
        "ssp": package,
        "osp": structure,
        "rotor": fmu,
        "drive": drive.fmu,
        "warnings": warnings,
    }


@with_output_options
def libraries(platforms: Platforms = None) -> dict[str, Any]:
    """Build the solver library of each platform ahead of runs, FMUs and pages.

    Without it the first run compiles the solver, once on this machine, and `build` makes
    the libraries that it needs.
    """
    names = _known(platforms, tuple(LIBRARIES)) or list(LIBRARIES)
    made = {name: library(LIBRARIES[name]) for name in names}
    for library_file in made.values():
        typer.echo(library_file)
    return made


def _start(machine: "Machine", target: float) -> tuple[float, str]:
    """Return the speed [rad/s] at which a machine starts on its way to a target, 0 if it can, and
    why it is not 0; or why it cannot start at all."""
    from ..model.linear.static import lowest_speed

    reason = _no_start(machine, 0.0)
    carried = float(f"{_CARRIED * lowest_speed(machine.rotor, target):.2g}") if reason else 0.0
    if not carried or _no_start(machine, carried):
        return 0.0, reason and f"the system cannot start at 0 rad/s: {reason}"
    return carried, f"the system starts at {carried:g} rad/s; at 0 rad/s it has {reason}"


def _no_start(machine: "Machine", speed: float) -> str:
    """Say why a machine cannot start at a speed [rad/s]; empty where it can."""
    from ..fmi.binding import build_simulation
    from ..fmi.variables import start_values
    from ..model.simulation import EquilibriumError

    values = start_values(machine.table) | {"speed": speed}
    try:
        build_simulation(machine.rotor, machine.table, values, lambda message: None)
    except EquilibriumError as error:
        return str(error)
    return ""


def _step(text: str) -> float:
    step, setting = in_si("--realtime", text, "s"), BY_NAME["h"]
    assert isinstance(setting, Number)
    if not setting.rule.allows(step):
        raise InputError(f"--realtime {text}: {setting.rule.words}")
    return step


def _known(platforms: list[str] | None, allowed: tuple[str, ...]) -> list[str]:
    mine = here()
    if platforms and "here" in platforms and mine is None:
        raise InputError("--platform here: there is no library for this machine")
    known = (*allowed, "here") if mine in allowed else allowed
    for name in platforms or ():
        check_one_of(f"--platform {name}", name, known)
    return [mine if name == "here" and mine else name for name in platforms or ()]
