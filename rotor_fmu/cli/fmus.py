"""`rotor-fmu build` and `rotor-fmu library`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError, check_one_of, writable_folder
from ..fmi.packing.python_fmu import SYSTEMS
from ..library.build import library
from ..library.platforms import COMPONENT, DRAFT, LIBRARIES, PLATFORMS, WASM
from ..model.kernels.library import here
from ..model.settings.table import BY_NAME, Number
from ..output_options import with_output_options
from ..units import in_si
from .shared import Free, RotorFile, warned

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
Source = Annotated[
    bool,
    typer.Option(
        "--source",
        help="Build the FMU of C source, RotorBearingSource.fmu, which its host compiles.",
    ),
]
Fmi = Annotated[
    int, typer.Option("--fmi", help="Version of FMI: 2, or, with --native or --source, 3.")
]
Reduction = Annotated[
    int,
    typer.Option(
        "--reduction",
        min=0,
        help="Component modes of the shaft (solver.reduction, fixed in the FMU); 0: no reduction.",
    ),
]
RealTime = Annotated[
    str | None,
    typer.Option(
        "--realtime",
        help="With --native or --source: an FMU for real time with this fixed step, such as 0.05ms "
        "(preset realtime, solver.h); a number without unit is in s.",
    ),
]
Starts = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="Start value of a solver parameter or of a choice in the FMU, such as "
        "solver.preset=robust, for hosts that cannot set it; repeatable.",
    ),
]


@with_output_options
def build(
    rotor: RotorFile = None,
    is_free: Free = False,
    is_native: Native = False,
    is_source: Source = False,
    fmi: Fmi = 2,
    platforms: Carried = None,
    reduction: Reduction = 0,
    realtime: RealTime = None,
    sets: Starts = None,
    out: Annotated[Path, typer.Option(help="Folder for the FMU.")] = Path(),
) -> dict[str, Any]:
    """Build the FMU of a machine, driven by its speed or by a torque, with or without Python."""
    # imported when it is called: the help needs none of it
    from ..fmi.packing.fmu_kinds import FmuKind
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
    folder, result = writable_folder(out), warned(machine, is_free)
    fmu = kind.build(folder, toml, is_free, reduction, names, step, starts)
    typer.echo(fmu)
    return {"fmu": fmu, "bytes": fmu.stat().st_size, "warnings": result}


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
