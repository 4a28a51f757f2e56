"""FMUs coupled with the rotor's: a partner built from its source, and a master that runs them."""

from ..errors import InputError

# How libcosim chooses its communication steps, by its own names.
ALGORITHMS = ("fixedStep", "ecco")

MOST_STEPS = 1e9  # of a system's run: a day of FMUs that take 0.1 ms for a step


def check_steps(step: str, stop: str, steps: float, most: float = MOST_STEPS) -> None:
    """Raise `InputError` for a run of so many communication steps that it would not end.

    step, stop: both as they were given; most: how many steps there may be.
    """
    if not steps <= most:
        raise InputError(f"{step}: would make {steps:.3g} steps until {stop}; at most {most:g}")
