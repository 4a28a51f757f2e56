"""Messages about growing whirls: hidden by the integrator, or ended the run."""

OPEN, SLIPPING, AND = "all contacts open", " in contact and slipping", " and "
REST = "the contacts as they carry the machine at rest"
WAYS = ("forward", "backward")
WHIRL = (
    "with {where} a {way} whirl of {hz:.4g} Hz ({omega:.4g} rad/s) grows by {growth:.3g} 1/s at "
    "{speed:.4g} rad/s"
)
# What numerical damping does to a growth: leaves some of it, or more than takes it away.
DOES = ("leaves {seen:.3g} 1/s of it", "damps it by {seen:.3g} 1/s")
HIDES = (
    f"solver steps of {{h:.3g}} s hide an instability: {WHIRL}, and the integrator, at omega h = "
    "{radians:.2g}, {does}; take steps of at most {longest:g} s, or the preset controlled"
)
UNSTABLE = f"unstable: {WHIRL}; the machine itself is past its threshold of stability"
OSCILLATES = (
    "a mode of {hz:.4g} Hz ({omega:.4g} rad/s) grows, its logarithmic decrement being "
    "{decrement:.3g}"
)
MOVES_AWAY = "it moves away from its equilibrium by {growth:.3g} 1/s, without oscillating"
AT_REST = (
    "unstable at rest: with no contact closed but what carries the machine {how}; look at the "
    "damping and the stiffness of its bearings"
)
APART = (
    "the run diverged by an instability of the machine (node {node:d} past {bound:.3g} m or not "
    f"finite): {WHIRL}, and it was seen to whirl {{seen}} at {{seen_hz:.4g}} Hz; a shorter step "
    "does not help: reduce friction or add damping"
)
