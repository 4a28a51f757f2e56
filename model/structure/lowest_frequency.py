"""The lowest elastic natural frequency of a shaft, for any number of nodes and any stiffness."""

import math
from collections.abc import Sequence

import numpy as np

from ..kernels.band import to_dense
from ..machine.rotor import Rotor
from ..one_thread import on_one_thread
from ..quantities import QuantityError
from .beam import shaft_element
from .sparse_modes import LONG, lowest_square_free, lowest_square_supported, sparse

_LOST = 1e-11  # of the highest square of a frequency: below it rounding takes digits of one


@on_one_thread
def lowest_omega(
    rotor: Rotor,
    M: np.ndarray,
    K_shaft: np.ndarray,
    K_axial: np.ndarray,
    held: np.ndarray,
    bearings: Sequence[int],
    walls: Sequence[int],
) -> float:
    """Return the lowest elastic natural frequency [rad/s] of the band matrices of a shaft that is
    held by stiffnesses [N/m] at its dofs, shape (n,), and pinned at the dofs of its other bearings;
    one that these do not support at two nodes is pinned at the dofs of its walls, too.

    Raises `QuantityError` where rounding leaves nothing of it.
    """
    supported = {*np.flatnonzero(held), *bearings}
    pinned = [*bearings, *(walls if len(supported) < 2 else ())]
    others = K_axial.copy()
    others[:, 0] += held
    free = np.delete(np.arange(len(M)), np.array(pinned, dtype=int))
    among = np.ix_(free, free)
    is_supported = len(supported.union(pinned)) >= 2
    try:
        if len(M) > LONG:
            if is_supported:
                return math.sqrt(_lowest_square(rotor, M, others, free))
            K, whole = sparse(K_shaft + others), sparse(M)
            shift = _bending_square(rotor)
            return math.sqrt(lowest_square_free(K[free][:, free], whole[free][:, free], shift))
        inverse = np.linalg.inv(np.linalg.cholesky(to_dense(M)[among]))
        squares = np.linalg.eigvalsh(inverse @ to_dense(K_shaft + others)[among] @ inverse.T)
        if is_supported and squares[0] < _LOST * squares[-1]:
            return math.sqrt(_lowest_square(rotor, M, others, free))
    except (np.linalg.LinAlgError, RuntimeError):
        raise QuantityError(
            "shaft: its masses and stiffnesses differ by too many orders of magnitude; look for a "
            "length or a diameter of a wrong power of ten"
        ) from None
    # smaller eigenvalues are rigid-body motions and rounding
    return math.sqrt(squares[squares > 1e-13 * squares[-1]][0])


def _lowest_square(rotor: Rotor, M: np.ndarray, others: np.ndarray, free: np.ndarray) -> float:
    """Return the lowest squared natural frequency of a supported shaft [rad2/s2], accurate for any
    stiffness; others: all stiffness but the shaft's; free: the dofs that may move."""
    from .strain_solver import Places, StrainedMatrices, strains

    across, stiffness = strains(rotor)
    own = sparse(others)[free][:, free].tocoo()
    places = Places(len(free), own.row, own.col)
    system = StrainedMatrices(places, across[:, free], stiffness)
    numbers = places.numbers(own.row, own.col, own.data)
    solve = system.factorized(numbers, np.eye(1), refines=False)  # no masses are in it
    return lowest_square_supported(lambda f: solve(f)[0], sparse(M)[free][:, free])


def _bending_square(rotor: Rotor) -> float:
    """Return an estimate of the lowest squared bending frequency of the free shaft [rad2/s2], used
    as the shift: pinned at its ends, with the mean stiffness and mass of its elements."""
    sections = rotor.sections
    stiffness = np.mean([s.length**3 * shaft_element(s).stiffness[0, 0] / 12 for s in sections])
    mass = np.mean([2 * shaft_element(s).translation[:1, ::2].sum() / s.length for s in sections])
    return float((math.pi / rotor.length) ** 4 * stiffness / mass)
