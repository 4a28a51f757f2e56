"""A machine in arrays: the result of assembly, on which the kernels work."""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels import block
from ..parts import LAWS
from ..parts.base import ReleaseElement
from ..parts.housing import HousingQuantities
from ..quantities import quantities


def _record(integers: str, numbers: str) -> np.dtype:
    return np.dtype([(n, "i8") for n in integers.split()] + [(n, "f8") for n in numbers.split()])


# the weight of the product of two dofs, counted twice if they differ
WEIGHT = _record("i k", "weight")
SPRING = _record("dof", "stiffness damping")
# `slope`: of the node, where there is an offset, otherwise `dof` again
UNBALANCE = _record("dof slope", "mass spinning_mass e phase offset")
FORCE = _record("dof slope", "fx fy offset")
PROBE = _record("dof slope out", "offset")
LOAD = _record("slope out", "offset impedance")
RELEASE = _record("", " ".join(ReleaseElement._fields))
# of a thermal bow, `state`: where it lies among the laws' states, in x and y of the rotor's frame;
# of a residual one -1, and what it is
BOW = _record("state", "amplitude phase")
HOUSING = _record("out", " ".join(quantities(HousingQuantities)))
# `dof`: the node's deflection, or the place of the housing that moves instead (`on_shaft`); `end`:
# the housing's place in a motion, behind the dofs, or that of ground, the last;
# `internal_state`: where the states of the law begin; `first_vibrating`, `vibrating`: where among
# all states of laws that vibrate (`Law.vibrates`) its own begin, and how many it has; `slips`:
# whether it has a wall that does not turn; `wall_out`: where `WALL_OUTPUTS` begin.
INTERFACE = _record(
    "law row dof end internal_state states first_vibrating vibrating out has_wall slips wall_out",
    "length",
)
# Numbers of a machine. From its parts: whether the internal damping rotates; is_supported: whether
# springs and soft laws support it, and not its clearances alone; base_load: index of the base's
# acceleration among the loads, or -1; eta_v [s], eta_h [1], mass_damping [1/s]; gravity [m/s2], and
# its shares along x and y; inertia of shaft and bodies about the axis [kg.m2]; lowest_omega: see
# `lowest_frequency` [rad/s]; bound: displacement that no machine reaches, small: a length of a
# machine without clearance [m]. Filled in by `parameters.prepare`: inertia with the eccentric
# masses; kappa_v [s] and kappa_h [1] of the rotating damping, kappa = Omega kappa_v + sign(Omega)
# kappa_h; clearance: the smallest [m]; slowest: angular frequency of the slowest motion [rad/s].
NUMBERS = _record(
    "rotating_damping is_supported base_load",
    "eta_v eta_h mass_damping gravity down_x down_y own_inertia lowest_omega bound small inertia "
    "kappa_v kappa_h clearance slowest",
)


# Type and extents of each array of a machine's `laws`: the records of each law, and last the
# tables.
LAW_TABLES = [*((law.dtype, (f"rows_{law.name}",)) for law in LAWS), (np.dtype(float), ("tables",))]


class Structure(NamedTuple):
    """A rotor in matrices, all in SI units; n dofs, two a node (deflection, slope).

    M, C, K: mass, damping, stiffness; G: gyroscopic (real, symmetric); M_shaft: the shaft's mass,
    K_shaft: its elastic stiffness, K_axial: that of its axial forces; each in band storage, shape
    (n, width); M_factors: those of M, from `band.factorize`. weights: of the norm of motions and
    errors, the mean square of the deflections weighted with their lumped masses [1]; mass_sum:
    force of a unit acceleration [kg, kg.m]; static_load: gravity and `forces` [N, N.m]. releases:
    initial motions in the place of the equilibrium, if any; one_body: rigid-body motions, a unit
    displacement and a unit tilt about the centre of mass. deflections: dof and node number, from 1,
    of every deflection. load_dof: where external forces act, -1 for the base's acceleration, and
    load_arms: their offsets; probes, velocities: where displacements and velocities are observed.
    unbalances, and their values m e exp(i phase) [kg.m]. forces: constant. springs: to ground.
    bows: of the shaft, residual and thermal; bow: what a residual one is, in the rotor's frame [m];
    bow_forces: restoring force of the shaft for a bow of 1 m [N/m, N], bow_stiffness: between two
    of them [N/m]; see `bow`. housings; interfaces: between
    nodes and housings; laws: the records of each law, and the tables. stores, losses: indices of
    the machine's entries in the ledger. numbers: see `NUMBERS`.
    """

    M: Annotated[np.ndarray, float, "n", "width"]
    C: Annotated[np.ndarray, float, "n", "width"]
    K: Annotated[np.ndarray, float, "n", "width"]
    G: Annotated[np.ndarray, float, "n", "width"]
    M_shaft: Annotated[np.ndarray, float, "n", "width"]
    K_shaft: Annotated[np.ndarray, float, "n", "width"]
    K_axial: Annotated[np.ndarray, float, "n", "width"]
    M_factors: Annotated[np.ndarray, float, "n", "width"]
    weights: Annotated[np.recarray, WEIGHT, "weights"]
    mass_sum: Annotated[np.ndarray, float, "n"]
    static_load: Annotated[np.ndarray, complex, "n"]
    releases: Annotated[np.ndarray, RELEASE, "releases"]
    one_body: Annotated[np.ndarray, float, "2", "n"]
    deflections: Annotated[np.ndarray, np.int64, "deflections", "2"]
    load_dof: Annotated[np.ndarray, np.int64, "loads"]
    load_arms: Annotated[np.recarray, LOAD, "loads"]
    probes: Annotated[np.recarray, PROBE, "probes"]
    velocities: Annotated[np.recarray, PROBE, "velocities"]
    unbalances: Annotated[np.recarray, UNBALANCE, "unbalances"]
    unbalance: Annotated[np.ndarray, complex, "unbalances"]
    forces: Annotated[np.recarray, FORCE, "forces"]
    springs: Annotated[np.recarray, SPRING, "springs"]
    bows: Annotated[np.recarray, BOW, "bows"]
    bow: Annotated[np.ndarray, complex, "bows"]
    bow_forces: Annotated[np.ndarray, float, "bows", "n"]
    bow_stiffness: Annotated[np.ndarray, float, "bows", "bows"]
    housings: Annotated[np.recarray, HOUSING, "housings"]
    interfaces: Annotated[np.recarray, INTERFACE, "interfaces"]
    laws: Annotated[tuple[np.ndarray, ...], LAW_TABLES]
    stores: Annotated[np.ndarray, np.int64, "stores"]
    losses: Annotated[np.ndarray, np.int64, "losses"]
    numbers: Annotated[np.recarray, NUMBERS, "1"]


def starts_of(interfaces: np.ndarray) -> np.ndarray:
    """Return the internal states of the laws at the start, those of each interface in turn."""
    starts = [np.resize(LAWS[i.law].states, i.states) for i in interfaces]
    return np.concatenate([np.zeros(0), *starts])


def sizes_of_laws(laws: tuple) -> dict[str, int]:
    """Return the numbers on which the extents of `LAW_TABLES` depend."""
    rows = zip(LAWS, laws, strict=False)
    return {f"rows_{law.name}": len(records) for law, records in rows} | {"tables": len(laws[-1])}


def sizes_of(structure: Structure) -> dict[str, int]:
    """Return the sizes on which the extents of the arrays depend; `size`: of a motion, ground
    included."""
    sizes = block.sizes_of(structure)
    states = structure.interfaces.states
    return sizes | {
        "size": sizes["n"] + sizes["housings"] + 1,
        "internal_states": int(states.sum()),
        "vibrating_states": int(structure.interfaces.vibrating.sum()),
        "most_states": int(states.max(initial=0)),
    }


def total_mass(structure: Structure) -> float:
    """Return the mass of the shaft with its bodies [kg]."""
    return float(structure.mass_sum[::2].sum())
