"""`rotor-fmu magnetic-bearing`: a compressor is lifted, passes its critical speed, is switched
off and caught by its touchdown bearings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress, TimeRemainingColumn

from ..errors import InputError, writable_folder
from ..telling import tells

TARGET, RAMP = 1400.0, 500.0  # of the run-up: [rad/s], [rad/s2]
LIFT, RUN, SETTLED, CAUGHT = 0.02, 0.2, 0.4, 0.6  # instants and spans of a run [s]
STEP = 1e-4  # the controller's sample time [s]
VOLTS = 150.0
RESULTS = ("summary.json", "run_up.png", "orbit.png", "drop.png")
_console = Console(stderr=True)


@tells
def magnetic_bearing(
    speed: Annotated[float, typer.Option(help="Speed to reach, in rad/s.")] = TARGET,
    step: Annotated[float, typer.Option(help="Sample time of the controller, in s.")] = STEP,
    volts: Annotated[float, typer.Option(help="Voltage limit of the amplifiers, in V.")] = VOLTS,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "out/magnetic_bearing"
    ),
) -> dict[str, Any]:
    """Couple a compressor with its magnetic bearings: lift, run up, switch off, drop, be caught.

    Leaves both FMUs, the system files of the example and pictures in the folder.
    """
    from ..coupled.partner import lay_out
    from ..runs.job import clear, write_json
    from .figures import write_pictures
    from .system import build_control, couple, example, rotor_in

    if not 0 < speed <= 2000:
        raise InputError(f"--speed {speed:g} rad/s: must be > 0 and at most 2000")
    if not 1e-5 <= step <= 1.5e-4:
        raise InputError(
            f"--step {step:g} s: must lie between 1e-05 and 0.00015; the loop of a slower "
            "controller is not stable"
        )
    if not 0 < volts <= 1000:
        raise InputError(f"--volts {volts:g} V: must be > 0 and at most 1000")
    clear(writable_folder(out), RESULTS)
    fmus = build_control(out), rotor_in(out)
    lay_out(example(), out)
    off = RUN + speed / RAMP + SETTLED
    parameters = {
        "t_lift": LIFT, "t_run": RUN, "t_off": off, "w_target": speed, "ramp": RAMP, "u_max": volts
    }  # fmt: skip
    columns = (*Progress.get_default_columns()[:-1], TimeRemainingColumn())
    with Progress(*columns, console=_console, transient=True) as bar:
        task = bar.add_task("magnetic bearings", total=off + CAUGHT)
        run = couple(
            *fmus, off + CAUGHT, step, parameters, {}, lambda t: bar.update(task, completed=t)
        )
    write_pictures(run, off, out)
    report = summary(run, off)
    write_json(report, out / "summary.json")
    typer.echo(_in_words(report, out))
    return report | {"out": str(out)}


def summary(run: Any, off: float) -> dict[str, Any]:
    """Figures of a run, a `Levitated`, that is switched off at a time [s]."""
    t, rotor = run.t, run.rotor
    up = t < off
    dropped = ~up
    peak = int(np.argmax(np.where(up, rotor["body[1].x_amp"], 0.0)))
    touch = dropped & (rotor["touchdown_bearing[1].fn"] > 0)
    last = {name: float(values[-1]) for name, values in rotor.items()}
    at_off = {name: float(values[dropped][0]) for name, values in rotor.items()}
    losses = [name for name in rotor if name.endswith("_loss")]
    radius = np.hypot(rotor["touchdown_bearing[1].x"], rotor["touchdown_bearing[1].y"])
    return {
        "lifted_um": _um(rotor["left_magnet.y"][up][-1] - rotor["left_magnet.y"][0]),
        "critical_speed_rad_per_s": float(rotor["w"][peak]),
        "peak_um": _um(rotor["body[1].x_amp"][peak]),
        "speed_at_switch_off_rad_per_s": at_off["w"],
        "first_contact_s": float(t[touch][0] - off) if touch.any() else None,
        "largest_force_N": float(rotor["touchdown_bearing[1].fn"][dropped].max()),
        "deepest_um": _um(radius.max()),
        "race_speed_rad_per_s": last["touchdown_bearing[1].race"],
        "end_speed_rad_per_s": last["w"],
        "lost_in_the_drop_J": sum(last[name] - at_off[name] for name in losses),
        "ledger_open_by_J": last["energy.residual"] - at_off["energy.residual"],
        "work_lost_between_FMUs_J": float(np.abs(run.work_lost).max()),
        "largest_work_J": float(np.abs(run.control["work"]).max()),
    }


def _um(length: float) -> float:
    return float(length) * 1e6


def _in_words(f: dict[str, Any], out: Path) -> str:
    contact = f["first_contact_s"]
    fell = "not within the run" if contact is None else f"after {1e3 * contact:.2f} ms"
    return (
        f"lifted by {f['lifted_um']:.0f} um; critical speed passed at "
        f"{f['critical_speed_rad_per_s']:.0f} rad/s with {f['peak_um']:.0f} um\n"
        f"switched off at {f['speed_at_switch_off_rad_per_s']:.0f} rad/s: first contact {fell}, "
        f"at most {f['largest_force_N']:.0f} N\n"
        f"in the end the race turns at {f['race_speed_rad_per_s']:.0f} rad/s, the rotor at "
        f"{f['end_speed_rad_per_s']:.0f} rad/s; {f['lost_in_the_drop_J']:.1f} J lost, ledger open "
        f"by {abs(f['ledger_open_by_J']):.1e} J\n"
        f"between the FMUs at most {f['work_lost_between_FMUs_J']:.1e} J of "
        f"{f['largest_work_J']:.2g} J went astray\n"
        f"written to {out}"
    )
