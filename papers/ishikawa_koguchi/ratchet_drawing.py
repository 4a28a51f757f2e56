"""The ratchet drawn: wheel, pawl and its deformation, at a few instants and in motion."""

import math
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from PIL import Image

from rotor_fmu.files import unfinished

from .impact.ratchet import Ratchet, RatchetRun
from .impact_plots import panels

_WHEEL, _EDGE = "#d9d4c7", "#6d675a"
_SHOWN = 1.5e-3  # size at which the largest bending is drawn [m]
_SLOWER = 300  # the animation's time over the ratchet's
_FRAME_RATE = 20


def bending(ratchet: Ratchet, u: np.ndarray) -> np.ndarray:
    """What displacements u, shape (frames, N, 2), have besides the pawl's turning [m]."""
    x = ratchet.plate.points
    turned = np.stack([-x[:, 1], x[:, 0]], axis=1)
    angle = (u * turned).sum(axis=(1, 2)) / (turned**2).sum()
    return u - angle[:, None, None] * turned


def _magnification(bent: np.ndarray) -> float:
    """A round factor that makes the bending visible."""
    largest = float(np.sqrt((bent**2).sum(axis=-1)).max())
    factor = _SHOWN / largest if largest > 0 else 1.0
    decade = 10.0 ** math.floor(math.log10(factor))
    return max(1.0, decade * max(k for k in (1, 2, 5) if k * decade <= factor))


def _wheel(ratchet: Ratchet, angle: float) -> np.ndarray:
    """Outline of the wheel [m], shape (points, 2), turned by an angle [rad].

    The model unrolls the wheel below the tip of the nose; here it is rolled up again.
    """
    pawl, tooth, wheel = ratchet.pawl, ratchet.tooth, ratchet.wheel
    tip = -(pawl.height / 2 + tooth.slope * pawl.nose_length)
    on_back = -tooth.clearance * math.hypot(1, tooth.slope)
    along = np.linspace(0.0, ratchet.pitch, 40)
    teeth = []
    for k in range(wheel.teeth):
        # from the foot of a face up, then down the back of its tooth
        x = tooth.slip + k * ratchet.pitch + along
        y = on_back + tooth.slope * (ratchet.pitch - tooth.slip - along)
        teeth.append(np.stack([x, y], axis=1))
    x, y = np.concatenate(teeth).T
    turned = x / wheel.radius + angle
    r = wheel.radius + y
    centre = (pawl.length, tip - wheel.radius)
    return np.stack([centre[0] + r * np.sin(turned), centre[1] + r * np.cos(turned)], axis=1)


class _Scene:
    """Wheel and pawl in one pair of axes; `show` moves them."""

    def __init__(self, axes: Axes, ratchet: Ratchet, factor: float, largest: float) -> None:
        pawl = ratchet.pawl
        self._ratchet, self._factor = ratchet, factor
        c = ratchet.plate.columns
        quads = np.stack([c[:-1, :-1], c[1:, :-1], c[1:, 1:], c[:-1, 1:]], axis=-1)
        self._quads = quads.reshape(-1, 4)
        (self._wheel,) = axes.fill([0], [0], facecolor=_WHEEL, edgecolor=_EDGE, lw=1.2)
        self.mesh = PolyCollection([], cmap="viridis", edgecolor="white", linewidths=0.4)
        self.mesh.set_clim(0, 1e6 * largest)
        axes.add_collection(self.mesh)
        (pivot,) = axes.plot(0, 0, "o", color="black", ms=6, zorder=5)
        self.moving: tuple[Artist, ...] = self._wheel, self.mesh, pivot
        tip = pawl.height / 2 + ratchet.tooth.slope * pawl.nose_length
        axes.set_xlim(-200 * pawl.length, 1e3 * (pawl.length + 3 * ratchet.tooth.slip))
        axes.set_ylim(-4000 * tip, 2000 * pawl.height)
        axes.set_aspect("equal")
        axes.grid(False)
        axes.set_ylabel("y [mm]")

    def show(self, angle: float, u: np.ndarray) -> None:
        """The wheel at an angle [rad], the pawl's nodes displaced by u, shape (N, 2) [m]."""
        bent = bending(self._ratchet, u[None])[0]
        points = self._ratchet.plate.points + u + (self._factor - 1) * bent
        self.mesh.set_verts(1e3 * points[self._quads])
        size = np.hypot(*bent.T)
        self.mesh.set_array(1e6 * size[self._quads].mean(axis=1))
        self._wheel.set_xy(1e3 * _wheel(self._ratchet, angle))


def _frame_at(result: RatchetRun, t: float) -> int:
    return int(np.argmin(np.abs(result.shape_t - t)))


def instants(result: RatchetRun) -> list[tuple[str, int]]:
    """Frames worth showing: at rest, sliding, at the locking face, after the rebound."""
    t_locked = result.t_reversal
    if math.isnan(t_locked):
        return [("start", 0), ("end", len(result.shape_t) - 1)]
    near = np.flatnonzero(np.abs(result.shape_t - t_locked) < 0.02 * t_locked)
    bent = np.sqrt((bending(result.ratchet, result.shapes[near]) ** 2).sum(axis=-1)).max(axis=1)
    locked = int(near[np.argmax(bent)]) if len(near) else _frame_at(result, t_locked)
    return [
        ("at rest", 0),
        ("sliding", _frame_at(result, 0.7 * t_locked)),
        ("hits the locking face", locked),
        ("rebounds", _frame_at(result, 1.35 * t_locked)),
    ]


def drawing(result: RatchetRun, caption: str) -> Figure:
    """The ratchet at a few instants, bending magnified."""
    shown = instants(result)
    bent = bending(result.ratchet, result.shapes[[k for _, k in shown]])
    largest = float(np.sqrt((bent**2).sum(axis=-1)).max())
    factor = _magnification(bent)
    rows = math.ceil(len(shown) / 2)
    figure = Figure(figsize=(8.4, 0.6 + 2.3 * rows), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for one, (label, k) in zip(axes.flat, shown, strict=True):
        scene = _Scene(one, result.ratchet, factor, largest)
        scene.show(result.shape_angle[k], result.shapes[k])
        one.set_title(f"{label}, t = {1e3 * result.shape_t[k]:.2f} ms", loc="left", fontsize=11)
        one.spines[["top", "right"]].set_visible(False)
        one.set_xlabel("x [mm]")
        one.label_outer()
    figure.suptitle(f"{caption}, bending drawn {factor:g} times", x=0.01, ha="left", fontsize=11)
    figure.colorbar(scene.mesh, ax=axes, label="Bending [µm]", shrink=0.9)
    return figure


def animate(result: RatchetRun, path: Path, caption: str) -> Path:
    """A GIF of the kept shapes: one tooth."""
    ratchet = result.ratchet
    bent = bending(ratchet, result.shapes)
    size = np.sqrt((bent**2).sum(axis=-1)).max(axis=1)
    largest = float(np.quantile(size, 0.98))
    figure, (axes,) = panels(1, 6.0, 3.1)
    figure.set_dpi(90)
    scene = _Scene(axes, ratchet, _magnification(np.array([[[largest, 0.0]]])), largest)
    axes.set_xlabel("x [mm]")
    axes.set_title(caption, loc="left", fontsize=9)
    clock = axes.text(0.02, 0.95, "", transform=axes.transAxes, va="top", fontsize=9)
    moving = (*scene.moving, clock)
    for artist in moving:
        artist.set_animated(True)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)

    def frame(k: int) -> Image.Image:
        """The picture of the kept shape of this number."""
        scene.show(result.shape_angle[k], result.shapes[k])
        speed = np.interp(result.shape_t[k], result.t, result.wheel_speed)
        clock.set_text(f"t = {1e3 * result.shape_t[k]:5.2f} ms    wheel {speed:+6.1f} rad/s")
        canvas.restore_region(still)
        for artist in moving:
            axes.draw_artist(artist)
        pixels = np.asarray(canvas.buffer_rgba())[..., :3]
        return Image.fromarray(np.ascontiguousarray(pixels))

    first, *others = (frame(k) for k in range(len(result.shape_t)))
    with unfinished(path) as part:
        first.save(
            part,
            format="GIF",
            save_all=True,
            append_images=others,
            duration=1000 // _FRAME_RATE,
            loop=0,
        )
    return path


def frame_interval() -> float:
    """Time between two frames of the animation [s]."""
    return 1 / (_SLOWER * _FRAME_RATE)
