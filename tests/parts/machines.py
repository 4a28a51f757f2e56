"""Machines told in TOML that stand for textbook ones."""

SHAFT = 1e-4  # mass of the light shaft of `rigid` [kg]


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
