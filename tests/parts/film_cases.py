"""Oil films drawn at random: journal bearings and dampers of any shape, journals anywhere in them
that move in any direction."""

import cmath
import math
from dataclasses import dataclass, replace

import numpy as np
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts.base_and_start import Start
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper
from rotor_fmu.model.simulation import Simulation

from ..machines import STEEL, cylinders

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Case:
    """A film's part and the speed of its journal [rad/s], 0 of a damper's."""

    part: JournalBearing | SqueezeFilmDamper
    speed: float

    @property
    def is_damper(self):
        return isinstance(self.part, SqueezeFilmDamper)

    @property
    def reach(self):
        """How far a journal goes whose film is nowhere thinner than its roughness and than what the
        default's elements resolve, a hundredth of its clearance [m]."""
        return self.part.clearance - max(self.part.roughness, 0.01 * self.part.clearance)

    @property
    def viscous(self):
        """A force of the film's size [N]."""
        part = self.part
        slender = part.journal_radius / part.clearance
        return part.viscosity * self.pace * slender**2 * part.journal_radius * part.length

    @property
    def pace(self):
        """A frequency of the motion in the film [rad/s]."""
        return abs(self.speed) or 300.0

    def mirrored(self):
        """The case seen in a mirror along x."""
        part = self.part
        if not self.is_damper and part.pads:
            pads = tuple(-middle for middle in part.pads)
            part = replace(part, pads=pads, offset=tuple(1.0 - share for share in part.offset))
        return Case(part, -self.speed)

    def turned(self, by):
        """The case with its pads turned by an angle [rad]."""
        part = self.part
        if not self.is_damper and part.pads:
            part = replace(part, pads=tuple(middle + by for middle in part.pads))
        return Case(part, self.speed)

    def alone(self):
        """The case by the functions of its law."""
        return BearingAlone(self.part, self.speed)

    def entrained(self, d, v):
        """The velocity 2 v - i speed d that builds up pressure, over the largest that it may be for
        speeds of this size [1]."""
        most = 2.0 * abs(v) + abs(self.speed * d)
        return abs(2.0 * v - 1j * self.speed * d) / most if most > 0.0 else 0.0


def _pads(random):
    """One to five pads that do not overlap."""
    count = int(random.integers(1, 6))
    room = TURN / count
    arcs = random.uniform(0.3, 0.98, count) * room
    moved = random.uniform(-0.5, 0.5, count) * (0.99 * room - arcs)
    middles = random.uniform(0.0, TURN) + room * np.arange(count) + moved
    given = {
        "pads": middles,
        "arc": arcs,
        "preload": random.uniform(0.0, 0.7, count) * (random.random() < 0.7),
        "offset": random.uniform(0.0, 1.0, count),
    }
    return {name: tuple(float(each) for each in values) for name, values in given.items()}


def drawn(random, least_points=8):
    """A case; least_points: elements of a pad's film, at least."""
    radius = 0.05 * 10 ** random.uniform(-0.5, 0.5)
    clearance = radius * 10 ** random.uniform(-3.3, -2.5)
    given = {
        "node": 1,
        "journal_radius": radius,
        "length": 2.0 * radius * random.uniform(0.1, 2.0),
        "clearance": clearance,
        "viscosity": 10 ** random.uniform(-3.0, -0.5),
        "roughness": clearance * 10 ** random.uniform(-3.0, -1.0),
        "points": float(random.choice([n for n in (8, 12, 24, 48, 96) if n >= least_points])),
        "short": bool(random.random() < 0.3),
    }
    if random.random() < 0.25:
        full = given["short"] and bool(random.random() < 0.5)
        spring = float(random.choice([0.0, 1e6]))
        return Case(SqueezeFilmDamper(**given, full=full, stiffness=spring), 0.0)
    shape = _pads(random) if random.random() < 0.7 else {}
    speed = float(random.choice([-1.0, 1.0]) * 10 ** random.uniform(0.0, 3.5))
    if random.random() < 0.05:
        speed = 0.0
    part = JournalBearing(**given, **shape)
    part.check("journal_bearing")
    return Case(part, speed)


def states(random, case, count, reach=None):
    """Displacements [m] and velocities [m/s] of the journal; reach: its largest displacement, by
    default a little beyond the wall."""
    c = case.part.clearance
    for _ in range(count):
        share = math.sqrt(random.random())
        d = cmath.rect((reach or 1.02 * c) * share, random.uniform(0.0, TURN))
        v = cmath.rect(c * case.pace * 10 ** random.uniform(-2.0, 0.5), random.uniform(0.0, TURN))
        # at rest, in a pure whirl, in one at half the speed, in which a circle bears nothing
        v = (v, v, v, 0j, 0.3j * case.speed * d, 0.5j * case.speed * d)[random.integers(6)]
        yield d, v


class Bench:
    """A film's outputs by the solver of a run: its journal is put anywhere, as from a snapshot."""

    def __init__(self, case):
        part = case.part
        rotor = Rotor(
            STEEL,
            cylinders((0.0, 0.1), (part.journal_radius,)),
            (part, Start(x=0.3 * part.clearance)),
            gravity=0.0,
        )
        self._run = Simulation(rotor, speed=case.speed, warn=lambda message: None)
        self._places = {
            name.partition(".")[2]: place
            for place, name in enumerate(self._run.names)
            if name.startswith(part.KIND)
        }

    def outputs(self, d, v=0j):
        """The part's outputs by their names."""
        self._run.motion.q[0], self._run.motion.v[0] = d, v
        self._run.restore(self._run.snapshot())
        return {name: float(self._run.observed[place]) for name, place in self._places.items()}

    def force(self, d, v=0j):
        """The force on the journal [N]."""
        seen = self.outputs(d, v)
        return complex(seen["fx"], seen["fy"])
