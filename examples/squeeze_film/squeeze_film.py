"""The rotor of this folder up and down through its jumps: response.png.

python squeeze_film.py [FOLDER for the picture]

Orbits over the clearance, speeds over the natural frequency, as the closed form has them.
"""

import math
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.body import Body
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save

HERE = Path(__file__).resolve().parent
MASS = 10.0  # kg
LOW, HIGH, SECONDS = 0.8, 1.9, 60.0  # of the sweeps [1], s
SAMPLES = 600


def rotor() -> Rotor:
    """The machine of this folder."""
    return parse_rotor((HERE / "rotor.toml").read_text(encoding="utf-8"))


def closed_form(orbit: np.ndarray) -> tuple[np.ndarray, float]:
    """The lower and the higher speed at which a rigid rotor has an orbit of that radius, shape
    (2, orbits), nan where there is none [1], and its natural frequency [rad/s].

    With B = 2 mu R L^3 / (m c^3 w_n) of two dampers and the unbalance U over the clearance,
    e^2 ((1 - s^2 + a s)^2 + (b s)^2) = U^2 s^4, a = 2 B e / (1 - e^2)^2,
    b = pi B / (2 (1 - e^2)^1.5).
    """
    machine = rotor()
    damper = machine.of_kind(SqueezeFilmDamper)[0]
    natural = math.sqrt(2.0 * damper.stiffness / MASS)
    disc = machine.of_kind(Body)[0]
    U = disc.mass * disc.e / MASS / damper.clearance
    share = damper.length / damper.clearance
    B = 2.0 * damper.viscosity * damper.journal_radius * share**3 / (MASS * natural)
    result = np.full((2, len(orbit)), np.nan)
    for i, e in enumerate(orbit):
        a, b = 2.0 * B * e / (1.0 - e**2) ** 2, math.pi * B / (2.0 * (1.0 - e**2) ** 1.5)
        roots = np.roots([1.0 - (U / e) ** 2, -2.0 * a, a * a - 2.0 + b * b, 2.0 * a, 1.0])
        real = roots[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0)].real
        result[: len(real), i] = np.sort(real)
    return result, natural


def folds() -> tuple[float, float]:
    """The orbits of the closed form at the jump with rising and with falling speed [1]."""
    orbit = np.linspace(0.5, 0.9, 20001)
    higher = closed_form(orbit)[0][1]
    lower_fold = int(np.nanargmin(higher[orbit < 0.8]))
    return float(orbit[lower_fold + np.nanargmax(higher[lower_fold:])]), float(orbit[lower_fold])


def sweep(low: float, high: float, seconds: float = SECONDS) -> np.ndarray:
    """Speeds over the natural frequency and the left ring's orbit over the clearance [1], shape
    (SAMPLES, 2), as the speed goes evenly from `low` to `high` [1]."""
    natural = closed_form(np.array([0.5]))[1]
    first, rate = low * natural, (high - low) * natural / seconds
    sim = Simulation(
        rotor(), choose("controlled", tolerance=1e-3), speed=first, warn=lambda _: None
    )
    rows = []
    for i in range(1, SAMPLES + 1):
        before, t = seconds * (i - 1) / SAMPLES, seconds * i / SAMPLES
        sim.advance(t, first + rate * before, rate=rate)
        eccentricity = sim.read("squeeze_film_damper[1].eccentricity")
        rows.append(((first + rate * t) / natural, eccentricity))
    return np.array(rows)


def draw(path: Path) -> None:
    """Both sweeps over the closed form."""
    figure, axes = new_figure(6.8, 4.4)
    orbit = np.linspace(0.05, 0.95, 9001)
    lower, higher = closed_form(orbit)[0]
    rising, falling = folds()
    is_between = (orbit > falling) & (orbit < rising)
    axes.plot(lower, orbit, color=GREY, lw=3.0, label="closed form, stable")
    axes.plot(np.where(is_between, np.nan, higher), orbit, color=GREY, lw=3.0)
    unstable = np.where(is_between, higher, np.nan)
    axes.plot(unstable, orbit, "--", color=GREY, lw=1.6, label="closed form, unstable")
    for ends, color, label in (
        ((LOW, HIGH), BLUE, "speed rising"),
        ((HIGH, LOW), ORANGE, "speed falling"),
    ):
        settled = sweep(*ends)[SAMPLES // 60 :]
        axes.plot(*settled.T, color=color, lw=1.0, label=label)
    axes.set_xlim(LOW, HIGH)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("Speed over the natural frequency [1]")
    axes.set_ylabel("Orbit over the clearance [1]")
    axes.legend(frameon=False, fontsize=8)
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """The picture, and where the closed form jumps."""
    draw(Path(out) / "response.png")
    speeds = closed_form(np.array(folds()))[0][1]
    print(f"folds of the closed form: {speeds[0]:.4f} (rising), {speeds[1]:.4f} (falling)")


if __name__ == "__main__":
    main(*script_arguments())
