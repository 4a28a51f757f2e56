"""What the survey of growing whirls needs of a run's block: a long shaft's basis, and scratch."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import factorize, product, to_band
from ..kernels.jit import interpreted
from ..quantities import places
from ..structure.reduction import component_modes, held_shapes
from ..structure.structure import Structure

MOST_DOFS = 24  # of the shaft; a longer one is reduced first
MOST_WHIRLS = 64  # that are kept, of those that grow fastest
_MODES = 12
_PAYS = 0.75  # of the dofs for all walls, how many at most for each alone
# Places in a row of `Survey.whirls`: Re and Im of the root, and what goes with it.
WHIRL = places(("growth", "omega", "is_backward", "case", "speed"))


class Survey(NamedTuple):
    """basis: of a long shaft's coarse dofs, shape (n, coarse), or of none; mass: factors of their
    mass matrix. alone, mass_alone: of a shaft in many bearings the same, of fewer dofs, for each
    interface while it alone of all walls is closed, or of none; first_wall: the interface whose one
    serves while all are open; in_use: how many coarse dofs there are now, and of which interface
    the basis is, -1 of all. The rest is scratch, `half` being the coarse dofs and the housings: K,
    C, G and K_shaft times M^-1 from the left; of each interface what it feels, and M^-1 times what
    it pushes; the tangents dF = p z + q conj(z) by displacement [N/m] and by velocity [N.s/m]; the
    machine x' = A x in real coordinates, and where its roots are found; one root's equation and its
    vector; all roots.

    whirls: the growing whirls, the fastest first: Re and Im of the root [1/s], 1 if backward,
    `case` (`whirls`), speed [rad/s]; counted: how many; rest: root of a growth at rest, or NaN
    [1/s].
    """

    basis: Annotated[np.ndarray, float, "n", "basis"]
    mass: Annotated[np.ndarray, float, "coarse", "coarse_width"]
    alone: Annotated[np.ndarray, float, "alone", "n", "few"]
    mass_alone: Annotated[np.ndarray, float, "alone", "few", "few"]
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
    A: Annotated[np.ndarray, float, "4 * (coarse + housings)", "4 * (coarse + housings)"]
    work: Annotated[np.ndarray, float, "4 * (coarse + housings)", "4 * (coarse + housings)"]
    D: Annotated[np.ndarray, complex, "2 * (coarse + housings)", "2 * (coarse + housings)"]
    vector: Annotated[np.ndarray, complex, "2 * (coarse + housings)"]
    re: Annotated[np.ndarray, float, "4 * (coarse + housings)"]
    im: Annotated[np.ndarray, float, "4 * (coarse + housings)"]
    along: Annotated[np.ndarray, complex, "n"]
    product: Annotated[np.ndarray, complex, "n"]
    column: Annotated[np.ndarray, float, "coarse"]
    whirls: Annotated[np.ndarray, float, str(MOST_WHIRLS), str(len(WHIRL))]
    counted: Annotated[np.ndarray, np.int64, "1"]
    rest: Annotated[np.ndarray, complex, "1"]


class CoarseShaft(NamedTuple):
    """`basis`, `mass`, `alone`, `mass_alone` and `first_wall` of a `Survey`."""

    basis: np.ndarray
    mass: np.ndarray
    alone: np.ndarray
    mass_alone: np.ndarray
    first_wall: int


def coarse_shaft(structure: Structure) -> CoarseShaft:
    """Return what a survey of this machine works in."""
    n = len(structure.weight)
    none = np.zeros((0, n, 0)), np.zeros((0, 0, 0)), 0
    if n <= MOST_DOFS:
        return CoarseShaft(np.zeros((n, 0)), structure.M_factors, *none)
    retained, basis = component_modes(structure, _MODES)
    mass = basis.T @ product(structure.M, basis)
    alone = none if basis.shape[1] <= MOST_DOFS else _alone(structure, retained, basis, mass)
    return CoarseShaft(basis, _factors(mass), *alone)


def _factors(mass: np.ndarray) -> np.ndarray:
    """Return the factors of a mass matrix."""
    band = to_band(mass, len(mass) - 1)
    interpreted(factorize)(band)
    return band


def _alone(
    structure: Structure, retained: np.ndarray, basis: np.ndarray, mass: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return `alone`, `mass_alone` and `first_wall`: each wall retained with the first and the last
    one and with all that is no wall, and the rest of the basis in as many modes as ever."""
    interfaces = structure.interfaces
    walls = np.flatnonzero(interfaces.slips == 1)
    soft = np.append(interfaces.dof[interfaces.slips == 0], structure.springs.dof)
    loose = np.isin(retained, np.setdiff1d(np.unique(interfaces.dof[walls])[1:-1], soft))
    held = np.flatnonzero(~loose)
    few = len(held) + 1 + _MODES
    if len(walls) == 0 or few > _PAYS * len(mass):
        return np.zeros((0, len(basis), 0)), np.zeros((0, 0, 0)), 0
    K = basis.T @ product(structure.K_shaft, basis)
    alone = np.zeros((len(interfaces), len(basis), few))
    mass_alone = np.zeros((len(interfaces), few, few))
    for j in walls.tolist():
        place = int(np.searchsorted(retained, interfaces.dof[j]))
        mine = np.union1d(held, [place])
        rest = np.delete(np.arange(len(mass)), mine)
        shapes = np.zeros((len(mass), few))
        shapes[mine, np.arange(len(mine))] = 1.0
        shapes[rest] = np.hstack(held_shapes(K, mass, rest, mine, few - len(mine)))
        alone[j] = basis @ shapes
        mass_alone[j] = _factors(shapes.T @ mass @ shapes)
    return alone, mass_alone, int(walls[0])
