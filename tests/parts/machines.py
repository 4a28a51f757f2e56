"""Machines in TOML: some that stand for textbook ones, one with all that may bend and drop."""

import numpy as np
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

STEEL = "[material]\nyoung = 2.1e11\ndensity = 7800.0\n"
SHAFT = 1e-4  # mass of the light shaft of `rigid` [kg]
IN_THE_AIR = "[start]\nx = 0.0\n"


def rigid(mass=1.0, gravity=0.0, parts="", rest=""):
    """A point mass amid a shaft of 1e-4 kg, nodes 1 to 3, 2 in the middle: together `mass` [kg].

    It stands for one rigid body. What acts at its middle moves the shaft along; what the bearings
    below do at the ends, 2 % of their force, bends it, 7.5e6 N/m: 6e-7 of a stiffness of 1e4 N/m.
    """
    return f"""
gravity = {gravity}
[material]
young = 2.1e10
density = {SHAFT / (3.141592653589793 / 4 * 0.02**2 * 0.1)}
[shaft]
nodes = [0.0, 0.05, 0.1]
diameters = [0.02, 0.02]
[[point_mass]]
node = 2
mass = {mass - SHAFT}
{rest}
{parts}
"""


def bearings(k, c, cross=0.0):
    """Isotropic linear bearings that have k [N/m], c [N.s/m] and the cross coupling [N/m] together:
    98 % at the middle, the rest at the ends, which it keeps from tilting."""
    return "".join(
        f"""
[[linear_bearing]]
node = {node}
kxx = {share * k}
kyy = {share * k}
kxy = {share * cross}
kyx = {-share * cross}
cxx = {share * c}
cyy = {share * c}
"""
        for node, share in ((1, 0.01), (2, 0.98), (3, 0.01))
    )


def shaft(*nodes, diameter=0.02, material=STEEL):
    """A cylindrical shaft with nodes at these places [m]; material: its table."""
    return f"{material}[shaft]\nnodes = {[*nodes]}\ndiameters = {[diameter] * (len(nodes) - 1)}\n"


def sections(*lengths, **keys):
    output = "\n".join(f"{key} = {value}" for key, value in keys.items())
    return "".join(f"[[section]]\nlength = {length}\n{output}\n" for length in lengths)


def touchdown(node, housing):
    return f"""
[[touchdown_bearing]]
node = {node}
journal_radius = 0.03
clearance = 0.25e-3
mu = 0.2
k = 5e7
c = 500.0
race_inertia = 1e-4
race_drag = 0.01
race_damping = 1e-5
housing = "{housing}"
"""


HELD = """
[[linear_bearing]]
z = 0.0
kxx = 1e6
kyy = 2e6
cxx = 100.0
cyy = 150.0
[[linear_bearing]]
z = 0.4
kxx = 1e6
kyy = 2e6
cxx = 100.0
cyy = 150.0
"""
HUB = """
[[body]]
z = 0.6
mass = 3.0
I_d = 0.02
I_p = 0.03
"""
FLEXIBLE = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD + HUB
SEAL = "[[seal]]\nz = 0.2\nkxx = 1e5\nkyy = 1e5\nkxy = 5e4\nkyx = -5e4\ncxx = 40.0\ncyy = 40.0\n"
SEATS = "".join(
    f'[[housing]]\nname = "{n}"\nmass = 0.5\nkx = 1e7\nky = 1e7\ncx = 500.0\ncy = 500.0\n'
    for n in "ab"
)
DROPPED = (
    STEEL
    + sections(0.1, 0.2, 0.2, 0.1, outer=0.05)
    + "[[disc]]\nnode = 3\ndiameter = 0.25\nwidth = 0.03\ne = 2e-5\n[start]\ny = 1e-5\n"
    + SEATS
    + touchdown(2, "a")
)


def bouncing(clearance=1e-3):
    """A rotor at 101 rad/s that bounces off a hard wall once a turn, for less than a 64th of it,
    without friction; from 1.1 mm on it does not reach it."""
    return (
        rigid(gravity=4.0, parts=bearings(1e4, 20.0))
        + "[[unbalance]]\nnode = 2\namount = 1.2e-4\n"
        + f"[[contact]]\nnode = 2\njournal_radius = 0.05\nclearance = {clearance}\n"
        + "mu = 0.0\nk = 1e9\nc = 50.0\n"
    )


def end_of(text, duration=0.01, h=1e-4, speed=150.0, loads=None, probe=0):
    """Where a place that is looked at is at the end of a run of a machine file, and the run."""
    sim = Simulation(parse_rotor(text), choose("robust", h=h), speed=speed, rate=500.0, loads=loads)
    for t in np.linspace(0, duration, 5)[1:]:
        sim.advance(t, speed + 500.0 * sim.time, loads)
    return sim.motion.q[sim.structure.probes[probe].dof], sim


def started(z, v=0j):
    """Parameters of a start in the air at a displacement [m] with a velocity [m/s]."""
    return {"start.x": z.real, "start.y": z.imag, "start.vx": v.real, "start.vy": v.imag}


def robust(h, **more):
    """Steps of a fixed length [s]."""
    return {"solver.preset": 0, "solver.h": h, **{f"solver.{k}": v for k, v in more.items()}}
