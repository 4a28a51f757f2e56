"""Whether component modes would make a run cheaper, how many, and how much they change the
frequencies."""

from typing import NamedTuple

import numpy as np

from ..kernels.band import product
from ..machine.rotor import Rotor
from ..message_templates import Message
from ..one_thread import on_one_thread
from .assembly import machine_elements, soft_stiffness
from .reduction import component_modes
from .sparse_modes import sparse
from .structure import Structure

# Offered where a step takes less than this share of the work, and the frequencies that the speed
# excites, those up to so many times it, move by no more than this share.
_PAYS, _EXCITED, _MOVED = 0.3, 2.0, 1e-3
_MODES = (4, 6, 8, 12, 16)
_ROUNDING = 1e-9  # share of a frequency: the accuracy of a shift
_SLOW = 1e-3  # share of the lowest elastic frequency below which the shaft moves as a rigid body
_FIXED = 700.0  # work of a step that does not grow with the machine, as measured: 1 us of 2.5
_LOWEST = 24  # frequencies of the shaft that are looked at


def work_share(structure: Structure, size: int) -> float:
    """Return the work of a step with a number of fully coupled dofs, relative to that with the
    whole shaft."""
    n, width = structure.M.shape
    contacts = len(structure.interfaces)

    def work(n: int, width: int) -> float:
        # factors; products with four matrices and a solution; a solution for each interface
        return n * width * (width / 2 + 10.0 + 2.0 * contacts)

    return (_FIXED + work(size, size) / 2) / (_FIXED + work(n, width))


class ReductionOffer(NamedTuple):
    """A reduction that pays: component modes; the work of a step, relative to that of the machine
    of so many nodes; frequencies that a speed [rad/s] excites, and their largest relative shift, at
    standstill, with contacts open and pinned."""

    modes: int
    work: float
    nodes: int
    excited: int
    speed: float
    shift: float

    @property
    def note(self) -> Message:
        """The note that offers it."""
        return Message(
            f"solver.reduction = {self.modes} would do for this machine of {self.nodes} nodes: a "
            f"step costs about {self.work:.0%} of one with all of it, and the {self.excited} "
            f"lowest frequencies, which {self.speed:.4g} rad/s excites, move by at most "
            f"{max(self.shift, _ROUNDING):.1g} of their value",
            "reduction-pays",
        )


@on_one_thread
def reduction_offer(rotor: Rotor, structure: Structure, speed: float) -> ReductionOffer | None:
    """Return the least reduction of a machine that turns with up to `speed` [rad/s] that is both
    cheap and accurate, None without one."""
    if work_share(structure, _MODES[0] + 1 + len(structure.interfaces)) > _PAYS:
        return None
    n = len(structure.static_load)
    retained, T = component_modes(structure, _MODES[-1])
    held = soft_stiffness(n, structure.springs, machine_elements(rotor))
    K = structure.K_shaft + structure.K_axial
    K[:, 0] += held
    walls = structure.interfaces.dof[structure.interfaces.has_wall == 1]
    slow = _SLOW * structure.numbers[0].lowest_omega
    states = []
    for pinned in (np.zeros(0, dtype=int), walls) if len(walls) else (walls,):
        omegas = _frequencies(K, structure.M, pinned, slow)
        count = max(1, int(np.searchsorted(omegas, _EXCITED * abs(speed))))
        if count >= len(omegas):
            return None
        states.append((pinned, omegas[:count]))
    reduced_K, reduced_M = (T.T @ product(band, T) for band in (K, structure.M))
    for modes in _MODES:
        size = len(retained) + modes
        share = work_share(structure, size)
        if size > T.shape[1] or share > _PAYS:
            return None
        shift = 0.0
        for pinned, omegas in states:
            free = np.flatnonzero(~np.isin(retained, pinned)).tolist()
            among = np.ix_(*[[*free, *range(len(retained), size)]] * 2)
            few = _elastic(reduced_K[among], reduced_M[among], slow)[: len(omegas)]
            # fewer than the speed excites are too few
            moved = (few / omegas - 1.0).max() if len(few) == len(omegas) else np.inf
            shift = max(shift, float(moved))
        if shift <= _MOVED:
            excited = max(len(omegas) for _, omegas in states)
            return ReductionOffer(modes, share, n // 2, excited, abs(speed), shift)
    return None


def _frequencies(K: np.ndarray, M: np.ndarray, pinned: np.ndarray, slow: float) -> np.ndarray:
    """Return the lowest elastic frequencies [rad/s] of band matrices, ascending."""
    from scipy.sparse.linalg import eigsh

    free = np.delete(np.arange(len(M)), pinned)
    stiffness, mass = sparse(K)[free][:, free], sparse(M)[free][:, free]
    shift = (slow / _SLOW) ** 2
    start = np.ones(len(free))
    squares = eigsh(stiffness, k=_LOWEST, M=mass, sigma=-shift, v0=start)[0]
    return np.sqrt(np.sort(squares[squares > slow**2]))


def _elastic(K: np.ndarray, M: np.ndarray, slow: float) -> np.ndarray:
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    squares = np.linalg.eigvalsh(inverse @ K @ inverse.T)
    return np.sqrt(squares[squares > slow**2])
