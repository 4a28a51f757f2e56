"""Status of a step, and of an advance over many steps; `rotor_fmu/fmi/c/kernels.h` has the same
numbers."""

# NOT_CONVERGED: the problem of the interface forces; NOT_FINITE: the motion is not finite, or
# beyond the bound; UNFINISHED: an advance ended after `max_iterations` of the interface problem, of
# which a step counts at least one; FILM_INVALID: an oil film is thinner than its roughness.
DONE, NOT_CONVERGED, NOT_FINITE, UNFINISHED, FILM_INVALID = range(5)
# An advance that ended early returns this plus the cause, see `time_loop.early_return`.
ENDED_EARLY = 8
