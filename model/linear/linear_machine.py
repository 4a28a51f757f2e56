"""The machine linearized where a force holds it at a speed, found by Newton's method.

Between its steps nothing changes but the laws' tangents, of a few interfaces. So the matrix with
the first of them is factorized, and those that follow change it by X^T T X of their differences T:

    (A - X^T T X) u = g,    T d = (1 - T C)^-1 T X A^-1 g,    C = X A^-1 X^T,

with the displacements d = X u of the interfaces (Woodbury).
"""

from collections.abc import Callable, Iterator
from functools import lru_cache
from threading import get_ident

import numpy as np

from ..machine.rotor import Rotor
from .bearing_equilibrium import check_films
from .linearization import Linearization, check_contacts
from .real_matrices import in_plane, to_complex, x_and_y
from .system_at_speed import Linear, LinearError

_FALLEN = 0.5  # of a clearance, where the middle is no place to begin from
_ITERATIONS = 200
_SHARES = tuple(0.5**i for i in range(41))  # of a step, down to what is rounding of it
_ULP = 2.0**-52  # of the displacements: a shorter step changes nothing
_MORE = 1.01  # of how far tangents led before: what is rounding where nothing holds the machine
# Of the displacements, and of `small` where they are none but rounding; the second of a change that
# no longer shrinks, the third where shorter steps still lead nearer, as where a pad is about to
# bear, whose force sets in with an infinite slope; of what they lead to, by which they do.
CHANGE, _STEADY, _STEADY_ASTRIDE, _NEARER = 1e-12, 1e-6, 1e-9, 0.99
_MOST = 100.0  # times as soft or as stiff: as much of a solution's digits is lost

# From a place and the laws' force there to where tangents lead, and the elements' end forces.
Lead = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class LinearMachine(Linearization):
    """A machine for linear analyses, linearized at its equilibrium; contacts: as of
    `Linearization`."""

    def __init__(self, rotor: Rotor, contacts: str | None = None) -> None:
        super().__init__(rotor, contacts)
        self._onto = self._across.T.tocsr()
        self.curved = np.flatnonzero(self._acts & self._is_curved)
        self.onto_curved = self._onto[:, x_and_y(self.curved)].toarray()
        self._held_softly = self._soft * self.system.places.matrix(self._M)

    def at(self, speed: float) -> Linear:
        """Return the machine at a speed [rad/s], linearized where gravity holds it; where nothing
        does, or all laws are linear, at no displacement. Raises `LinearError` if Newton's method
        finds no equilibrium."""
        needs_rest = (self._acts & self._is_curved).any() and self.holds_at(speed)
        return self.loaded(speed) if needs_rest else self.at_zero_load(speed)

    def loaded(self, speed: float, loads: np.ndarray | None = None) -> Linear:
        """Return the machine at a speed [rad/s] linearized where gravity and `loads` hold it;
        loads: x, y of every dof, shape (2 size,) [N, N.m]."""
        given = self.static_load if loads is None else self.static_load + loads
        if not self._holds_at(speed, given):
            turning = "; it is held as it turns: give a speed above 0"
            raise LinearError(self.why_not_held() + (turning if self._is_held_turning else ""))
        force = self.expand.T @ given
        for start in self._starts(force):
            linear = self._rested(speed, force, start)
            if linear is None:
                continue
            at, names = to_complex(self._across @ linear.rest), self.supports.interfaces
            check_films(self.rotor, names, speed, at, linear.laws.force, self.laws)
            return self.vibrating(linear, abs(speed))
        raise LinearError(f"no static equilibrium at {speed:g} rad/s was found")

    def _starts(self, force: np.ndarray) -> Iterator[np.ndarray]:
        """Yield where an equilibrium under a force on the unknowns is looked for, the same places
        whatever was asked before: whether a pad that begins to bear does so depends on that, within
        rounding. In the middle of a film with pads on one side only, tangents may lead a journal
        away from these: second, it has moved by a share of the least clearance as the force
        pulls."""
        yield np.zeros_like(force)
        pull = complex(*(self._rigid()[:, :2].T @ force))
        clearances = self._lengths[self._lengths > 0.0]
        if pull and len(clearances):
            yield self._moved(pull / abs(pull), _FALLEN * float(clearances.min()))

    def _rested(self, speed: float, force: np.ndarray, rest: np.ndarray) -> Linear | None:
        """Return the machine at a speed [rad/s] linearized where a force holds it, looked for from
        a place on by Newton's method; None where that finds nothing. Each step is halved until its
        tangents, from where it ends, lead hardly further than they did from where it began, which
        is no worse in other units (Deuflhard 2011)."""
        linear = self.linearized(speed, rest)
        least, before = CHANGE * self.structure.numbers[0].small, 0.0
        # where nothing pulls at it, however softly it is held: the laws' rounding may lead far then
        stiffness = np.abs(linear.laws.by_d).max(initial=0.0)
        pulls = np.abs(self.with_laws(force, linear.laws.force, rest)).max(initial=0.0)
        if not rest.any() and pulls <= least * stiffness:
            return linear
        leading = _Leading(self, linear, force)
        for _ in range(_ITERATIONS):
            lead = leading.by(linear)
            if lead is None:
                leading = _Leading(self, linear, force)
                lead = leading.first
            result, _ = lead(rest, linear.laws.force)
            change, size = (np.abs(x).max(initial=0.0) for x in (result - rest, result))
            step, states = self.within_films(rest, result) - rest, linear.states
            for share in _SHARES:
                linear = self.linearized(speed, rest + share * step, 0.0, states)
                ahead, pull = lead(linear.rest, linear.laws.force)
                left = np.abs(ahead - linear.rest).max(initial=0.0)
                if left <= _MORE * change or share * change <= _ULP * size:
                    break
            rest = linear.rest
            is_astride = share < 1.0 and left < _NEARER * change
            steady = _STEADY_ASTRIDE if is_astride else _STEADY
            is_steady = change <= steady * size and change >= 0.5 * before > 0.0
            if left <= max(CHANGE * size, least) or is_steady:
                return linear._replace(pull=pull)
            before = change
        return None

    def softly_held(self, own_K: np.ndarray) -> np.ndarray:
        """Return the numbers of a stiffness with what holds the machine softly at a place."""
        return own_K + self._soft * self._M

    def with_laws(self, force: np.ndarray, of_laws: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Return a force on the unknowns with those of the laws, complex of shape (interfaces,),
        and of what holds the machine softly at a place [N]."""
        return force + self._onto @ in_plane(of_laws) + self._held_softly @ at


def shared_machine(rotor: Rotor, contacts: str | None = None) -> LinearMachine:
    """Return the machine for linear analyses: the one that was made for the last of them, where it
    is of the same rotor, as a command and a report have several. Raises as `LinearMachine`."""
    check_contacts(contacts)  # before what is no word, and cannot be looked up, is
    return _of_thread(rotor, contacts, get_ident())


@lru_cache(maxsize=4)
def _of_thread(rotor: Rotor, contacts: str | None, thread: int) -> LinearMachine:
    """Each thread has machines of its own: their laws are calculated within one block of memory."""
    return LinearMachine(rotor, contacts)


class _Leading:
    """Where tangents lead a machine under a force, softly held where it is, for they may hold it in
    one direction only."""

    def __init__(self, machine: LinearMachine, linear: Linear, force: np.ndarray) -> None:
        self._machine, self._force, self._base = machine, force, linear.laws.by_d
        self._solve = linear._replace(own_K=machine.softly_held(linear.own_K)).factorized()
        self._moved, self._pulled = self._solve(machine.onto_curved)
        self._flexibility = machine.onto_curved.T @ self._moved
        self.first = self._lead(self._base, None)

    def by(self, linear: Linear) -> Lead | None:
        """Return where the tangents at a place lead; None if they differ so much from the first
        ones that these are to be replaced."""
        curved = self._machine.curved
        m, each = len(curved), np.arange(len(curved))
        blocks = np.zeros((m, 2, m, 2))
        blocks[each, :, each] = (linear.laws.by_d - self._base)[curved]
        change = blocks.reshape(2 * m, 2 * m)
        if not change.any():
            return self.first
        one = np.eye(len(change)) - change @ self._flexibility
        try:
            back = np.linalg.inv(one)
        except np.linalg.LinAlgError:
            return None
        if not max(np.abs(one).max(), np.abs(back).max()) <= _MOST:
            return None
        return self._lead(linear.laws.by_d, back @ change)

    def _lead(self, by_d: np.ndarray, by_first: np.ndarray | None) -> Lead:
        machine = self._machine

        def lead(at: np.ndarray, of_laws: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            # not by what is left: that is small numbers of large ones where the shaft is stiff
            of_laws = of_laws - to_complex(machine.tangent(by_d, at))
            moved, pull = self._solve(machine.with_laws(self._force, of_laws, at))
            if by_first is None:
                return moved, pull
            more = by_first @ (machine.onto_curved.T @ moved)
            return moved + self._moved @ more, pull + self._pulled @ more

        return lead
