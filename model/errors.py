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

    def __init__(self, message: str) -> None:
        """Take the message, whose line breaks and other characters that are not printed, such as of
        a name in a file, are shown as they are written in Python: it is one line."""
        shown = (c if c.isprintable() else repr(c)[1:-1] for c in message)
        super().__init__("".join(shown))
