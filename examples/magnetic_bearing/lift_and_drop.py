"""A compressor is lifted by its magnetic bearings, passes its critical speed, is switched off and
caught by its touchdown bearings.

With the controller's sample time as the communication step a Jacobi master does what a digital
controller does: it reads, computes for a sample, and holds the result over the next.

    python lift_and_drop.py [--speed RAD/S] [--step SECONDS] [--volts VOLTS] [--out FOLDER]
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from matplotlib.figure import Figure
from rich.console import Console
from rich.progress import Progress, TimeRemainingColumn
from rotor_fmu.examples import copy_system_files

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import CoupledRun
from rotor_fmu.errors import InputError, writable_folder
from rotor_fmu.errors import run as run_app
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import fmu_in
from rotor_fmu.output_options import with_output_options, write_json
from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, new_panels, save
from rotor_fmu.runs.run_files import clear

HERE = Path(__file__).resolve().parent
COUPLING = Coupling(HERE / "magnetic_bearing.py")
# what is recorded beside what the FMUs exchange
OF_THE_CONTROL = ("left_ixa", "left_ixb", "left_iya", "left_iyb", "work")
OF_THE_ROTOR = (
    "energy.external_work", "energy.drive_work", "energy.kinetic", "energy.races",
    "energy.friction_loss", "energy.contact_loss", "energy.housing_loss", "energy.drag_loss",
    "energy.structure_loss", "energy.residual", "body[1].x_amp", "body[2].x_amp",
    "touchdown_bearing[1].x", "touchdown_bearing[1].y", "touchdown_bearing[1].fn",
    "touchdown_bearing[1].race", "touchdown_bearing[2].x", "touchdown_bearing[2].y",
    "touchdown_bearing[2].fn", "touchdown_bearing[2].race", "touchdown_bearing[1].fn_peak",
)  # fmt: skip
CLEARANCE = 0.25e-3  # of the touchdown bearings [m]
_LIFTED = 0.15  # how much of the lift is shown [s]
_BEFORE = 0.01  # of the drop that is shown before the switch-off [s]
TARGET, RAMP = 1400.0, 500.0  # of the run-up: [rad/s], [rad/s2]
LIFT, RUN, SETTLED, CAUGHT = 0.02, 0.2, 0.4, 0.6  # instants and spans of a run [s]
STEP = 1e-4  # the controller's sample time [s]
VOLTS = 150.0
RESULTS = ("summary.json", "run_up.png", "orbit.png", "drop.png")
_console = Console(stderr=True)


@with_output_options
def magnetic_bearing(
    speed: Annotated[float, typer.Option(help="Speed to reach, in rad/s.")] = TARGET,
    step: Annotated[float, typer.Option(help="Sample time of the controller, in s.")] = STEP,
    volts: Annotated[float, typer.Option(help="Voltage limit of the amplifiers, in V.")] = VOLTS,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "out/magnetic_bearing"
    ),
) -> dict[str, Any]:
    """Lift a compressor by its magnetic bearings, run it up, switch them off and let it drop.

    Leaves both FMUs, the system files of the example and pictures in the folder.
    """
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
    fmus = COUPLING.build(out), rotor_in(out)
    copy_system_files(HERE, out)
    off = RUN + speed / RAMP + SETTLED
    parameters = {
        "t_lift": LIFT, "t_run": RUN, "t_off": off, "w_target": speed, "ramp": RAMP, "u_max": volts
    }  # fmt: skip
    columns = (*Progress.get_default_columns()[:-1], TimeRemainingColumn())
    with Progress(*columns, console=_console, transient=True) as bar:
        task = bar.add_task("magnetic bearings", total=off + CAUGHT)
        coupled = couple(
            *fmus, off + CAUGHT, step, parameters, {}, lambda t: bar.update(task, completed=t)
        )
    save(run_up_figure(coupled, off), out / "run_up.png")
    save(orbit_figure(coupled, off), out / "orbit.png")
    save(drop_figure(coupled, off), out / "drop.png")
    report = summary(coupled, off)
    write_json(report, out / "summary.json")
    typer.echo(_in_words(report, out))
    return report | {"out": str(out)}


def rotor_in(out: Path) -> Path:
    """The compressor's FMU in the folder `out`, built if it is not there or not up to date."""
    toml = (HERE / "compressor.toml").read_text(encoding="utf-8")
    return fmu_in(out, machine_of(toml, is_free=True))


def couple(
    control_fmu: Path,
    rotor_fmu: Path,
    stop: float,
    step: float,
    control: dict[str, float],
    rotor: dict[str, float],
    progress: Callable[[float], None] = lambda t: None,
) -> CoupledRun:
    """Run both FMUs to `stop` [s] with the communication step `step` [s] and parameters by name;
    the rotor starts at rest in its touchdown bearings."""
    fmus = {"partner": control_fmu, "rotor": rotor_fmu}
    parameters = {"partner": control, "rotor": {"w_start": 0.0, **rotor}}
    recorded = {"partner": OF_THE_CONTROL, "rotor": OF_THE_ROTOR}
    return COUPLING.run(fmus, stop, step, parameters, recorded, progress)


def work_lost(run: CoupledRun) -> np.ndarray:
    """Work of the magnets less what the rotor took, at every sample but the last, shape (n - 1,)
    [J]."""
    return run["partner"]["work"][1:] - run["rotor"]["energy.external_work"][:-1]


def summary(run: CoupledRun, off: float) -> dict[str, Any]:
    """Figures of a run that is switched off at a time [s]."""
    t, rotor = run.t, run["rotor"]
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
        "peak_rad_per_s": float(rotor["w"][peak]),
        "peak_um": _um(rotor["body[1].x_amp"][peak]),
        "speed_at_switch_off_rad_per_s": at_off["w"],
        "first_contact_s": float(t[touch][0] - off) if touch.any() else None,
        "largest_force_N": float(rotor["touchdown_bearing[1].fn_peak"][dropped].max()),
        "deepest_um": _um(radius.max()),
        "race_speed_rad_per_s": last["touchdown_bearing[1].race"],
        "end_speed_rad_per_s": last["w"],
        "lost_in_the_drop_J": sum(last[name] - at_off[name] for name in losses),
        "ledger_open_by_J": last["energy.residual"] - at_off["energy.residual"],
        "work_lost_between_FMUs_J": float(np.abs(work_lost(run)).max()),
        "largest_work_J": float(np.abs(run["partner"]["work"]).max()),
    }


def _um(length: float) -> float:
    return float(length) * 1e6


def _in_words(f: dict[str, Any], out: Path) -> str:
    contact = f["first_contact_s"]
    fell = "not within the run" if contact is None else f"after {1e3 * contact:.2f} ms"
    return (
        f"lifted by {f['lifted_um']:.0f} um; the first impeller swings widest at "
        f"{f['peak_rad_per_s']:.0f} rad/s, by {f['peak_um']:.0f} um\n"
        f"switched off at {f['speed_at_switch_off_rad_per_s']:.0f} rad/s: first contact {fell}, "
        f"at most {f['largest_force_N']:.0f} N\n"
        f"in the end the race turns at {f['race_speed_rad_per_s']:.0f} rad/s, the rotor at "
        f"{f['end_speed_rad_per_s']:.0f} rad/s; {f['lost_in_the_drop_J']:.1f} J lost, energy "
        f"balance closes within {abs(f['ledger_open_by_J']):.1e} J\n"
        f"lost between the FMUs: at most {f['work_lost_between_FMUs_J']:.1e} J of "
        f"{f['largest_work_J']:.2g} J of work\n"
        f"written to {out}"
    )


def run_up_figure(run: CoupledRun, off: float) -> Figure:
    """The lift with the coils' currents; amplitudes over the speed."""
    figure, (lift, currents, swing) = new_panels(6.4, 7.6, 3)
    first = run.t < _LIFTED
    t = 1e3 * run.t[first]
    lift.plot(t, 1e6 * run["rotor"]["left_magnet.y"][first], color=BLUE)
    lift.set(ylabel="Height y [µm]", xlim=(0, t[-1]))
    lift.set_title("Lifted out of the touchdown bearings", loc="left", fontsize=10)
    for name, colour, label in (("a", BLUE, "upper coil"), ("b", ORANGE, "lower coil")):
        currents.plot(t, run["partner"][f"left_iy{name}"][first], color=colour, label=label)
    currents.set(ylabel="Current [A]", xlabel="Time [ms]", xlim=(0, t[-1]))
    currents.legend(frameon=False)
    up = (run.t > _LIFTED) & (run.t < off)
    for name, colour, label in (
        ("body[1].x_amp", BLUE, "first impeller"),
        ("body[2].x_amp", ORANGE, "motor"),
    ):
        swing.plot(run["rotor"]["w"][up], 1e6 * run["rotor"][name][up], color=colour, label=label)
    swing.set(xlabel="Speed [rad/s]", ylabel="Amplitude X [µm]", xlim=(0, None), ylim=(0, None))
    swing.set_title("Run-up", loc="left", fontsize=10)
    swing.legend(frameon=False, loc="upper left")
    return figure


def orbit_figure(run: CoupledRun, off: float) -> Figure:
    """The journal in its left race after the drop, coloured by the time."""
    figure, axes = new_figure(5.6, 4.8)
    down = run.t >= off
    x, y = (1e3 * run["rotor"][f"touchdown_bearing[1].{axis}"][down] for axis in "xy")
    angle = np.linspace(0, 2 * math.pi, 200)
    gap = 1e3 * CLEARANCE
    axes.plot(gap * np.cos(angle), gap * np.sin(angle), color=GREY)
    axes.plot(x, y, color=GREY, linewidth=0.4)
    dots = axes.scatter(x, y, c=1e3 * (run.t[down] - off), s=3, cmap="viridis", zorder=3)
    axes.annotate("switched off", (x[0], y[0]), (0.03, 0.03), color=ORANGE)
    axes.set(xlabel="x in the race [mm]", ylabel="y in the race [mm]", aspect="equal")
    figure.colorbar(dots, label="time since the switch-off [ms]")
    return figure


def drop_figure(run: CoupledRun, off: float) -> Figure:
    """Speeds of rotor and races, contact force, and where the energy goes, over the time."""
    figure, (speed, force, energy) = new_panels(6.4, 7.2, 3, share_x=True)
    shown = run.t > off - _BEFORE
    t, rotor = 1e3 * (run.t[shown] - off), {k: v[shown] for k, v in run["rotor"].items()}
    speed.plot(t, rotor["w"], color=GREY, label="rotor")
    speed.plot(t, rotor["touchdown_bearing[1].race"], color=BLUE, label="left race")
    speed.plot(t, rotor["touchdown_bearing[2].race"], "--", color=ORANGE, label="right race")
    speed.set(ylabel="Speed [rad/s]")
    force.plot(t, rotor["touchdown_bearing[1].fn"], color=BLUE, lw=0.7, label="left race")
    force.plot(
        t, run["partner"]["left_fy"][shown], color=GREEN, lw=1.2, label="left magnet, upwards"
    )
    force.set(ylabel="Force [N]")
    for name, colour, label in (
        ("friction_loss", ORANGE, "lost to friction"),
        ("races", BLUE, "in the races"),
        ("drag_loss", GREY, "lost to the races' drag"),
    ):
        energy.plot(
            t, rotor[f"energy.{name}"] - rotor[f"energy.{name}"][0], color=colour, label=label
        )
    energy.set(ylabel="Energy [J]", xlabel="Time since the switch-off [ms]")
    for axes in (speed, force, energy):
        axes.legend(frameon=False)
    return figure


app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
app.command()(magnetic_bearing)


def main() -> None:
    """Run the example with the arguments of the command line."""
    run_app(app)


if __name__ == "__main__":
    main()
