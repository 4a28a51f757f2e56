"""The rotor of this folder runs up through its threshold: cascade.png and orbit.png.

python oil_film.py [FOLDER for the pictures]
"""

import math
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.linear import campbell
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_panels, save

HERE = Path(__file__).resolve().parent
FROM, TO, SECONDS = 150.0, 1150.0, 8.0  # rad/s, s
EVERY = 2e-4  # s
CLEARANCE = 5e-5  # m
_WINDOW = 2048  # samples of a spectrum


def rotor() -> Rotor:
    """The machine of this folder."""
    return parse_rotor((HERE / "rotor.toml").read_text(encoding="utf-8"))


def run(low: float = FROM, high: float = TO, seconds: float = SECONDS) -> dict[str, np.ndarray]:
    """A run-up: time `t`, speed `w`, disc and left journal as x + i y, and the ledger."""
    sim = Simulation(rotor(), choose("controlled", tolerance=1e-3), speed=low, warn=lambda _: None)
    rate = (high - low) / seconds
    rows = []
    for i in range(1, round(seconds / EVERY) + 1):
        t = i * EVERY
        sim.advance(t, low + rate * (t - EVERY), rate=rate)
        z = complex(sim.read("body[1].x"), sim.read("body[1].y"))
        journal = complex(sim.motion.q[0])
        rows.append((t, low + rate * t, z, journal, sim.read("journal_bearing[1].film")))
    names = ("t", "w", "disc", "journal", "film")
    history = {n: np.array([row[k] for row in rows]) for k, n in enumerate(names)}
    history["residual"] = np.array([sim.read("energy.residual")])
    history["lost"] = np.array([sim.read("energy.film_loss")])
    return history


def spectra(
    history: dict[str, np.ndarray], lines: int = 60
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speeds [rad/s], frequencies [Hz] and amplitudes of the disc's forward motion [m]."""
    window = np.hanning(_WINDOW)
    begins = np.linspace(0, len(history["t"]) - _WINDOW, lines).astype(int)
    frequency = np.fft.fftfreq(_WINDOW, EVERY)
    forward = np.flatnonzero((frequency > 0) & (frequency < 220))
    rows, speeds = [], []
    for begin in begins:
        z = history["disc"][begin : begin + _WINDOW]
        rows.append(np.abs(np.fft.fft((z - z.mean()) * window))[forward] / window.sum())
        speeds.append(history["w"][begin + _WINDOW // 2])
    return np.array(speeds), frequency[forward], np.array(rows)


def draw_cascade(history: dict[str, np.ndarray], path: Path) -> None:
    """The spectra of the disc's forward motion over the speed, and the thinnest film."""
    speeds, frequency, rows = spectra(history)
    figure, (above, below) = new_panels(6.8, 6.8, 2, share_x=True)
    hertz = speeds / (2 * math.pi)
    level = 20 * np.log10(np.maximum(rows / 1e-6, 1e-2))
    mesh = above.pcolormesh(hertz, frequency, level.T, cmap="viridis", vmin=-20, vmax=50)
    figure.colorbar(mesh, ax=above, label="Amplitude of the disc [dB over 1 um]")
    above.plot(hertz, hertz, color="white", lw=0.8)
    above.plot(hertz, hertz / 2, color="white", lw=0.8, ls="--")
    above.annotate("1x", (hertz[-1], hertz[-1]), color="white", ha="right", va="bottom")
    above.annotate("0.5x", (hertz[-1], hertz[-1] / 2), color="white", ha="right", va="bottom")
    threshold = campbell(rotor(), np.linspace(300.0, 900.0, 13), count=4).threshold or math.nan
    for axes in (above, below):
        axes.axvline(threshold / (2 * math.pi), color=ORANGE, lw=1.2, ls=":")
    above.set_ylabel("Frequency, forward [Hz]")
    below.plot(history["w"] / (2 * math.pi), 1e6 * history["film"], color=BLUE, lw=0.4)
    below.axhline(1.0, color=GREY, lw=1.0)
    below.set_ylabel("Thinnest film, left bearing [um]")
    below.set_xlabel("Speed [Hz]")
    save(figure, path)


def draw_orbit(history: dict[str, np.ndarray], path: Path) -> None:
    """The left journal in its clearance at the beginning, after the threshold, and at the end."""
    figure, panels = new_panels(9.0, 3.4, 1, 3)
    circle = np.exp(1j * np.linspace(0, 2 * math.pi, 200))
    for axes, share in zip(panels, (0.3, 0.55, 0.98), strict=True):
        at = int(share * len(history["t"]))
        z = history["journal"][at - 500 : at] / CLEARANCE
        axes.plot(circle.real, circle.imag, color=GREY)
        axes.plot(z.real, z.imag, color=BLUE, lw=0.7)
        speed = history["w"][at] / (2 * math.pi)
        axes.set_title(f"{speed:.0f} Hz", loc="left", fontsize=9)
        axes.set_xlabel("x over the clearance [1]")
        axes.set_aspect("equal")
    panels[0].set_ylabel("y over the clearance [1]")
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """Both pictures."""
    history = run()
    draw_cascade(history, Path(out) / "cascade.png")
    draw_orbit(history, Path(out) / "orbit.png")
    at_rest = bearing_curves(rotor(), [FROM])
    print(
        f"rests at {at_rest.eccentricity[0]:.3f} of the clearance at {FROM:g} rad/s; "
        f"energy balance closes within {abs(history['residual'][0]):.1e} J of "
        f"{history['lost'][0]:.0f} J lost in the films"
    )


if __name__ == "__main__":
    main(*script_arguments())
