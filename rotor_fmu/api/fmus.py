"""FMUs of machines: built, and driven through FMPy."""

import warnings
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import InputError, path_of, writable_folder
from ..model.arguments import check_one_of, check_positive, listed, mapped, number, switch
from ..model.simulation import RotorWarning, warn
from ..runs.recording import Recording
from ..runs.settings_text import parse_starts
from .machine import Machine, check_machine, parse
from .result import Result
from .simulate import Signal, plan

_MACHINE = "resources/rotor.toml"


def build_fmu(
    machine: Machine,
    folder: Path | str = ".",
    *,
    is_free: bool = False,
    is_native: bool = False,
    is_source: bool = False,
    fmi: int = 2,
    platforms: Sequence[str] | None = None,
    reduction: int = 0,
    step: float | None = None,
    parameters: Mapping[str, float | str] | None = None,
) -> Path:
    """Build a machine's FMU in a folder and return its path.

    Parameters
    ----------
    machine : Machine
        The machine, as `load` or `parse` returns it.
    folder : Path or str
        Where the FMU is written; it is made if need be.
    is_free : bool
        Whether a torque drives the rotor [N.m] instead of its speed [rad/s].
    is_native : bool
        Whether to build the FMU that needs no Python.
    is_source : bool
        Whether to build the FMU of C source, which its host compiles.
    fmi : int
        Version of FMI: 2, or, of an FMU that needs no Python, 3.
    platforms : sequence of str, optional
        Platforms whose libraries the FMU carries. By default all, or, of the FMU in Python, those
        of linux64 and win64 that are there. Only by name, and of FMI 3.0: wasm32-wasip2, a
        WebAssembly component, experimental.
    reduction : int
        Component modes to keep of the shaft; 0 keeps the whole shaft.
    step : float, optional
        Fixed step length of an FMU for real time [s], which needs no Python.
    parameters : mapping, optional
        Start values of solver parameters and of other choices by name, choices by their names too,
        as in `{"solver.preset": "robust"}`: for hosts that cannot set them.

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    InputError
        If an argument is not among those allowed, or a tool that makes C source or components is
        missing.
    LibraryError
        If a library is missing and cannot be made (`pip install "rotor-fmu[build]"`).

    Warns
    -----
    RotorWarning
        If nothing holds the machine, if it is unstable at rest, or if no torque can drive it.

    Examples
    --------
    >>> import tempfile, rotor_fmu as rf
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rf.build_fmu(rf.load(), folder).name
    'RotorBearing.fmu'
    """
    from ..fmi.packing.fmu_kinds import FmuKind
    from ..fmi.packing.machine_files import machine_of
    from ..linear.machine_warnings import machine_warnings

    check_machine(machine)
    if step is not None:
        check_positive("step", step := number("step", step), "s")
    number("reduction", reduction)  # its range is the FMU's
    is_free = switch("is_free", is_free)
    kind = FmuKind(switch("is_native", is_native), switch("is_source", is_source), fmi)
    chosen_step = None if step is None else f"step = {step:g} s"
    options = ("is_native", "is_source", "platforms")
    platforms = None if platforms is None else listed("platforms", platforms, "names")
    kind.check(f"fmi = {fmi}", chosen_step, platforms or (), options)
    for name in platforms or ():
        check_one_of(f"platforms: {name!r}", name, kind.platforms)
    try:
        given = [f"{name}={value}" for name, value in mapped("parameters", parameters).items()]
        starts = parse_starts(machine.rotor, is_free, given)
    except InputError as error:
        raise InputError(str(error).removeprefix("--set ")) from error
    for text in machine_warnings(machine.rotor, is_free):
        warnings.warn(RotorWarning(text), stacklevel=2)
    chosen = machine_of(machine.toml, is_free, reduction, step, starts)
    place = writable_folder(path_of("folder", folder), "folder =")
    return kind.build(place, chosen, platforms)


def simulate_fmu(
    fmu: Path | str,
    *,
    speed: Signal,
    loads: Mapping[str, Signal] | None = None,
    stop: float | None = None,
    preset: str | None = None,
    tolerance: float | None = None,
    parameters: Mapping[str, float | str] | None = None,
    step: float | None = None,
) -> Result:
    """Drive an FMU that `build_fmu` made, through FMPy.

    With the same step the numbers are those of `simulate`, unless loads vary or the speed bends: an
    FMU holds its loads, and continues its speed, from one communication point to the next.

    Parameters
    ----------
    fmu : Path or str
        The FMU, driven by a speed.
    speed, loads, stop, preset, tolerance, parameters, step
        As in `simulate`.

    Returns
    -------
    Result
        The outputs at the communication points, `step` [s] apart.

    Raises
    ------
    InputError
        If the file is not the FMU of a machine, or a torque drives it, or an argument cannot be.

    Warns
    -----
    RotorWarning
        If something makes the run doubtful, or it fails.

    Examples
    --------
    >>> import tempfile, rotor_fmu as rf
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     fmu = rf.build_fmu(rf.load(), folder)
    ...     result = rf.simulate_fmu(fmu, speed=185.0, stop=0.2, step=0.01)
    >>> len(result.t), f"{1e6 * result['disc[3].x_amp'][-1]:.0f} µm"
    (21, '331 µm')
    """
    file = path_of("fmu", fmu)
    try:
        with zipfile.ZipFile(file) as archive:
            toml = archive.read(_MACHINE).decode()
            is_free = b'name="tau_drive"' in archive.read("modelDescription.xml")
    except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(f"{file}: is not the FMU of a machine") from error
    if is_free:
        raise InputError(f"{file}: is driven by a torque; simulate_fmu drives by a speed")
    machine = parse(toml)
    job = plan(machine, speed, loads, stop, preset, tolerance, parameters, step)
    from ..runs.run_down import run_fmu

    run = run_fmu(file, job)
    for message in run.messages:
        warn(message)
    units = {name: machine.units[name] for name in run.columns}
    return Result(Recording(run.t, run.columns, units, job.about(run)), run, machine)
