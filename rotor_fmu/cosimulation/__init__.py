"""FMUs coupled with the rotor's: a partner built from its source, and a master that runs both."""

# How libcosim chooses its communication steps, by its own names.
ALGORITHMS = ("fixedStep", "ecco")
