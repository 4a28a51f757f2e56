"""FMUs coupled with the rotor's: a partner built from its source, and a master that runs them."""

# How libcosim chooses its communication steps, by its own names.
ALGORITHMS = ("fixedStep", "ecco")
