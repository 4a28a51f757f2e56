"""The arrays of the survey of growing whirls in a run's block: a long shaft's basis, and work
arrays."""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import factorize, product, to_band
from ..kernels.kernel import interpreted
from ..quantities import places
from ..structure.reduction import component_modes, dense_fixed_interface_modes
from ..structure.structure import Structure

MOST_DOFS = 24  # of the shaft; a longer one is reduced first
MOST_WHIRLS = 64  # number of whirls that are kept, those that grow fastest
_MODES = 12
_PAYS = 0.75  # a basis for one wall is used with at most this share of the dofs of all walls'
# Displacements of the machine, x and y, with the states of laws that follow a vibration, and these
# with the velocities.
_UNKNOWNS = "2 * (coarse + housings) + vibrating_states"
_STATES = "4 * (coarse + housings) + vibrating_states"
# Columns of `WhirlSurvey.whirls`: real and imaginary part of the root, sense, contact state, speed.
WHIRL = places(("growth", "omega", "sense", "case", "speed"))


class WhirlSurvey(NamedTuple):
    """basis: of a long shaft's coarse dofs, shape (n, coarse), or empty; mass: factors of their
    mass matrix. single_contact_basis, single_contact_mass: the same with fewer dofs for a shaft in
    many bearings, for each interface as the only closed wall, or empty; first_wall: the interface
    whose basis serves while all are open; in_use: the present number of coarse dofs, and the
    interface of the present basis, -1 for that of all. The rest are work arrays, `half` being the
    coarse dofs and the housings: M^-1 times K, C, G and K_shaft; of each interface the displacement
    it sees, and M^-1 times its force; the tangents dF = p z + q conj(z) with respect to
    displacement [N/m] and velocity [N.s/m], and the `StateSlopes` of the laws' states that follow a
    vibration, those of the law staying; the machine x' = A x in real coordinates, and a copy that
    the eigenvalue solver overwrites; one root's equation and its vector; all roots.

    whirls: the growing whirls, the fastest first: Re and Im of the root [1/s], `sense`,
    `case` (`whirls`), speed [rad/s]; counted: how many; rest: root of a growth at rest, or NaN
    [1/s].
    """

    basis: Annotated[np.ndarray, float, "n", "basis"]
    mass: Annotated[np.ndarray, float, "coarse", "coarse_width"]
    single_contact_basis: Annotated[
        np.ndarray, float, "single_contacts", "n", "single_contact_dofs"
    ]
    single_contact_mass: Annotated[
        np.ndarray, float, "single_contacts", "single_contact_dofs", "single_contact_dofs"
    ]
    first_wall: Annotated[np.ndarray, np.int64, "1"]
    in_use: Annotated[np.ndarray, np.int64, "2"]
    K: Annotated[np.ndarray, float, "coarse + housings", "coarse + housings"]
    C: Annotated[np.ndarray, float, "coarse + housings", "coarse + housings"]
    G: Annotated[np.ndarray, float, "coarse + housings", "coarse + housings"]
    K_shaft: Annotated[np.ndarray, float, "coarse + housings", "coarse + housings"]
    pick: Annotated[np.ndarray, float, "interfaces", "coarse + housings"]
    push: Annotated[np.ndarray, float, "interfaces", "coarse + housings"]
    p_d: Annotated[np.ndarray, complex, "interfaces"]
    q_d: Annotated[np.ndarray, complex, "interfaces"]
    p_v: Annotated[np.ndarray, complex, "interfaces"]
    q_v: Annotated[np.ndarray, complex, "interfaces"]
    solved: Annotated[np.ndarray, float, "internal_states"]
    rates: Annotated[np.ndarray, float, "vibrating_states"]
    force_by_states: Annotated[np.ndarray, complex, "vibrating_states"]
    rates_by_d: Annotated[np.ndarray, complex, "vibrating_states"]
    rates_by_v: Annotated[np.ndarray, complex, "vibrating_states"]
    rates_by_states: Annotated[np.ndarray, float, "vibrating_states", "vibrating_states"]
    A: Annotated[np.ndarray, float, _STATES, _STATES]
    work: Annotated[np.ndarray, float, _STATES, _STATES]
    D: Annotated[np.ndarray, complex, _UNKNOWNS, _UNKNOWNS]
    vector: Annotated[np.ndarray, complex, _UNKNOWNS]
    re: Annotated[np.ndarray, float, _STATES]
    im: Annotated[np.ndarray, float, _STATES]
    along: Annotated[np.ndarray, complex, "n"]
    product: Annotated[np.ndarray, complex, "n"]
    column: Annotated[np.ndarray, float, "coarse"]
    whirls: Annotated[np.ndarray, float, str(MOST_WHIRLS), str(len(WHIRL))]
    counted: Annotated[np.ndarray, np.int64, "1"]
    rest: Annotated[np.ndarray, complex, "1"]


class CoarseShaft(NamedTuple):
    """`basis`, `mass`, `single_contact_basis`, `single_contact_mass` and `first_wall` of a
    `WhirlSurvey`."""

    basis: np.ndarray
    mass: np.ndarray
    single_contact_basis: np.ndarray
    single_contact_mass: np.ndarray
    first_wall: int


def coarse_shaft(structure: Structure) -> CoarseShaft:
    """Return the coarse dofs in which a survey of this machine works."""
    n = len(structure.static_load)
    none = np.zeros((0, n, 0)), np.zeros((0, 0, 0)), 0
    if n <= MOST_DOFS:
        return CoarseShaft(np.zeros((n, 0)), structure.M_factors, *none)
    retained, basis = component_modes(structure, _MODES)
    mass = basis.T @ product(structure.M, basis)
    single_contact_basis = (
        none
        if basis.shape[1] <= MOST_DOFS
        else _single_contact_bases(structure, retained, basis, mass)
    )
    return CoarseShaft(basis, _factors(mass), *single_contact_basis)


def _factors(mass: np.ndarray) -> np.ndarray:
    """Return the factors of a mass matrix."""
    band = to_band(mass, len(mass) - 1)
    interpreted(factorize)(band)
    return band


def _single_contact_bases(
    structure: Structure, retained: np.ndarray, basis: np.ndarray, mass: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return `single_contact_basis`, `single_contact_mass` and `first_wall`: each wall is retained
    with the first and the last one and with all dofs that belong to no wall, and the rest of the
    basis is reduced to the usual number of modes."""
    interfaces = structure.interfaces
    walls = np.flatnonzero(interfaces.slips == 1)
    soft = np.append(interfaces.dof[interfaces.slips == 0], structure.springs.dof)
    loose = np.isin(retained, np.setdiff1d(np.unique(interfaces.dof[walls])[1:-1], soft))
    retained_dofs = np.flatnonzero(~loose)
    count = len(retained_dofs) + 1 + _MODES
    if len(walls) == 0 or count > _PAYS * len(mass):
        return np.zeros((0, len(basis), 0)), np.zeros((0, 0, 0)), 0
    K = basis.T @ product(structure.K_shaft, basis)
    single_contact_basis = np.zeros((len(interfaces), len(basis), count))
    single_contact_mass = np.zeros((len(interfaces), count, count))
    for j in walls.tolist():
        place = int(np.searchsorted(retained, interfaces.dof[j]))
        own_dofs = np.union1d(retained_dofs, [place])
        rest = np.delete(np.arange(len(mass)), own_dofs)
        shapes = np.zeros((len(mass), count))
        shapes[own_dofs, np.arange(len(own_dofs))] = 1.0
        shapes[rest] = np.hstack(
            dense_fixed_interface_modes(K, mass, rest, own_dofs, count - len(own_dofs))
        )
        single_contact_basis[j] = basis @ shapes
        single_contact_mass[j] = _factors(shapes.T @ mass @ shapes)
    return single_contact_basis, single_contact_mass, int(walls[0])
