"""The class of all errors in what a user gives."""


class InputError(ValueError):
    """Invalid input; the message names it, its value and what is allowed.

    >>> import rotor_fmu as rf
    >>> try:
    ...     rf.simulate(rf.load(), speed=185.0, stop=-1.0)
    ... except rf.InputError as error:
    ...     print(error)
    stop = -1 s: must be > 0 and finite
    """
