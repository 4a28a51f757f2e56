"""A shaft, its supports and ROSS' answers, for tests of acceptance, critical map and stability."""

import json
import math

from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.linear_bearing import LinearBearing

from tests.validation.test_ross import HERE

ROSS = json.loads((HERE / "ross_api_answers.json").read_text())
ROOT = HERE.parent.parent
RPM = math.pi / 30
CLOSE = 1e-4
SHAFT = """
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
diameters = [0.03, 0.03, 0.03, 0.03, 0.03, 0.03]
[[disc]]
node = 4
diameter = 0.2
width = 0.03
"""


def support(node, stiffness, damping=0.0):
    return f"[[support]]\nnode = {node}\nstiffness = {stiffness}\ndamping = {damping}\n"


def example(name):
    return parse_rotor((ROOT / "examples" / name / "rotor.toml").read_text())


def coupling(node, q):
    return LinearBearing(node=node, kxx=0.0, kyy=0.0, kxy=q, kyx=-q, cxx=0.0, cyy=0.0)
