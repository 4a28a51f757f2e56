"""Rotors in oil films."""

from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from ..toml_text import table
from .machines import shaft

OF_A_FILM = {"journal_radius": 0.05, "clearance": 1e-4, "viscosity": 0.01}
DAMPER = {"node": 1, "length": 0.02, **OF_A_FILM}
# Of a rigid rotor in Ocvirk's film, half of it ruptured: eccentricity at rest over the clearance,
# threshold of speed sqrt(clearance / g), its whirl over the speed.
THRESHOLDS = [
    *((1e-3, 2.7640, 0.5), (0.1, 2.7413, 0.5029), (0.2, 2.6814, 0.5106), (0.3, 2.6058, 0.5194)),
    *((0.4, 2.5446, 0.5238), (0.5, 2.5417, 0.5146), (0.6, 2.7010, 0.4740), (0.7, 3.6278, 0.3446)),
    (0.75, 9.744, 0.1267),
]


def heavy_shaft(e=0.0, young=2.1e11):
    """A rigid body of 40 kg with an eccentricity [m] amid a light shaft of nodes 1 to 3."""
    body = table("[body]", node=2, mass=40.0, I_d=0.2, I_p=0.2, e=e)
    light = table("material", young=young, density=100.0)
    return shaft(0.0, 0.1, 0.2, diameter=0.1, material=light) + body


def film(node, **more):
    """A journal bearing, plain unless more says otherwise."""
    return table("[journal_bearing]", node=node, length=0.03, **(OF_A_FILM | more))


def in_films(e=0.0, start="", **more):
    """The rotor of `heavy_shaft` between two such films, by default Ocvirk's."""
    more = more or {"short": True}
    return parse_rotor(heavy_shaft(e) + film(1, **more) + film(3, **more) + start)


def on_dampers(viscosity, young=2.1e13, density=1.0, e=3e-5, **others):
    """A weightless rotor of 10 kg, by default 30 um out of balance, on two short dampers with
    springs; others: further quantities of these."""
    body = table("[body]", node=2, mass=10.0, I_d=1e-2, I_p=1e-3, e=e)
    more = {"viscosity": viscosity, "short": True, "stiffness": 5e4, **others}
    dampers = [table("[squeeze_film_damper]", **{**DAMPER, **more, "node": n}) for n in (1, 3)]
    stiff = shaft(0.0, 0.1, 0.2, material=table("material", young=young, density=density))
    return parse_rotor(f"gravity = 0.0\n{stiff}{body}{''.join(dampers)}")


def run_of(rotor, speed, tolerance=1e-4, **options):
    """A run with error control, at a constant speed [rad/s], whose warnings nobody hears."""
    return Simulation(
        rotor,
        choose("controlled", tolerance=tolerance),
        speed=speed,
        warn=lambda _: None,
        **options,
    )
