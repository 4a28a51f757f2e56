"""A force law between a node and a housing, and the calls of a machine's laws in compiled code.

A law is a handful of compiled functions of a record `part` with the quantities of the part, by
their names, and of the node's `Kinematics` relative to the housing:

    force(part, tables, kinematics, internal_state)                   -> F
    tangent(part, tables, kinematics, weights, free, internal_state)  -> F, p, q
    energy(part, tables, displacement, internal_state)                -> energies
    dissipate(part, tables, kinematics, internal_state, out)          -> torque
    rates(part, tables, kinematics, internal_state, out)
    observe(part, tables, kinematics, internal_state, out)
    gap(part, displacement)                                           -> distance
    length(part)                                                      -> scale
    breaks(part, tables, displacement, internal_state)                -> whether it does
    vibrate(part, tables, kinematics, frequency, free, internal_state)
                                                        -> F, p, q by d, p, q by d'
    linearize(part, tables, kinematics, internal_state, solved, slopes)
                                                        -> F, p, q by d, p, q by d'
    weigh(part, tables, gravity)

F: complex force on the node [N]; the housing gets -F. tangent: the derivative of F for the given
`Weights`, as the pair of the real-linear map z -> p z + q conj(z). energy: a tuple of the stored
energies [J], in the order of `Law.stores`. dissipate: fills `out` with the dissipated powers [W] at
the `places` of `Law.losses`; returns the torque that brakes the rotor [N.m]. observe: fills `out`
at the places of `Law.outputs`. gap: distance of the displacement from the onset of the force [m],
negative where it acts. length: characteristic displacement [m], 0 for that of the machine; of a law
with a wall the wall's radius. breaks: whether the law is invalid at a displacement, so that a run
stops there. vibrate: for a node at rest, with its internal states in equilibrium, searched for from
`free` on and stored: the force there, and the derivatives of F by displacement and velocity while
the states follow a vibration of a frequency [rad/s]. linearize: the force at given states and its
derivatives by displacement and velocity while these stay; it fills in `StateSlopes`, and may use
`solved`, of as many numbers as states. weigh: stores the machine's gravity [m/s2], complex, in the
part's table, before a run and whenever it changes.

tables: numbers of all parts that do not fit into a record, one flat array; the records of a law
with a `table` have its first index, `part.table`, and its length, `part.rows`.

A law may have internal states, `internal_state`, shape (len(Law.states),): rates fills in their
rates. Over a step they are implicit, internal_state = free + weights.rate * rate: `tangent` solves
for them, stores them in `internal_state`, and includes their derivatives in p and q. Two of them,
from the index `Law.bow` on, may be a bow that the law gives the shaft at its node
(`structure.bow`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..kernels.jit import jit
from ..quantities import Output, quantities

_Kernel = Callable[..., Any]


class Kinematics(NamedTuple):
    """Motion of a node relative to its housing or to ground: displacement u + i v [m] and velocity
    [m/s]; speed: of the machine [rad/s], on which coefficients may depend; sliding_speed: at which
    the journal's surface slides on its counterpart [rad/s], 0 in the search for an equilibrium,
    which has no friction; angle: of the rotor [rad]."""

    displacement: complex
    velocity: complex
    speed: float
    sliding_speed: float
    angle: float


class Weights(NamedTuple):
    """Weights of a tangent: dF = displacement dF/dd + velocity dF/dd', for an unknown of which d
    and d' are linear functions; rate: internal_state = free + rate * rates, of a law's states
    [s]."""

    displacement: float
    velocity: float
    rate: float


BY_D, BY_V = Weights(1.0, 0.0, 0.0), Weights(0.0, 1.0, 0.0)


class StateSlopes(NamedTuple):
    """What a law's `linearize` fills in of its s internal states: their rates, shape (s,); the
    derivatives of the force by them, complex; those of their rates by displacement and velocity, as
    g: they change by Re(conj(g) z); and by the states, shape (s, s)."""

    rates: np.ndarray
    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray
    by_states: np.ndarray


@jit
def no_length(part):
    """Return 0, the length of a law that does not define one."""
    return 0.0


@jit
def always_acts(part, displacement):
    """Return the gap of a law without a wall, which always acts."""
    return -1.0


@jit
def never_breaks(part, tables, displacement, internal_state):
    """Return False: the law is valid at every displacement."""
    return False


@jit
def weighs_nothing(part, tables, gravity):
    """Do nothing: `Law.weigh` of a law without mass."""
    return


@jit
def no_rates(part, tables, kinematics, internal_state, out):
    """Do nothing: `Law.rates` of a law without states."""
    return


@dataclass(frozen=True, eq=False)
class Law:
    """A force law: its compiled functions, and the entries that it adds to outputs and ledger.

    Laws of one name have the same functions, or do without some of them and of the entries: the
    kernels have the last of `Part.LAWS`.

    name: of its records
    kind: data class whose quantities the records hold
    force, tangent, energy, dissipate, observe: compiled functions, see the module
    outputs: at whose `places` `observe` fills
    stores: energies that it stores [J], in the order in which `energy` returns them
    losses: energies that it dissipates [J], at whose places `dissipate` fills in the powers [W]
    gap, length, rates, breaks, weigh: compiled functions of a law with a wall, with a length of its
        own, with states, with displacements that it does not allow, with mass
    vibrate: of a law whose states follow a vibration; the states of others stay
    linearize: of a law with states that has the derivatives by them; of others they are differences
    states: values of its states at the start
    of_part: how many states a part has, all 0 at the start, and its outputs, where they depend on
        it: those of the law, then more
    state_units: of the states of a part, m, m/s or rad/s, from the first on over and over
    whirls: whether its states, which `linearize` has, whirl at frequencies of their own, as those
        of a body in films do; others follow whatever vibrates
    bow: place among its states of the bow of the shaft at its node [m], in x and y of a frame that
        turns with the rotor
    has_wall: whether the force begins at a wall, the circle of radius `length` about the housing
    turns: whether friction turns that wall, which then slips for a while only
    table: of a part, shape (rows, columns), where the law takes one
    stiffness: by which a part holds its node at rest [N/m], where the law holds it softly
    seat: how far a part lets its node fall before it holds it [m], where it does not at no
        displacement
    """

    name: str
    kind: type
    force: Callable[..., Any]
    tangent: Callable[..., Any]
    energy: Callable[..., Any]
    dissipate: Callable[..., Any]
    observe: Callable[..., Any]
    outputs: tuple[Output, ...]
    stores: tuple[Output, ...]
    losses: tuple[Output, ...]
    gap: Callable[..., Any] = always_acts
    length: Callable[..., Any] = no_length
    rates: Callable[..., Any] = no_rates
    breaks: Callable[..., Any] = never_breaks
    weigh: Callable[..., Any] = weighs_nothing
    vibrate: Callable[..., Any] | None = None
    linearize: Callable[..., Any] | None = None
    states: tuple[float, ...] = ()
    of_part: Callable[[Any], tuple[int, tuple[Output, ...]]] | None = None
    state_units: Callable[[Any], tuple[str, ...]] = lambda part: ("m",)
    whirls: bool = False
    bow: int | None = None
    has_wall: bool = False
    turns: bool = False
    table: Callable[[Any], np.ndarray] | None = None
    stiffness: Callable[[Any], float] | None = None
    seat: Callable[[Any], float] | None = None

    def states_of(self, part: Any) -> tuple[float, ...]:
        """Return the values of the states of a part with this law at the start."""
        return (0.0,) * self.of_part(part)[0] if self.of_part else self.states

    def outputs_of(self, part: Any) -> tuple[Output, ...]:
        """Return the outputs of a part with this law: those of the law, and more."""
        return self.of_part(part)[1] if self.of_part else self.outputs

    @property
    def vibrates(self) -> bool:
        """Whether its states follow a vibration, and may be unknowns of the linearized machine."""
        return self.vibrate is not None and self.linearize is not None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Law) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    @property
    def dtype(self) -> np.dtype:
        """The type of a record: the part's quantities by their names, and its table's location."""
        places = [("table", "i8"), ("rows", "i8")] if self.table else []
        return np.dtype([*((name, "f8") for name in quantities(self.kind)), *places])


def _link(code: int, function: _Kernel, rest: _Kernel | None) -> _Kernel:
    """Return a function that calls `function` for interfaces of the law `code`, else `rest`."""
    if rest is None:

        def call(laws, interface, *arguments):
            return function(laws[code][interface.row], *arguments)
    else:

        def call(laws, interface, *arguments):
            if interface.law == code:
                return function(laws[code][interface.row], *arguments)
            return rest(laws, interface, *arguments)

    return jit(call, to_cache=False)


def dispatcher(functions: Sequence[_Kernel], takes_tables: bool = True) -> _Kernel:
    """Return one compiled function `call(laws, interface, ...)` for one function of each law.

    laws: the records of each law, in the order of `functions`, and last the tables; interface: a
    record whose `law` is the index in that order and whose `row` is that of the law's record;
    takes_tables: whether the functions take the tables behind the record.
    """
    *others, lowest = range(len(functions))
    call = _link(lowest, functions[lowest], None)
    for code in reversed(others):
        call = _link(code, functions[code], call)
    if not takes_tables:
        return call
    last = len(functions)

    def call_with_tables(laws, interface, *arguments):
        return call(laws, interface, laws[last], *arguments)

    return jit(call_with_tables, to_cache=False)
