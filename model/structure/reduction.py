"""Fewer degrees of freedom: Craig-Bampton component modes of a `Structure`.

Retained are the deflections at which something acts: bearings, discs, coupling and supports, and
the slopes at the ends of what a bow bends. The rest of the shaft follows them statically, q_i = Psi
q_b, and vibrates in its lowest modes with those fixed (Craig and Bampton 1968).
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..kernels.band import factorize, to_band, to_dense
from ..kernels.kernel import interpreted
from ..machine.rotor import Rotor
from ..machine.speed_ranges import SpeedRange, speed_ranges
from ..one_thread import on_one_thread
from .assembly import assemble, machine_elements, soft_stiffness, with_renumbered_dofs
from .sparse_modes import LONG, fixed_interface_modes, sparse
from .structure import WEIGHT, Structure

# Share by which a frequency may move; multiple of the speed up to which frequencies are excited;
# number of moved frequencies that a warning names; share of the lowest elastic frequency below
# which the shaft moves as a rigid body.
_MOVED, _EXCITED, _SAID, _SLOW = 0.02, 2.0, 3, 1e-3
_ROUNDING = 1e-9  # of the largest pull of a bow
_MATRICES = ("M", "C", "K", "G", "M_shaft", "K_shaft", "K_axial")


@on_one_thread
def component_modes(structure: Structure, modes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the retained dofs, shape (b,), and the basis T of all n dofs, shape (n, b + modes).

    modes: number of fixed-interface modes, at most all.
    """
    n = len(structure.static_load)
    on_shaft = structure.load_dof >= 0
    acted_on = [structure.load_dof[on_shaft], structure.load_arms.slope[on_shaft]]
    acted_on += [
        getattr(structure, of).dof
        for of in ("interfaces", "springs", "unbalances", "forces", "probes", "velocities")
    ]
    acted_on += [getattr(structure, of).slope for of in ("unbalances", "forces", "probes")]
    pull = np.abs(structure.bow_forces)  # moments at the ends of what is bent, rounding elsewhere
    acted_on.append(np.flatnonzero((pull > _ROUNDING * pull.max(initial=0.0)).any(axis=0)))
    retained = np.unique(np.concatenate(acted_on))
    retained = retained[retained < n]  # those behind are housings
    rest = np.setdiff1d(np.arange(n), retained)
    modes = min(modes, len(rest))
    if n > LONG and modes < len(rest) // 2:
        K, M = sparse(structure.K_shaft), sparse(structure.M)
        static, shapes = fixed_interface_modes(K, M, rest, retained, modes)
    else:
        M, K = to_dense(structure.M), to_dense(structure.K_shaft)
        static, shapes = dense_fixed_interface_modes(K, M, rest, retained, modes)
    T = np.zeros((n, len(retained) + modes))
    T[retained, np.arange(len(retained))] = 1.0
    T[rest] = np.hstack([static, shapes])
    return retained, T


def dense_fixed_interface_modes(
    K: np.ndarray, M: np.ndarray, rest: np.ndarray, retained: np.ndarray, modes: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same as `sparse_modes.fixed_interface_modes`, by dense matrices."""
    inner = np.ix_(rest, rest)
    inverse = np.linalg.inv(np.linalg.cholesky(M[inner]))
    _, vectors = np.linalg.eigh(inverse @ K[inner] @ inverse.T)
    static = -np.linalg.solve(K[inner], K[np.ix_(rest, retained)])
    return static, (inverse.T @ vectors)[:, :modes]


@on_one_thread
def reduced(structure: Structure, modes: int) -> Structure:
    """Return the structure in its component modes: full matrices of b + modes dofs, the retained
    ones first.

    It is exact with all modes; with few, for motions slower than the first mode left out.
    """
    retained, T = component_modes(structure, modes)
    n, size = T.shape
    dense = {name: T.T @ to_dense(getattr(structure, name)) @ T for name in _MATRICES}
    bands: dict[str, Any] = {name: to_band(matrix, size - 1) for name, matrix in dense.items()}
    M_factors = bands["M"].copy()
    interpreted(factorize)(M_factors)
    place = {dof: i for i, dof in enumerate(retained.tolist())}

    def place_of(dofs: np.ndarray) -> np.ndarray:
        # housings and ground stand behind the dofs
        moved_to = [place[dof] if dof < n else dof + size - n for dof in dofs.tolist()]
        return np.array(moved_to, dtype=np.int64)

    at = with_renumbered_dofs(structure, place_of)
    at["interfaces"].end += size - n
    deflections = structure.deflections[np.isin(structure.deflections[:, 0], retained)].copy()
    deflections[:, 0] = place_of(deflections[:, 0])
    # a motion as one body needs no mode
    one_body = np.zeros((2, size))
    one_body[:, : len(retained)] = structure.one_body[:, retained]
    weights = np.zeros((n, n))
    weights[structure.weights.i, structure.weights.k] = structure.weights.weight
    return structure._replace(
        **bands,
        **at,
        M_factors=M_factors,
        weights=_weights(T.T @ weights @ T),
        mass_sum=T.T @ structure.mass_sum,
        static_load=T.T @ structure.static_load,
        one_body=one_body,
        bow_forces=structure.bow_forces @ T,
        deflections=deflections,
    )


def _weights(matrix: np.ndarray) -> np.recarray:
    i, k = np.triu_indices(len(matrix))
    weights = np.where(i == k, 1.0, 2.0) * matrix[i, k]
    return np.rec.array(list(zip(i, k, weights, strict=True)), dtype=WEIGHT)


def assembled(rotor: Rotor, modes: int) -> tuple[Structure, list[SpeedRange]]:
    """Return the structure of a machine, reduced to a number of component modes unless it is 0, and
    the ranges of the speed beyond which a warning is given."""
    structure, ranges = assemble(rotor), speed_ranges(rotor)
    if modes == 0:
        return structure, ranges
    return reduced(structure, modes), [*ranges, *reduction_warnings(rotor, structure, modes)]


class _Spectrum:
    """Frequencies of a shaft at standstill for any number of component modes."""

    def __init__(self, rotor: Rotor, structure: Structure) -> None:
        self._kept, T = component_modes(structure, len(structure.static_load))
        held = soft_stiffness(len(T), structure.springs, machine_elements(rotor))
        K = to_dense(structure.K_shaft) + to_dense(structure.K_axial) + np.diag(held)
        self._M, self._K = T.T @ to_dense(structure.M) @ T, T.T @ K @ T
        self._walls = structure.interfaces.dof[structure.interfaces.has_wall == 1]
        self.most = len(T) - len(self._kept)
        self.slow = _SLOW * structure.numbers[0].lowest_omega

    @property
    def has_walls(self) -> bool:
        """Whether there are contacts, which may be open or pinned."""
        return len(self._walls) > 0

    def frequencies(self, modes: int, is_pinned: bool) -> np.ndarray:
        """Return the frequencies of the elastic modes [rad/s], ascending; rigid-body modes are
        exact in any case."""
        held = np.isin(self._kept, self._walls) if is_pinned else np.zeros(len(self._kept), bool)
        free = np.flatnonzero(~np.append(held, np.zeros(modes, bool)))
        among = np.ix_(free, free)
        inverse = np.linalg.inv(np.linalg.cholesky(self._M[among]))
        squares = np.linalg.eigvalsh(inverse @ self._K[among] @ inverse.T)
        return np.sqrt(squares[squares > self.slow**2])


@on_one_thread
def reduction_warnings(rotor: Rotor, structure: Structure, modes: int) -> list[SpeedRange]:
    """Return the ranges of the speed beyond which the reduction to so many modes shifts or loses
    modes that the speed excites: the lowest modes at standstill, with contacts open and pinned."""
    spectrum = _Spectrum(rotor, structure)
    if modes >= spectrum.most:
        return []
    states = (False, True) if spectrum.has_walls else (False,)
    return [result for is_pinned in states for result in _warnings_for(spectrum, modes, is_pinned)]


def _warnings_for(spectrum: _Spectrum, modes: int, is_pinned: bool) -> Iterator[SpeedRange]:
    """Yield the warnings for contacts open, or pinned."""
    full = spectrum.frequencies(spectrum.most, is_pinned)
    for place in _displaced_modes(spectrum.frequencies(modes, is_pinned), full)[:_SAID]:
        few, enough = modes, spectrum.most
        while enough - few > 1:
            middle = (few + enough) // 2
            off = _displaced_modes(spectrum.frequencies(middle, is_pinned), full[: place + 1])
            few, enough = (middle, enough) if len(off) else (few, middle)
        yield _warning_for_mode(spectrum, modes, is_pinned, full[place], int(place), enough)


def _displaced_modes(reduced: np.ndarray, full: np.ndarray) -> np.ndarray:
    """Return the indices of the modes that the reduction has shifted, or does not have."""
    there = np.full(len(full), math.inf)
    there[: len(reduced)] = reduced[: len(full)]
    return np.flatnonzero(there > (1.0 + _MOVED) * full)


def _warning_for_mode(
    spectrum: _Spectrum, modes: int, is_pinned: bool, omega: float, place: int, enough: int
) -> SpeedRange:
    """Return the warning for one mode; enough: number of component modes that would preserve it."""
    reduced = spectrum.frequencies(modes, is_pinned)
    how = f"is moved to {_hertz(reduced[place])}" if place < len(reduced) else "is lost"
    contacts = f" with contacts {'pinned' if is_pinned else 'open'}" if spectrum.has_walls else ""
    highest = omega / _EXCITED
    return SpeedRange(
        0.0,
        highest,
        f"solver.reduction = {modes} is too coarse: mode {place + 1} of the shaft{contacts}, "
        f"{_hertz(omega)}, {how}, and the speed, {{speed:.4g}} rad/s, is above half of it; use at "
        f"least {enough}, or 0 (no reduction)",
        "reduction-too-coarse",
        is_of_size=True,
    )


def _hertz(omega: float) -> str:
    return f"{omega / (2 * math.pi):.4g} Hz"
