"""What numerical damping hides: the steps at which integrators still see an oscillation grow."""

from collections.abc import Sequence

from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.stability import resolution
from rotor_fmu.model.stability.resolution import COARSEST
from rotor_fmu.model.stability.whirls import HIDDEN, RESOLVED

from papers.integrators.members import (
    MODERATE_DISSIPATION,
    Scheme,
    chung_hulbert,
    generalized_alpha,
)

GROWTHS = (1e-4, 1e-3, 1e-2, 0.1)  # Re lambda over |lambda| [1]
SCHEMES: tuple[tuple[str, Scheme], ...] = (
    ("Chung-Hulbert 0", chung_hulbert(0.0)),
    ("Chung-Hulbert 0.2", chung_hulbert(0.2)),
    ("Chung-Hulbert 0.3", chung_hulbert(0.3)),
    ("HHT √2 - 1", MODERATE_DISSIPATION),
    ("gen.-alpha 0.1 / 0.08", generalized_alpha(0.1, 0.08)),
)
SHARES = (RESOLVED, HIDDEN, 0.0)
_COARSE = 4.0  # omega h [rad] at which the damping is shown
_UNIT = complex(0.0, 1.0)


def root(growth: float) -> complex:
    """Of |lambda| = 1 1/s, whose real part is `growth`."""
    return complex(growth, (1 - growth**2) ** 0.5)


def longest(scheme: Scheme, growth: float) -> Sequence[float]:
    """omega h [rad] up to which an integrator leaves the shares `SHARES` of a growth."""
    resolving_step = interpreted(resolution.resolving_step)
    return [resolving_step(scheme, root(growth), share) for share in SHARES]


def hidden_rows() -> list[list[str]]:
    """A row an integrator: omega h for each growth, and how it damps what is unresolved."""
    seen_growth = interpreted(resolution.seen_growth)
    rows = []
    for name, scheme in SCHEMES:
        limits = [" / ".join(map(_limit, longest(scheme, growth))) for growth in GROWTHS]
        rows.append([name, *limits, f"{-seen_growth(scheme, _COARSE, _UNIT):.2g}"])
    return rows


def hidden_head() -> list[str]:
    """The heads of `hidden_rows`."""
    return ["growth over frequency", *(f"{g:g}" for g in GROWTHS), f"damping at {_COARSE:g}"]


def _limit(w: float) -> str:
    return f"{w:.2g}" if w < 0.99 * COARSEST else f"over {COARSEST:g}"
