"""What becomes of a step, and of an advance over many: numbers that the FMU's instance in C knows
too (`rotor_fmu/fmi/c/kernels.h`)."""

# NOT_CONVERGED: the interfaces' problem; NOT_FINITE: or past the bound; UNFINISHED: an advance,
# after `max_iterations` of the interfaces' problem, a step counting for one at least; BROKEN: an
# oil film.
DONE, NOT_CONVERGED, NOT_FINITE, UNFINISHED, BROKEN = range(5)
# An advance: this plus what ended it early, see `time_loop.early_return`.
ENDED_EARLY = 8
