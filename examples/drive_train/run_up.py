"""A motor with ample torque runs the rotor up, one with too little hangs; and how well the two FMUs
agree on the power that crosses from one to the other.

    python run_up.py [--ample TORQUE] [--small TORQUE] [--step SECONDS] [--out FOLDER]
"""

import math
from dataclasses import dataclass
from hashlib import sha256
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
from rotor_fmu.plotting.figure_style import new_panels, save
from rotor_fmu.runs.run_files import clear

HERE = Path(__file__).resolve().parent
COUPLING = Coupling(HERE / "drive_train.py")
# what is recorded beside what the FMUs exchange
OF_THE_DRIVE = ("phi", "w_motor", "tau_motor", "tau_coupling", "work_motor", "work_out")
OF_THE_ROTOR = ("tau", "energy.drive_work", "disc[3].x_amp", "disc[3].y_amp", "J")
TARGET, RAMP = 400.0, 10.0  # of the run-up: [rad/s], [rad/s2]
AMPLE, SMALL = 0.2, 0.032  # torque limits [N.m]
AMPLE_STOP, SMALL_STOP = 50.0, 220.0  # [s]
STEP = 0.002  # communication step of the run-ups [s]
# The study of the residual: communication steps [s], and the length of its runs [s].
STUDIED, STUDY_STOP = (0.008, 0.004, 0.002, 0.001), 1.0
CONTINUATIONS = ("held", "linear")
RESULTS = ("summary.json", "run_up.png", "power.png")
_MEAN_OVER = 0.5  # window of the mean load torque [s]
_console = Console(stderr=True)


@dataclass(frozen=True)
class RunUp:
    """A coupled run to make: its title, end [s], communication step [s], and parameters."""

    title: str
    stop: float
    step: float
    drive: dict[str, float]
    rotor: dict[str, float]


@with_output_options
def drive_train(
    ample: Annotated[float, typer.Option(help="Torque limit that passes, in N.m.")] = AMPLE,
    small: Annotated[float, typer.Option(help="Torque limit that does not, in N.m.")] = SMALL,
    step: Annotated[float, typer.Option(help="Communication step, in seconds.")] = STEP,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/drive_train"),
) -> dict[str, Any]:
    """Run the rotor up by a motor with ample torque and by one with too little.

    Leaves both FMUs, the system files of the example and pictures in the folder. Runs that an
    earlier, stopped call finished are taken from it.
    """
    for name, value in (("--ample", ample), ("--small", small)):
        if not 0 < value <= 100:
            raise InputError(f"{name} {value:g} N.m: must be > 0 and at most 100")
    if small >= ample:
        raise InputError(f"--small {small:g} N.m: must be below --ample = {ample:g} N.m")
    if not 1e-4 <= step <= 0.02:
        raise InputError(f"--step {step:g} s: must lie between 0.0001 and 0.02")
    clear(writable_folder(out), RESULTS)
    fmus = COUPLING.build(out), fmu_in(out, machine_of())
    copy_system_files(HERE, out)
    cases = {
        "ample": RunUp(f"{ample:g} N.m", AMPLE_STOP, step, {"tau_max": ample}, {}),
        "small": RunUp(f"{small:g} N.m", SMALL_STOP, step, {"tau_max": small}, {}),
    }
    runs = {name: _stored(out, fmus, name, case) for name, case in cases.items()}
    study = {
        name: [_stored(out, fmus, f"{name}-{h:g}", _studied(ample, name, h)) for h in STUDIED]
        for name in CONTINUATIONS
    }
    save(run_up_figure(runs, ample, small), out / "run_up.png")
    save(power_figure(study), out / "power.png")
    report = summary(runs, study)
    write_json(report, out / "summary.json")
    typer.echo(_in_words(report, out))
    return report | {"out": str(out)}


def _studied(ample: float, continuation: str, step: float) -> RunUp:
    drive = {"tau_max": ample, "continuation": float(CONTINUATIONS.index(continuation))}
    title = f"{continuation}, {1e3 * step:g} ms"
    return RunUp(title, STUDY_STOP, step, drive, {"solver.tolerance": 1e-4})


def _stored(out: Path, fmus: tuple[Path, Path], name: str, case: RunUp) -> CoupledRun:
    """A run from its file, or made now and put there whole."""
    key = sha256(b"".join(fmu.read_bytes() for fmu in fmus) + repr(case).encode()).hexdigest()[:12]
    path = out / "runs" / f"{name}-{key}.npz"
    if path.exists():
        return CoupledRun.load(path)
    path.parent.mkdir(exist_ok=True)
    columns = (*Progress.get_default_columns()[:-1], TimeRemainingColumn())
    with Progress(*columns, console=_console, transient=True) as bar:
        task = bar.add_task(f"drive train, {case.title}", total=case.stop)
        coupled = couple(
            *fmus,
            case.stop,
            case.step,
            case.drive,
            case.rotor,
            lambda t: bar.update(task, completed=t),
        )
    coupled.save(path)
    return coupled


def couple(
    drive_fmu: Path,
    rotor_fmu: Path,
    stop: float,
    step: float,
    drive: dict[str, float],
    rotor: dict[str, float],
    *progress: Any,
) -> CoupledRun:
    """Run both FMUs to `stop` [s] with the communication step `step` [s] and parameters by name."""
    fmus = {"partner": drive_fmu, "rotor": rotor_fmu}
    recorded = {"partner": OF_THE_DRIVE, "rotor": OF_THE_ROTOR}
    return COUPLING.run(fmus, stop, step, {"partner": drive, "rotor": rotor}, recorded, *progress)


def hz_of(run: CoupledRun) -> np.ndarray:
    """Speed of the rotor [Hz], shape (n,)."""
    return run["partner"]["w"] / (2 * np.pi)


def residual(run: CoupledRun) -> np.ndarray:
    """Energy lost between the FMUs: what left the drive train less what the rotor took, shape (n,)
    [J]."""
    return run["partner"]["work_out"] - run["rotor"]["energy.drive_work"]


def mean_load(run: CoupledRun) -> tuple[np.ndarray, np.ndarray]:
    """Speed [Hz] and load torque [N.m] averaged over windows of half a second: work done on the
    rotor less its kinetic energy of rotation, by the angle turned."""
    every = round(_MEAN_OVER / (run.t[1] - run.t[0]))
    at = slice(None, None, every)
    w, phi = run["partner"]["w"][at], run["partner"]["phi"][at]
    work = run["rotor"]["energy.drive_work"][at] - 0.5 * run["rotor"]["J"][0] * w**2
    turned = np.diff(phi)
    moving = turned > math.pi
    hz = (w[1:] + w[:-1]) / (4 * math.pi)
    return hz[moving], np.diff(work)[moving] / turned[moving]


def peak_hz(run: CoupledRun, axis: str) -> float:
    """Speed at which disc 3 swings widest along an axis [Hz]."""
    return float(hz_of(run)[np.argmax(run["rotor"][f"disc[3].{axis}_amp"])])


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def orders(runs: list[CoupledRun]) -> list[float]:
    """Order at which the energy residual falls from each communication step to the next."""
    lost = np.array([rms(residual(run)) for run in runs])
    return (np.log(lost[:-1] / lost[1:]) / np.log(np.divide(STUDIED[:-1], STUDIED[1:]))).tolist()


def summary(runs: dict[str, CoupledRun], study: dict[str, list[CoupledRun]]) -> dict[str, Any]:
    """Figures of the run-ups and of the study of the residual."""
    report: dict[str, Any] = {}
    for name, run in runs.items():
        report[name] = {
            "end_hz": float(hz_of(run)[-1]),
            "end_acceleration_hz_per_s": float(
                (hz_of(run)[-1] - hz_of(run)[-501]) / (run.t[-1] - run.t[-501])
            ),
            "end_x_um": float(run["rotor"]["disc[3].x_amp"][-1]) * 1e6,
            "work_J": float(run["partner"]["work_out"][-1]),
            "largest_residual_J": float(np.abs(residual(run)).max()),
        }
    report["x_peak_hz"], report["y_peak_hz"] = (peak_hz(runs["ample"], axis) for axis in "xy")
    hz, torque = mean_load(runs["ample"])
    report["largest_load_Nm"] = float(torque.max())
    report["load_at_x_peak_Nm"] = float(np.interp(report["x_peak_hz"], hz, torque))
    for name, coupled in study.items():
        report[name] = {
            "step_s": STUDIED,
            "rms_residual_J": [rms(residual(run)) for run in coupled],
            "order": orders(coupled),
        }
    return report


def _in_words(report: dict[str, Any], out: Path) -> str:
    lines = []
    for name in ("ample", "small"):
        f = report[name]
        lines.append(
            f"{name:8s} ends at {f['end_hz']:.2f} Hz, X = {f['end_x_um']:.0f} um; "
            f"{f['work_J']:.4g} J crossed, at most {f['largest_residual_J']:.2g} J lost"
        )
    for name in CONTINUATIONS:
        shown = ", ".join(f"{order:.2f}" for order in report[name]["order"])
        lines.append(f"{name:8s} torque: the residual falls with order {shown}")
    return "\n".join([*lines, f"written to {out}"])


def run_up_figure(runs: dict[str, CoupledRun], ample: float, small: float) -> Figure:
    """Speed over time of both run-ups; below, why: the load torque against the torque limit."""
    figure, (top, low) = new_panels(6.4, 6.4, 2)
    end, peak = max(run.t[-1] for run in runs.values()), peak_hz(runs["ample"], "x")
    for name, color, limit in (("ample", BLUE, ample), ("small", ORANGE, small)):
        label = f"motor with {1e3 * limit:g} N mm"
        top.plot(runs[name].t[::50], hz_of(runs[name])[::50], color=color, lw=1.6, label=label)
    for line in (top.axhline, low.axvline):
        line(peak, color=GREY, lw=1.0, ls="--", label=f"widest horizontally: {peak:.1f} Hz")
    top.set_xlim(0, end)
    top.set_ylim(bottom=0)
    top.set_xlabel("Time [s]")
    top.set_ylabel("Rotational speed n [Hz]")
    top.set_title("Run-up by two motors", loc="left", fontsize=10)
    top.legend(frameon=False)

    hz, torque = mean_load(runs["ample"])
    low.plot(hz, 1e3 * torque, color=BLUE, lw=1.6, label="load: friction and whirl")
    low.axhline(1e3 * small, color=ORANGE, lw=1.6, label="limit of the small motor")
    last = hz_of(runs["small"])[-1]
    label = f"where it is after {runs['small'].t[-1]:g} s: {last:.1f} Hz"
    low.plot(last, 1e3 * small, "o", color=ORANGE, ms=8, mec="white", label=label, clip_on=False)
    low.set_xlim(0, max(*hz, last))
    low.set_ylim(0, 1.25e3 * max(torque.max(), small))
    low.set_xlabel("Rotational speed n [Hz]")
    low.set_ylabel("Torque [N mm]")
    low.legend(frameon=False)
    return figure


def power_figure(study: dict[str, list[CoupledRun]]) -> Figure:
    """Power at both sides of the coupling between the FMUs, and the energy lost there against the
    communication step."""
    figure, (left, right) = new_panels(8.6, 3.8, 1, 2)
    run = study["held"][0]
    out_of, into = run["partner"]["tau_coupling"], run["rotor"]["tau"]
    left.plot(
        run.t, out_of * run["partner"]["w"], color=BLUE, lw=1.6, label="out of the drive train"
    )
    left.plot(
        run.t[::4],
        (into * run["partner"]["w"])[::4],
        "o",
        color=ORANGE,
        ms=4,
        mew=0,
        label="into the rotor",
    )
    left.set_xlabel("Time [s]")
    left.set_ylabel("Power [W]")
    left.set_title(
        f"Both sides, communication step {1e3 * STUDIED[0]:g} ms", loc="left", fontsize=10
    )
    left.legend(frameon=False)
    h = np.array(STUDIED)
    for name, color, order in (("held", ORANGE, 1), ("linear", GREEN, 2)):
        lost = np.array([rms(residual(c)) for c in study[name]])
        right.loglog(1e3 * h, lost, "o", color=color, label=f"torque {name}")
        right.loglog(
            1e3 * h,
            lost[-1] * (h / h[-1]) ** order,
            "--",
            color=color,
            lw=1.0,
            label=f"order {order}",
        )
    right.set_xticks(1e3 * h, [f"{1e3 * x:g}" for x in h])
    right.minorticks_off()
    right.set_xlabel("Communication step [ms]")
    right.set_ylabel("Energy residual, rms [J]")
    right.set_title("What is lost between the FMUs", loc="left", fontsize=10)
    right.legend(frameon=False)
    return figure


app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
app.command()(drive_train)


def main() -> None:
    """Run the example with the arguments of the command line."""
    run_app(app)


if __name__ == "__main__":
    main()
