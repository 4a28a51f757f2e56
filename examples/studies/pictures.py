"""Pictures of this folder's studies, from the folders that hold their rows.

python pictures.py FOLDER_OF_STUDIES [FOLDER for the pictures]

The first holds a folder a study, named after its file: bifurcation_clearance, hysteresis, ...
"""

import math
from pathlib import Path

import numpy as np
import xarray
from matplotlib.colors import LogNorm
from rotor_fmu.examples import script_arguments
from scipy.optimize import brentq

from rotor_fmu import studies
from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save
from rotor_fmu.studies.analysis import analyse, design_of, drawn_rows
from rotor_fmu.studies.design import Design
from rotor_fmu.studies.store import about_of

# The whipping Jeffcott rotor: damping, stiffness of the stator, radius over clearance, spin [rad/s]
ZETA, BETA, RADIUS, OMEGA = 0.05, 20.0, 50.0, 100.0
_COLOURS = (GREY, BLUE, ORANGE, GREEN)


def fold(mu: float, e: float, beta: float = 4.0, zeta: float = 0.1) -> float:
    """Speed, in natural frequencies, up to which the full annular rub exists.

    The quadratic for its radius has a double root there. e: eccentricity in clearances.
    """

    def discriminant(speed: float) -> float:
        s, d = 1 + beta - speed**2, 2 * zeta * speed + mu * beta
        b = beta * (s + mu * d)
        return b * b - (s * s + d * d) * ((1 + mu**2) * beta**2 - (e * speed**2) ** 2)

    speeds = np.linspace(1.5, 4.0, 2001)
    signs = np.sign([discriminant(speed) for speed in speeds])
    last = np.flatnonzero(signs[:-1] * signs[1:] < 0)[0]
    return brentq(discriminant, speeds[last], speeds[last + 1])


def rolling_friction(v: np.ndarray) -> np.ndarray:
    """Friction that backward rolling needs, against V = spin radius / clearance in natural
    frequencies; nan where it lies inside the clearance."""
    omega = (-BETA + np.sqrt(BETA**2 + 4 * v**2 * (1 + BETA))) / (2 * v)
    r = v / omega
    return np.where(r > 1, 2 * ZETA * omega / (BETA * (1 - 1 / np.maximum(r, 1 + 1e-9))), np.nan)


def bifurcation(data: xarray.Dataset, varied: str, path: Path) -> None:
    """Where the disc is once a turn, over the speed, and its largest share off the turn."""
    values = np.unique(data[varied])
    figure, first = new_figure(7.2, 1.9 * len(values) + 0.5)
    first.remove()
    rows = np.atleast_1d(figure.subplots(len(values), 1, sharex=True))
    for axes, value in zip(rows, values, strict=True):
        chosen = data.where(data[varied] == value, drop=True)
        hz = chosen["run.speed"].values / (2 * math.pi)
        points = 1e6 * chosen.y.values
        axes.plot(np.repeat(hz, points.shape[1]), points.ravel(), ".", color=BLUE, ms=2.0, mew=0)
        axes.set_ylabel("Disc 3, y at\nthe mark [µm]")
        axes.set_title(f"{varied} {1e6 * value:.0f} µm", loc="left", fontsize=9)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#dddddd", linewidth=0.6)
    rows[-1].set_xlabel("Rotational speed n [Hz]")
    save(figure, path)


def full_spectrum(data: xarray.Dataset, varied: str, value: float, path: Path) -> None:
    """The full spectrum over the speed, at one value of what is varied."""
    figure, axes = new_figure(6.4, 4.2)
    chosen = data.where(abs(data[varied] - value) < 1e-9, drop=True).sortby("run.speed")
    hz, orders = chosen["run.speed"].values / (2 * math.pi), chosen["spectrum order"].values
    shown = np.maximum(1e6 * chosen.spectrum.values, 1e-2)
    mesh = axes.pcolormesh(orders, hz, shown, norm=LogNorm(1e-1, 500), cmap="cividis")
    axes.set(xlabel="Order of the speed, backward below 0 [-]", ylabel="Rotational speed n [Hz]")
    axes.set_title(f"{varied} {1e6 * value:.0f} µm", loc="left", fontsize=9)
    axes.grid(visible=False)
    figure.colorbar(mesh, label="Amplitude [µm]", extend="min")
    save(figure, path)


def hysteresis(data: xarray.Dataset, path: Path) -> None:
    """Jump speeds of run-up and run-down against friction, beside the fold."""
    figure, axes = new_figure()
    seen = data["contact[1].mu"].values
    frictions = np.linspace(seen.min(), seen.max(), 41)
    for colour, clearance in zip(
        _COLOURS[1:], np.unique(data["contact[1].clearance"]), strict=True
    ):
        chosen = data.where(data["contact[1].clearance"] == clearance, drop=True)
        exact = [fold(mu, 0.5e-3 / clearance) for mu in frictions]
        label = f"clearance {1e3 * clearance:.1f} mm"
        axes.plot(frictions, exact, color=colour)
        axes.plot(chosen["contact[1].mu"], chosen.fall / OMEGA, ">", color=colour, label=label)
        axes.plot(chosen["contact[1].mu"], chosen.rise / OMEGA, "<", color=colour, mfc="none")
    axes.plot([], [], color=GREY, label="closed form of the fold")
    axes.plot([], [], "<", color=GREY, mfc="none", label="stepped down: jump up")
    axes.set(xlabel="Coefficient of friction [-]", ylabel="Jump speed / natural frequency [-]")
    axes.set_title("Stepped up, the rub falls off the wall at its fold", loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8)
    save(figure, path)


def worst_of_fold(data: xarray.Dataset) -> float:
    """Largest relative difference between the jumps of the study and the fold [1]."""
    exact = [
        fold(float(mu), 0.5e-3 / float(clearance))
        for mu, clearance in zip(data["contact[1].mu"], data["contact[1].clearance"], strict=True)
    ]
    return float(np.abs(data.fall.values / OMEGA / exact - 1).max())


def tolerances(data: xarray.Dataset, design: Design, report: dict, path: Path) -> None:
    """Distribution of the peak, its limit, and what is to blame."""
    figure, first = new_figure(8.0, 3.6)
    first.remove()
    left, right = figure.subplots(1, 2)
    result = report["limits"]["X"]
    left.hist(1e6 * data.X.values[drawn_rows(design, data.run.values)], bins=30, color=BLUE)
    left.axvline(1e6 * result["limit"], color=ORANGE)
    left.set_title(f"{result['share']:.1%} of the rigs pass the limit", loc="left", fontsize=10)
    left.set(xlabel="Horizontal peak X of disc 3 [µm]", ylabel="Rigs [-]")
    indices = report["sensitivity"]["X"]["indices"]
    at = np.arange(len(indices))
    for shift, key, colour, label in (
        (-0.18, "S1", BLUE, "alone"),
        (0.18, "ST", ORANGE, "with all it acts with"),
    ):
        height = [row[key] for row in indices.values()]
        width = [row[f"{key}_conf"] for row in indices.values()]
        right.barh(at + shift, height, 0.34, xerr=width, color=colour, label=label, ecolor=GREY)
    right.set_yticks(at, list(indices))
    right.invert_yaxis()
    right.set_xlabel("Sobol index of X, with its 95 % interval [-]")
    right.legend(frameon=False, fontsize=8)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    save(figure, path)


def dry_whip(data: xarray.Dataset, path: Path) -> None:
    """Who whirls on after the kick, over friction and speed, beside the closed forms."""
    figure, axes = new_figure(6.4, 4.4)
    v = data["run.speed"].values / OMEGA * RADIUS
    mu, radius = data["contact[1].mu"].values, 1e3 * data.radius.values
    whips = radius > 0.5
    axes.plot(v[~whips], mu[~whips], ".", color="#cccccc", ms=3, label="comes to rest")
    dots = axes.scatter(v[whips], mu[whips], c=radius[whips], s=9, cmap="cividis", label="whips on")
    speeds = np.linspace(1.01, v.max(), 400)
    axes.plot(speeds, rolling_friction(speeds), color=ORANGE, label="friction that rolling needs")
    least = 2 * ZETA * math.sqrt(1 + BETA) / BETA
    axes.axhline(least, color=BLUE, ls="--", label=f"µ_c = {least:.4f}")
    axes.set(
        xlabel="Surface speed / (clearance x natural frequency), V [-]",
        ylabel="Coefficient of friction [-]",
        ylim=(mu.min() - 0.002, mu.max() + 0.002),
    )
    axes.legend(frameon=False, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
    figure.colorbar(dots, label="Radius of the whirl / clearance [-]")
    save(figure, path)


def on_the_wrong_side(data: xarray.Dataset) -> np.ndarray:
    """Friction over what the closed form asks for, of the dry rotors that end otherwise than it
    says."""
    v = data["run.speed"].values / OMEGA * RADIUS
    needed = np.nan_to_num(rolling_friction(v), nan=np.inf)
    share = data["contact[1].mu"].values / needed
    return share[(share > 1) != (data.radius.values > 0.5e-3)]


def motor(data: xarray.Dataset, path: Path) -> None:
    """Speed reached over torque and unbalance, and the smallest torque that passes."""
    figure, first = new_figure(9.0, 4.0)
    first.remove()
    left, right = figure.subplots(1, 2, width_ratios=(1.7, 1))
    values = np.unique(data.unbalance)
    for colour, value in zip((GREY, BLUE, GREEN, ORANGE, "black"), values, strict=True):
        chosen = data.where(data.unbalance == value, drop=True)
        label = f"unbalance {1e6 * value:.0f} µm"
        hz = chosen.w / (2 * math.pi)
        left.plot(1e3 * chosen["run.torque"], hz, "o-", color=colour, label=label, ms=4, lw=1)
    left.set(xlabel="Largest torque of the motor [N mm]", ylabel="Speed after 80 s [Hz]")
    left.set_title("Too small a motor hangs at a resonance", loc="left", fontsize=10)
    left.legend(frameon=False, fontsize=8)
    torques = np.array(list(smallest_torques(data).values()))
    tried = np.diff(np.unique(data["run.torque"]))[0]
    below = np.array([np.full(len(torques), tried), np.zeros(len(torques))])
    right.errorbar(1e6 * values, 1e3 * torques, 1e3 * below, fmt="o-", color=BLUE, capsize=3)
    right.set(xlabel="Unbalance [µm]", ylabel="Smallest torque above 38 Hz [N mm]", ylim=(0, None))
    right.set_title("What passes; down to the next tried", loc="left", fontsize=10)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#dddddd", linewidth=0.6)
    save(figure, path)


def smallest_torques(data: xarray.Dataset, least: float = 240.0) -> dict[float, float]:
    """By the unbalance [m]: the smallest torque of those tried that ends above a speed [N.m]."""
    return {
        float(value): float(
            data["run.torque"].where((data.unbalance == value) & (data.w > least)).min()
        )
        for value in np.unique(data.unbalance)
    }


def main(rows: str, out: str = "") -> None:
    """All pictures."""
    source, target = Path(rows), Path(out or rows)
    for varied in ("clearance", "unbalance"):
        data = studies.open(source / f"bifurcation_{varied}")
        bifurcation(data, varied, target / f"study_bifurcation_{varied}.png")
    full_spectrum(data, "unbalance", 80e-6, target / "study_spectrum.png")
    data = studies.open(source / "hysteresis")
    hysteresis(data, target / "study_hysteresis.png")
    print(f"jump up and fold differ by at most {worst_of_fold(data):.2%}")
    folder = source / "tolerances"
    design = design_of(about_of(folder)["design"])
    picture = target / "study_tolerances.png"
    tolerances(studies.open(folder), design, analyse(folder), picture)
    data = studies.open(source / "dry_whip")
    dry_whip(data, target / "study_dry_whip.png")
    wrong = on_the_wrong_side(data)
    print(
        f"{len(wrong)} of {data.sizes['run']} dry rotors against the closed form, with "
        f"{wrong.min():.2f} to {wrong.max():.2f} of the friction that it asks for"
    )
    data = studies.open(source / "motor")
    motor(data, target / "study_motor.png")
    for value, torque in smallest_torques(data).items():
        print(f"unbalance {1e6 * value:.0f} um: {1e3 * torque:.1f} N mm pass")


if __name__ == "__main__":
    main(*script_arguments(1))
