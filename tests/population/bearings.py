"""Machines drawn at random with what CVODE's equations know nothing of: oil films, rolling
bearings, dampers, floating rings, and contacts that heat the shaft, stick or touch under a load.

Their truth is this project's own equations in the hands of another integrator, `radau5` with a
relative tolerance of 1e-9: what is judged is the integration. The laws have tests of their own,
in `tests/parts`.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.settings import choose

from ..toml_text import table
from .judge import ran
from .machines import GRAVITY, Case, Draw, Shaft, bar, contact, held
from .truth import RTOL, SLIGHTLY, Truth

_OTHERS = 10**6  # numbers of machines' random numbers that `machines` has no use for
_CYCLES = 10  # of the lowest natural frequency, about
_PAD = 1.0  # arc of a tilting pad [rad]
_FIVE = [-math.pi / 2 + 2 * math.pi * i / 5 for i in range(5)]


def _journal(**more: object) -> Callable[[Draw, Shaft, float], str]:
    return lambda draw, shaft, top: _films(draw, shaft, top, **more)


def _lobes(draw: Draw, shaft: Shaft, top: float) -> str:
    lobes = [-math.pi / 2, math.pi / 6, 5 * math.pi / 6]
    return _films(draw, shaft, top, pads=lobes, arc=1.75, preload=draw.between(0.2, 0.7))


def _rough(draw: Draw, shaft: Shaft, top: float) -> str:
    return _films(draw, shaft, top, roughness=draw.log(0.02, 0.15))


def _elastic(draw: Draw, shaft: Shaft, top: float) -> str:
    """Pads preloaded such that none lifts off its film: there the other integrator may stop."""
    pivot, preload = draw.log(1e7, 1e9), draw.between(0.3, 0.6)
    return _tilting(draw, shaft, top, pivot_stiffness=pivot, preload=preload)


def _heavy(draw: Draw, shaft: Shaft, top: float) -> str:
    return _tilting(draw, shaft, top, pad_inertia=True)


def _tilting(draw: Draw, shaft: Shaft, top: float, **more: object) -> str:
    more = {"preload": draw.between(0.0, 0.5), **more}
    return _films(draw, shaft, top, tilting=True, pads=_FIVE, arc=_PAD, **more)


def _film(draw: Draw, shaft: Shaft, top: float) -> dict[str, float]:
    """A film which a machine's weight presses to a usual eccentricity; top: of the speeds
    [rad/s]."""
    radius = draw.between(0.5, 0.7) * shaft.diameter
    length, clearance = radius * draw.between(0.4, 1.6), radius * draw.log(8e-4, 4e-3)
    sommerfeld, weight = draw.log(0.08, 1.5), 0.6 * shaft.mass * GRAVITY
    pressure = weight / (2 * radius * length)
    viscosity = sommerfeld * pressure * (clearance / radius) ** 2 / (top / (2 * math.pi))
    return {
        "journal_radius": radius,
        "length": length,
        "clearance": clearance,
        "viscosity": min(max(viscosity, 2e-3), 0.5),
    }


def _films(draw: Draw, shaft: Shaft, top: float, **more: object) -> str:
    """A journal bearing at either end, with a wall behind the film; roughness: over the clearance;
    pad_inertia: whether pads are as heavy as steel."""
    film = _film(draw, shaft, top)
    radius = film["journal_radius"]
    if "roughness" in more:
        more["roughness"] *= film["clearance"]
    if "pad_inertia" in more:  # of a pad 0.3 radii thick
        more["pad_inertia"] = 7800.0 * _PAD * radius * film["length"] * (0.3 * radius) ** 3
    wall = shaft.stiffness * draw.log(100.0, 3000.0)
    # without heat from the oil, which would warn of flows that are not laminar
    return _at_both(shaft, "journal_bearing", **film, density=1.0, k=wall, mu=0.1, **more)


def _at_both(shaft: Shaft, kind: str, **keys: object) -> str:
    return "".join(table(f"[{kind}]", node=node, **keys) for node in (1, shaft.nodes))


def _damper(draw: Draw, shaft: Shaft, top: float, *, in_ring: bool = False) -> str:
    """Squeeze film dampers under the ends, or around the outer rings of rolling bearings there."""
    k = shaft.stiffness * draw.log(0.5, 5.0)
    radius = 1.8 * shaft.diameter
    keys = {
        "journal_radius": radius,
        "length": 0.33 * radius,
        "clearance": max(radius * draw.log(1e-3, 3e-3), 0.9 * shaft.mass * GRAVITY / k),
        "viscosity": draw.log(2e-3, 3e-2),
        "k": 100 * shaft.stiffness,
        "mu": 0.1,
        "short": draw.between(0, 1) < 0.5,
    }
    if not in_ring:
        return _at_both(shaft, "squeeze_film_damper", stiffness=k, **keys)
    text, rolling = "", _rolling_keys(draw, shaft) | {"clearance": draw.between(-5e-6, 5e-6)}
    for node in (1, shaft.nodes):
        ring = f"ring{node}"
        text += table("[housing]", name=ring, mass=0.05 * shaft.mass, kx=k, ky=k, cx=1.0, cy=1.0)
        text += table("[rolling_bearing]", node=node, housing=ring, **rolling)
        text += table("[squeeze_film_damper]", node=node, ring=ring, **keys)
    return text


def _damped_ring(draw: Draw, shaft: Shaft, top: float) -> str:
    return _damper(draw, shaft, top, in_ring=True)


def _rolling(draw: Draw, shaft: Shaft, top: float) -> str:
    return _at_both(shaft, "rolling_bearing", **_rolling_keys(draw, shaft))


def _preloaded(draw: Draw, shaft: Shaft, top: float) -> str:
    keys = _rolling_keys(draw, shaft)
    return _at_both(shaft, "rolling_bearing", **keys | {"clearance": -keys["clearance"]})


def _rolling_keys(draw: Draw, shaft: Shaft) -> dict[str, float]:
    """A rolling bearing, with a defect of its outer race or without."""
    return {
        "count": int(draw.between(7, 14)),
        "pitch_diameter": 1.6 * shaft.diameter,
        "element_diameter": 0.3 * shaft.diameter,
        "k": draw.log(1e9, 3e10),
        "clearance": draw.log(1e-6, 2e-5),
        "c": draw.log(50.0, 1000.0),
        "outer_depth": draw.one(0.0, 1.0) * draw.log(1e-6, 2e-5),
    }


def _floating_ring(draw: Draw, shaft: Shaft, top: float) -> str:
    film = _film(draw, shaft, top)
    return _at_both(
        shaft,
        "floating_ring_bearing",
        **film,
        outer_radius=1.6 * film["journal_radius"],
        outer_length=1.2 * film["length"],
        outer_clearance=2.0 * film["clearance"],
        outer_viscosity=1.5 * film["viscosity"],
        ring_mass=0.02 * shaft.mass,
        ring_inertia=0.02 * shaft.mass * (1.3 * film["journal_radius"]) ** 2,
        roughness=1e-7,
        short=draw.between(0, 1) < 0.5,
    )


def _touching(draw: Draw, shaft: Shaft, kind: str = "contact", **more: object) -> str:
    """A clearance beside the disc."""
    keys = contact(draw, shaft.stiffness, draw.log(2e-6, 5e-4))
    return table(f"[{kind}]", node=shaft.near, **keys, **more)


def _heated(draw: Draw, shaft: Shaft, top: float) -> str:
    heat = {"bow_per_heat": draw.log(1e-9, 1e-6), "bow_decay": draw.log(0.01, 2.0)}
    return held(draw, shaft) + _touching(draw, shaft, "heated_contact", **heat)


def _loaded(draw: Draw, shaft: Shaft, top: float) -> str:
    fx, fy = (0.6 * shaft.mass * GRAVITY * draw.between(-5, 5) for _ in "xy")
    load = table("[load]", node=shaft.disc, fx=fx, fy=fy, offset=0.01)
    return held(draw, shaft) + _touching(draw, shaft) + load


def _film_and_contact(draw: Draw, shaft: Shaft, top: float) -> str:
    return _films(draw, shaft, top) + _touching(draw, shaft)


def _sticking(draw: Draw, shaft: Shaft, top: float) -> str:
    k_t = shaft.stiffness * draw.log(3.0, 30.0)
    return held(draw, shaft) + _touching(draw, shaft, k_t=k_t)


_AROUND = {
    "plain film": _journal(),
    "grooved film": _journal(pads=[math.pi / 2, -math.pi / 2], arc=2.6),
    "lobed film": _lobes,
    "short film": _journal(short=True),
    "rough film": _rough,
    "tilting pads": _tilting,
    "heavy pads": _heavy,
    "pads on springs": _elastic,
    "film and contact": _film_and_contact,
    "damper": _damper,
    "damper around a bearing": _damped_ring,
    "rolling bearing": _rolling,
    "preloaded bearing": _preloaded,
    "floating ring": _floating_ring,
    "heated contact": _heated,
    "loaded contact": _loaded,
    "sticking contact": _sticking,
}
KINDS = tuple(_AROUND)


def drawn(seed: int) -> Case:
    """The machine of this number, at constant speed or through a ramp, at up to six times the
    lowest natural frequency of its shaft between rigid bearings."""
    draw, kind = Draw(_OTHERS + seed), KINDS[seed % len(KINDS)]
    shaft = bar(draw, draw.log(1e-6, 3e-5), f"gravity = {GRAVITY}\n")
    lowest = math.sqrt(shaft.stiffness / (1.3 * shaft.mass))
    top, stop = lowest * draw.log(0.4, 6.0), _CYCLES * 2 * math.pi / lowest
    ends = [top, top * draw.one(1.0, draw.between(0.4, 0.8))]
    first, last = sorted(ends, reverse=bool(draw.one(0, 1)))
    rotor = parse_rotor(shaft.text + _AROUND[kind](draw, shaft, top))
    rate = (last - first) / stop
    return Case(f"{kind} {seed}", kind, rotor, first, rate, stop, shaft.disc, np.zeros(0, complex))


def truth(case: Case) -> Truth:
    """The orbit of `radau5`, and its condition: of relative changes of unbalance, weight and
    speed."""
    exact, more = orbit(case, RTOL), 1 + SLIGHTLY
    faster = replace(case, speed=more * case.speed, rate=more**2 * case.rate, stop=case.stop / more)
    changed = (_with(case, unbalance=more), _with(case, weight=more), faster)
    largest = max(float(np.abs(orbit(other, RTOL) - exact).max()) for other in changed)
    return Truth(exact, largest / (SLIGHTLY * float(np.abs(exact).max())))


def _with(case: Case, *, unbalance: float = 1.0, weight: float = 1.0) -> Case:
    """The case with all unbalances and the weight multiplied."""
    parts = tuple(
        replace(part, e=unbalance * part.e) if isinstance(part, Disc) else part
        for part in case.rotor.parts
    )
    rotor = replace(case.rotor, parts=parts, gravity=weight * case.rotor.gravity)
    return replace(case, rotor=rotor)


def orbit(case: Case, rtol: float) -> np.ndarray:
    """The node's way from its start by `radau5`."""
    status, found = ran(case, choose(method="radau5", tolerance=rtol))
    assert len(found) == len(case.times), f"{case.name}: {status}"
    return found
