"""A force law between a node and a housing, and the calls of a machine's laws in compiled code.

With the node's displacement relative to the housing d = u + i v [m] and its velocity d', a law is a
handful of compiled functions of a record `part` with the quantities of the part, by their names:

    force(part, tables, d, d_dot, speed, spin, own)                                 -> F
    tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own)     -> F, p, q
    energy(part, tables, d, own)                                                    -> energies
    dissipate(part, tables, d, d_dot, speed, spin, own, out)                        -> torque
    rates(part, tables, d, d_dot, speed, spin, own, out)
    observe(part, tables, d, d_dot, speed, spin, own, out)
    opening(part, d)                                                                -> distance
    length(part)                                                                    -> scale

F: complex force on the node [N], the housing gets -F. speed: the machine's [rad/s], on which
coefficients may depend; spin: at which the surfaces slide [rad/s], 0 where equilibrium is sought,
which has no friction. tangent: dF for by_d dF/dd + by_v dF/dd', as the pair of the real-linear map
z -> p z + q conj(z). energy: a tuple of what is stored [J], in the order of `Law.stores`.
dissipate: fills `out` with the powers dissipated [W], in the order of `Law.losses`; returns the
torque that brakes the rotor [N.m]. opening: how far d is from where the force begins [m], negative
where it acts. length: displacement that matters [m], 0 for that of the machine; of a law with a
wall the wall's radius.

tables: numbers of all parts that a record has no room for, one array, flat; the records of a law
with a `table` say where theirs begin, `part.table`, and how many rows they have, `part.rows`.

A law may have states of its own, `own`, shape (len(Law.states),): rates fills in their rates. Over
a step they are implicit, own = free + by_own * rate: `tangent` finds them, fills `own`, and lets
them take part in p and q.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kernels.compiled import compiled
from ..quantities import Output, quantities

_Kernel = Callable[..., Any]


@compiled
def no_length(part):
    """The length of a law without one of its own."""
    return 0.0


@compiled
def always_acts(part, d):
    """The opening of a law without a wall."""
    return -1.0


@compiled
def no_rates(part, tables, d, d_dot, speed, spin, own, out):
    """The rates of a law without states."""
    return


@dataclass(frozen=True)
class Law:
    """A law: its compiled functions, and what it keeps in the ledger.

    name: of its records; kind: the data class whose quantities the records hold; stores: names and
    texts of the energies that it stores; losses: of what it dissipates; states: start values of its
    own states; has_wall: whether the force begins at a wall, the circle of radius `length` about
    the housing; turns: whether friction turns that wall, which then slips for a while only; table:
    the table of a part, shape (rows, columns), where the law takes one; stiffness: by which a part
    holds its node at rest [N/m], where the law holds it softly.
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
    opening: Callable[..., Any] = always_acts
    length: Callable[..., Any] = no_length
    rates: Callable[..., Any] = no_rates
    states: tuple[float, ...] = ()
    has_wall: bool = False
    turns: bool = False
    table: Callable[[Any], np.ndarray] | None = None
    stiffness: Callable[[Any], float] | None = None

    @property
    def dtype(self) -> np.dtype:
        """Of a record: the quantities of the part, by their names, and where its table lies."""
        places = [("table", "i8"), ("rows", "i8")] if self.table else []
        return np.dtype([*((name, "f8") for name in quantities(self.kind)), *places])


def _link(code: int, function: _Kernel, rest: _Kernel | None) -> _Kernel:
    """Calls `function` for interfaces of the law `code`, `rest` for the others."""
    if rest is None:

        def call(laws, interface, *arguments):
            return function(laws[code][interface.row], *arguments)
    else:

        def call(laws, interface, *arguments):
            if interface.law == code:
                return function(laws[code][interface.row], *arguments)
            return rest(laws, interface, *arguments)

    return compiled(call, to_cache=False)


def dispatcher(functions: Sequence[_Kernel], takes_tables: bool = True) -> _Kernel:
    """One compiled function `call(laws, interface, ...)` of a function a law.

    laws: the records of each law, in the order of `functions`, and last the tables; interface: a
    record whose `law` is the place in that order and whose `row` is that of the law's record;
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

    return compiled(call_with_tables, to_cache=False)
