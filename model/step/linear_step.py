"""The part of a generalized-alpha step that is common to all structures with local contacts.

Written in accelerations, with v_dot = M^-1 (f - C v - K q) of the equation of motion, the scheme
(`schemes`) is (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) v_dot1 + alpha_f v_dot0. With the
predictions of q and v (all terms but those of a1) and the step matrix S = m M + c C + k K, weights
from `weights`, the unknowns a1 follow from

    S a1 = (1 - alpha_f) (f1 - C v - K q) + M (alpha_f v_dot0 - alpha_m a0) + B F

This leaves a small problem in the contacts' motion, with the flexibility S^-1 B. How F depends on
that motion, a penalty law with friction or a hard stop, is left to the caller.
"""

from ..kernels.functions import scaled
from ..kernels.jit import jit


@jit
def weights(scheme, h):
    """Return the weights (m, c, k) of mass, damping and stiffness in the step matrix; h [s]."""
    am, af, beta, gamma = scheme
    return 1.0 - am, (1.0 - af) * gamma * h, (1.0 - af) * beta * h * h


@jit
def predict(scheme, h, q0, v0, a0, q, v):
    """Fill q and v, shape (n,), with their predictions at the end of a step."""
    by_displacement = h * h * (0.5 - scheme.beta)
    by_velocity = h * (1.0 - scheme.gamma)
    for i in range(len(q)):
        q[i] = q0[i] + scaled(h, v0[i]) + scaled(by_displacement, a0[i])
        v[i] = v0[i] + scaled(by_velocity, a0[i])


@jit
def correct(scheme, h, a, q, v):
    """Add the contribution of the accelerations at the end of the step to the predictions."""
    by_displacement = h * h * scheme.beta
    by_velocity = h * scheme.gamma
    for i in range(len(q)):
        q[i] += scaled(by_displacement, a[i])
        v[i] += scaled(by_velocity, a[i])


@jit
def balance(scheme, mass_factor, a0, v_dot0, a, v_dot):
    """Fill v_dot, the accelerations of the equation of motion at the end of a step, from the
    scheme, with the mass factor of a `fitting`. Errors of v_dot0 do not propagate: a contains them
    already."""
    share = 1.0 / (1.0 - scheme.alpha_f)
    by_new = mass_factor * (1.0 - scheme.alpha_m) * share
    by_old = mass_factor * scheme.alpha_m * share
    by_balance = scheme.alpha_f * share
    for i in range(len(v_dot)):
        v_dot[i] = scaled(by_new, a[i]) + scaled(by_old, a0[i]) - scaled(by_balance, v_dot0[i])


@jit
def balance_back(scheme, a0, v_dot0, v_dot, a):
    """Fill a from v_dot (inverse of `balance`, with a mass factor of 1)."""
    share = 1.0 / (1.0 - scheme.alpha_m)
    for i in range(len(a)):
        known = scheme.alpha_f * v_dot0[i] - scheme.alpha_m * a0[i]
        a[i] = share * ((1.0 - scheme.alpha_f) * v_dot[i] + known)
