"""The rotor of this folder runs up to 150 000 rpm: cascade.png and rings.png.

python turbocharger.py [FOLDER for the pictures]
"""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.floating_ring_bearing import FloatingRingBearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_panels, save

HERE = Path(__file__).resolve().parent
FROM, TO, SECONDS = 1000.0, 15708.0, 3.0  # rad/s, s
EVERY = 1e-4  # s
RING = "floating_ring_bearing[{}]"
_WINDOW = 1024  # samples of a spectrum
_HIGHEST = 3000.0  # Hz


def rotor() -> Rotor:
    """The machine of this folder."""
    return parse_rotor((HERE / "rotor.toml").read_text(encoding="utf-8"))


def run(low: float = FROM, high: float = TO, seconds: float = SECONDS) -> dict[str, np.ndarray]:
    """A run-up: time `t`, speed `w`, both wheels as x + i y, of both bearings the ring's speed and
    the eccentricities of the films, and the ledger."""
    sim = Simulation(rotor(), choose("controlled", tolerance=1e-3), speed=low, warn=lambda _: None)
    rate = (high - low) / seconds
    seen = [
        *(f"body[{k}].{axis}" for k in (1, 2) for axis in "xy"),
        *(
            f"{RING.format(k)}.{name}"
            for k in (1, 2)
            for name in ("ring_speed", "eccentricity", "outer_eccentricity")
        ),
    ]
    rows = []
    for i in range(1, round(seconds / EVERY) + 1):
        t = i * EVERY
        sim.advance(t, low + rate * (t - EVERY), rate=rate)
        rows.append((t, low + rate * t, *(sim.read(name) for name in seen)))
    history = dict(zip(("t", "w", *seen), np.array(rows).T, strict=True))
    for k, name in ((1, "turbine"), (2, "compressor")):
        history[name] = history[f"body[{k}].x"] + 1j * history[f"body[{k}].y"]
    history["residual"] = np.array([sim.read("energy.residual")])
    history["lost"] = np.array([sim.read("energy.film_loss")])
    return history


def spectra(
    history: dict[str, np.ndarray], wheel: str, lines: int = 120
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speeds [rad/s], frequencies [Hz] and amplitudes of a wheel's forward motion [m]."""
    window = np.hanning(_WINDOW)
    begins = np.linspace(0, len(history["t"]) - _WINDOW, lines).astype(int)
    frequency = np.fft.fftfreq(_WINDOW, EVERY)
    forward = np.flatnonzero((frequency > 0) & (frequency < _HIGHEST))
    rows, speeds = [], []
    for begin in begins:
        z = history[wheel][begin : begin + _WINDOW]
        rows.append(np.abs(np.fft.fft((z - z.mean()) * window))[forward] / window.sum())
        speeds.append(history["w"][begin + _WINDOW // 2])
    return np.array(speeds), frequency[forward], np.array(rows)


def closed_form(part: FloatingRingBearing) -> float:
    """Speed of a ring in the middle of its films over that of the rotor [1]."""
    clearances = part.clearance / part.outer_clearance
    lengths = part.outer_length / part.length
    radii = part.outer_radius / part.journal_radius
    viscosities = part.outer_viscosity / part.viscosity
    return 1.0 / (1.0 + clearances * lengths * radii**3 * viscosities)


def _smooth(values: np.ndarray) -> np.ndarray:
    """A mean over 20 ms."""
    width = round(0.02 / EVERY)
    return np.convolve(values, np.ones(width) / width, mode="valid")


def _name(axes: Axes, x: np.ndarray, line: np.ndarray, name: str) -> None:
    """Write a line's name above it, near its end."""
    at = int(0.93 * len(x))
    axes.annotate(name, (x[at], line[at] + 25.0), color="white", ha="right", va="bottom")


def draw_cascade(history: dict[str, np.ndarray], path: Path) -> None:
    """The spectra of the wheels' forward motion over the speed, and half the mean speeds of the
    surfaces of both films."""
    figure, panels = new_panels(6.8, 7.6, 2, share_x=True)
    rpm = 30.0 / math.pi * _smooth(history["w"]) / 1000.0
    for axes, wheel in zip(panels, ("turbine", "compressor"), strict=True):
        speeds, frequency, rows = spectra(history, wheel)
        level = 20 * np.log10(np.maximum(rows / 1e-6, 1e-3))
        at = 30.0 / math.pi * speeds / 1000.0
        mesh = axes.pcolormesh(at, frequency, level.T, cmap="viridis", vmin=-40, vmax=30)
        figure.colorbar(mesh, ax=axes, label=f"Amplitude, {wheel} wheel [dB over 1 um]")
        axes.plot(rpm, rpm * 1000.0 / 60.0, color="white", lw=0.8)
        _name(axes, rpm, rpm * 1000.0 / 60.0, "1x")
        ring = _smooth(history[f"{RING.format(1)}.ring_speed"])
        outer = ring / (4.0 * math.pi)
        inner = (_smooth(history["w"]) + ring) / (4.0 * math.pi)
        for line, name, style in ((inner, "inner film", "--"), (outer, "outer film", ":")):
            axes.plot(rpm, line, color="white", lw=0.8, ls=style)
            _name(axes, rpm, line, name)
        axes.set_ylim(0.0, 2600.0)
        axes.set_ylabel("Frequency, forward [Hz]")
    panels[-1].set_xlabel("Speed [1000 rpm]")
    save(figure, path)


def draw_rings(history: dict[str, np.ndarray], path: Path) -> None:
    """The rings' speed over that of the rotor, and the eccentricities of both films."""
    figure, (above, below) = new_panels(6.8, 5.6, 2, share_x=True)
    rpm = 30.0 / math.pi * history["w"] / 1000.0
    for k, colour, name in ((1, ORANGE, "turbine side"), (2, BLUE, "compressor side")):
        bearing = RING.format(k)
        ratio = history[f"{bearing}.ring_speed"] / history["w"]
        above.plot(rpm, ratio, color=colour, lw=0.6, label=name)
    part = rotor().of_kind(FloatingRingBearing)[0]
    above.axhline(closed_form(part), color=GREY, lw=1.0, ls="--", label="ring in the middle")
    above.set_ylabel("Speed, ring over rotor [1]")
    above.legend(frameon=False)
    bearing = RING.format(1)
    for name, colour, label in (
        ("outer_eccentricity", GREEN, "outer film"),
        ("eccentricity", ORANGE, "inner film"),
    ):
        below.plot(rpm, history[f"{bearing}.{name}"], color=colour, lw=0.3, label=label)
    below.set_ylim(0.0, 1.0)
    below.set_ylabel("Eccentricity, turbine side [1]")
    below.set_xlabel("Speed [1000 rpm]")
    below.legend(frameon=False)
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """Both pictures."""
    history = run()
    draw_cascade(history, Path(out) / "cascade.png")
    draw_rings(history, Path(out) / "rings.png")
    ratio = closed_form(rotor().of_kind(FloatingRingBearing)[0])
    seen = history[f"{RING.format(1)}.ring_speed"] / history["w"]
    print(
        f"a ring in the middle turns at {ratio:.3f} of the rotor's speed, that of the "
        f"turbine side at {seen.min():.3f} to {seen.max():.3f}; energy balance closes within "
        f"{abs(history['residual'][0]):.1e} J of {history['lost'][0]:.0f} J lost in the films"
    )


if __name__ == "__main__":
    main(*script_arguments())
