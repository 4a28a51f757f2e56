"""What one generalized-alpha step has in common for every structure with local contacts.

The unknowns of a step are the accelerations a1. With the predictions of q and v (everything but
a1's share) and the step matrix S = m M + c C + k K, weights from `weights`,

    S a1 = (1 - alpha_f) (f1 - C v - K q) - alpha_f r0 - alpha_m M a0 + B F

which leaves a small problem in the contacts' motion, with the flexibility S^-1 B. How F
follows from that motion, a penalty law with friction or a hard stop, is the closure's affair.
"""

from __future__ import annotations

from .compiled import compiled


@compiled
def weights(scheme, h):
    """Weights (m, c, k) of mass, damping and stiffness in the step matrix; h [s]."""
    am, af, beta, gamma = scheme
    return 1.0 - am, (1.0 - af) * gamma * h, (1.0 - af) * beta * h * h


@compiled
def predict(scheme, h, q0, v0, a0, q, v):
    """Fill q and v with what is known of them at the end of a step, shape (n,)."""
    by_displacement = h * h * (0.5 - scheme.beta)
    by_velocity = h * (1.0 - scheme.gamma)
    for i in range(len(q)):
        q[i] = q0[i] + h * v0[i] + by_displacement * a0[i]
        v[i] = v0[i] + by_velocity * a0[i]


@compiled
def correct(scheme, h, a, q, v):
    """Add to the predictions the share of the accelerations at the end of the step."""
    by_displacement = h * h * scheme.beta
    by_velocity = h * scheme.gamma
    for i in range(len(q)):
        q[i] += by_displacement * a[i]
        v[i] += by_velocity * a[i]
