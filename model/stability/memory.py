"""What the survey of growing whirls needs of a run's block: a long shaft's basis, and scratch."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import factorize, product, to_band
from ..kernels.jit import interpreted
from ..quantities import places
from ..structure.reduction import component_modes
from ..structure.structure import Structure

MOST_DOFS = 24  # of the shaft; a longer one is reduced first
MOST_WHIRLS = 64  # that are kept, of those that grow fastest
_MODES = 12
# Places in a row of `Survey.whirls`: Re and Im of the root, and what goes with it.
WHIRL = places(("growth", "omega", "is_backward", "case", "speed"))


class Survey(NamedTuple):
    """basis: of a long shaft's coarse dofs, shape (n, coarse), or of none; mass: factors of their
    mass matrix. The rest is scratch, `half` being the coarse dofs and the housings: K, C, G and
    K_shaft times M^-1 from the left; of each interface what it feels, and M^-1 times what it
    pushes; the tangents dF = p z + q conj(z) by displacement [N/m] and by velocity [N.s/m]; the
    machine x' = A x in real coordinates, and where its roots are found; one root's equation and its
    vector; all roots.

    whirls: the growing whirls, the fastest first: Re and Im of the root [1/s], 1 if backward,
    `case` (`whirls`), speed [rad/s]; counted: how many; rest: root of a growth at rest, or NaN
    [1/s].
    """

    basis: Annotated[np.ndarray, float, "n", "basis"]
    mass: Annotated[np.ndarray, float, "coarse", "coarse_width"]
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
    along: Annotated[np.ndarray, float, "n"]
    product: Annotated[np.ndarray, float, "n"]
    column: Annotated[np.ndarray, float, "coarse"]
    whirls: Annotated[np.ndarray, float, str(MOST_WHIRLS), str(len(WHIRL))]
    counted: Annotated[np.ndarray, np.int64, "1"]
    rest: Annotated[np.ndarray, complex, "1"]


def coarse_shaft(structure: Structure) -> tuple[np.ndarray, np.ndarray]:
    """`basis` and `mass` of a survey of this machine."""
    n = len(structure.weight)
    if n <= MOST_DOFS:
        return np.zeros((n, 0)), structure.M_factors
    _, basis = component_modes(structure, _MODES)
    mass = to_band(basis.T @ product(structure.M, basis), basis.shape[1] - 1)
    interpreted(factorize)(mass)
    return basis, mass
